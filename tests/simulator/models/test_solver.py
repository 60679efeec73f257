"""What the solver refuses and what it says of its answers; tests/physics has whether they hold."""

import math

import numpy as np
import pytest
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.line import Line
from rcskin.simulator.models.model import GivenPress
from rcskin.simulator.models.sheet_model import Sheet, UniformSheets
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.batch import NOTHING, PressBatch
from rcskin.simulator.press.press import Press, every_press, parse_press
from rcskin.simulator.scene.scene_files import load_scene, parse_scene
from rcskin.simulator.sweeps import InputError, ToleranceError, check

ACROSS = parse_press("1,1", 2.0)


@pytest.mark.parametrize("rtol", [0, -1e-3, np.nan, np.inf])
def test_a_tolerance_is_finite_and_positive(make_scene, rtol):
    with pytest.raises(InputError, match="`rtol` must be finite and > 0, got"):
        Solver(make_scene().parts, rtol)


@pytest.mark.parametrize(
    ("contacts", "press", "message"),
    [
        ({"top-left": {}, "bottom-left": {}}, "1,1", "press 1,1:2.0 varies across scene"),
        ({"top-left": {}, "bottom-right": {}}, "none", "not fed in pairs"),
        (
            {f"{sheet}-left": {"span": (0.0, 0.5)} for sheet in ("top", "bottom")},
            "none",
            "not fed along one whole edge, or two opposite ones",
        ),
        (
            {f"{sheet}-{edge}": {} for edge in ("left", "top") for sheet in ("top", "bottom")},
            "none",
            "not fed along one whole edge, or two opposite ones",
        ),
    ],
)
def test_what_is_no_line_is_refused_with_the_reason(make_scene, contacts, press, message):
    scene = make_scene(contacts, rows=2)
    with pytest.raises(InputError, match=message):
        Solver(scene.parts, model="line").solve(parse_press(press, 2.0))


def test_a_resistor_has_no_lumped_capacitor(make_scene):
    scene = make_scene({"top-left": {}, "top-right": {}})
    with pytest.raises(InputError, match="the lumped model needs an interface between"):
        Solver(scene.parts, model="lumped").solve(Press())
    assert Solver(scene.parts).solve(Press()).model.startswith("2-D elements, two fields")


def test_a_model_chosen_by_name_is_not_replaced(make_scene):
    with pytest.raises(ToleranceError, match="one R and one C: estimated error"):
        Solver(make_scene(frequencies=[1e5]).parts, model="lumped").solve(Press())
    answer = Solver(make_scene().parts, model="sheet").solve(Press())
    assert answer.model.startswith("2-D elements, one field")
    assert answer.rejected == ()


def test_rejected_models_are_listed_in_order(make_scene):
    answer = Solver(make_scene(rows=2).parts).solve(ACROSS)
    assert [reason.split(":")[0] for reason in answer.rejected] == [
        "line",
        "one R and one C",
    ]


def test_answers_are_shaped_by_interface_and_frequency(make_scene):
    foils = {"top-left": {}, "bottom-left": {}, "top-right": {}}
    meters = {"a": ("top-left", "bottom-left"), "b": ("top-right", "bottom-left")}
    answer = Solver(make_scene(foils, meters, rows=2).parts).solve(ACROSS)
    for each in (answer.Z, answer.Rs_error, answer.Cp_error):
        assert each.shape == (2, 3)


def test_sweeps_carry_what_made_them():
    scene = load_scene("strip-1x3")
    sweeps = check(simulate(Solver(scene.parts, 1e-6), every_press(scene.parts.skin, scene.press)))
    assert sweeps["press"].values.tolist() == ["none", "1,1:2.0", "1,2:2.0", "1,3:2.0"]
    assert sweeps["column"].values.tolist() == [0, 1, 2, 3]
    assert sweeps.attrs["model"] == "exact line"
    assert sweeps.attrs["rtol"] == 1e-6
    assert parse_scene(sweeps.attrs["scene"], "attribute") == scene
    np.testing.assert_array_equal(
        sweeps["Rs"][0],
        Line(scene.parts.skin, scene.parts.setup).solve(Press(), scene.frequencies).Z.real,
    )


def test_a_press_beside_the_pixels_is_refused(make_scene):
    with pytest.raises(InputError, match=r"row must be in 1\.\.1 on scene, got 2"):
        simulate(Solver(make_scene().parts), [parse_press("2,1", 2.0)])


@pytest.mark.parametrize("model", ["auto", "sheet", "line", "lumped"])
def test_given_frequencies_are_solved_like_those_of_the_scene(make_scene, model):
    requested = [10.0, 30.0] if model == "lumped" else [2e3, 7e3]
    scene = make_scene({"top-left": {}, "bottom-left": {}}, rows=1)
    own = Solver(scene.with_({"sweep": {"frequencies": requested}}).parts, model=model).solve(
        ACROSS
    )
    solver = Solver(scene.parts, model=model)
    solver.solve(ACROSS, 5.0)
    answer = solver.solve(ACROSS, requested)
    assert answer.model == own.model and answer.frequency.tolist() == requested
    np.testing.assert_array_equal(answer.Z, own.Z)
    np.testing.assert_array_equal(answer.Cp_error, own.Cp_error)


@pytest.mark.parametrize("frequency", [[], 0.0, [2.0, 1.0], [1.0, 1.0], np.nan, [[1.0]]])
def test_frequencies_that_are_none_are_refused(make_scene, frequency):
    with pytest.raises(InputError, match="`frequency` must be ascending and > 0"):
        Solver(make_scene().parts).solve(Press(), frequency)


def test_a_reduced_model_answers_between_its_scene_s_frequencies(make_scene):
    """Beyond them elements do, and why is said in one line."""
    scene = make_scene()
    low, high = scene.frequencies[[0, -1]]
    requested = [low / 2, low, math.sqrt(low * high), high, 2 * high]
    solver = Solver(scene.parts, rtol=1e-3, model="reduced")
    answer, truth = (
        solver.solve(ACROSS, requested),
        Solver(scene.parts, rtol=1e-5).solve(ACROSS, requested),
    )
    assert ["reduced" in model for model in answer.models] == [False, True, True, True, False]
    assert relative_difference(answer.Z, truth.Z).max() <= 1e-3
    (message,) = (reason for reason in answer.rejected if "from" in reason)
    assert message == (
        f"reduced: the model is trained for frequencies from {low:g} to {high:g} Hz, "
        f"got {low / 2:g}, {2 * high:g}"
    )


def test_what_a_model_does_not_give_it_refuses(make_scene):
    """Each verb of the face in one line; outside its domain a model costs infinitely much."""
    scene = make_scene(rows=2)
    line, pressed = Line(scene.parts.skin, scene.parts.setup), PressBatch.of([NOTHING])
    given = GivenPress(scene.parts.skin, ACROSS, 1e-4)
    assert "varies across scene" in line.refuses(given)
    assert line.cost(given, scene.frequencies) == np.inf
    for what, ask in (
        ("network of terminals", lambda: line.terminals(pressed, scene.frequencies)),
        ("fields", lambda: line.fields(Press(), [1e3], "meter")),
        ("answers to a batch of presses", lambda: line.solve(pressed, scene.frequencies)),
        ("derivatives", lambda: Sheet(UniformSheets(line.skin, line.setup)).slopes(pressed)),
    ):
        with pytest.raises(InputError, match=f"gives no {what}"):
            ask()
