"""What uses skins that are not plain: derivatives, limits, studies, calibration, inversion."""

import numpy as np
import pytest
from rcskin.localization.study.point import EvaluationSettings
from rcskin.simulator.bounds.full_fields import FullFields
from rcskin.simulator.bounds.position_bound import chosen_touch, places_on
from rcskin.simulator.bounds.touch_readings import hypotheses
from rcskin.simulator.calibration.run import calibrate
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.inversion.touch_templates import templates
from rcskin.simulator.limits import bayes_accuracy
from rcskin.simulator.measure.experiment import planned_presses
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.parameters import parts_with
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import every_press, parse_press

STEP = 1e-4
UNEVEN = pytest.param("uneven", marks=pytest.mark.slow)


@pytest.mark.parametrize("name", ["piezoresistive", "mesh"])
def test_fields_answer_and_change_as_the_full_solver(kinds, name):
    """A whole pixel pressed, by cells of a pixel each, and its slopes by the factor."""
    scene = kinds[name]
    fields, pixel = FullFields(scene.parts, scene.frequencies[-1], 1), np.array([[0.0, 1.0]])

    def answer(factor):
        change = {"strength": pixel}
        return fields.respond(1 + (factor - 1) * pixel, change, scene.frequencies, {})

    found, truth = answer(2.0), Solver(scene.parts, 1e-4).solve(parse_press("1,2", 2.0)).Z
    assert relative_difference(found.Z, truth).max() < 3e-3
    apart = (answer(2 + STEP).Z - answer(2 - STEP).Z) / (2 * STEP)
    np.testing.assert_allclose(found.by_parameter["strength"], apart, rtol=1e-4)
    stiffer = parts_with(scene.parts, {"sheet_resistance": STEP}).scene
    moved = FullFields(stiffer.parts, scene.frequencies[-1], 1).respond(
        1 + pixel, {}, scene.frequencies
    )
    by = found.by_parameter["sheet_resistance"]
    np.testing.assert_allclose((moved.Z - found.Z) / STEP, by, rtol=2e-2, atol=1e-3 * abs(by).max())


def test_pixels_without_skin_are_no_class_and_no_press(kinds):
    scene = kinds["l with a hole"]
    there = [(0, 0), (0, 1), (1, 0)]
    at_rest, *pressed = [
        each.pixels for each in hypotheses(scene.parts.skin, scene.parts.plan, "pixel")
    ]
    assert (at_rest, pressed) == ((), [(pixel,) for pixel in there])
    assert [str(press)[:3] for press in every_press(scene.parts.skin, scene.press)[1:]] == [
        "1,1",
        "1,2",
        "2,1",
    ]
    planned = planned_presses(scene.parts.skin, scene.parts.plan, np.random.default_rng(1))
    for presses in (planned, EvaluationSettings().nominal(scene.parts.skin, scene.parts.plan)):
        assert {press.pixel for press in presses} == {(0, 0), *((i + 1, j + 1) for i, j in there)}


def test_the_bound_on_position_is_asked_where_a_touch_is_whole_on_the_skin(kinds):
    scene = kinds["l with a hole"]
    places = np.array(
        places_on(scene.parts.skin, chosen_touch(scene.parts.skin, scene.press, 0.02), 4)
    )
    half = 0.01
    assert len(places)
    beyond = (places > 0.06 - half + 1e-9).all(axis=1)
    assert not beyond.any()
    assert (np.linalg.norm(places - 0.03, axis=1) > 0.012).all()


def test_columns_of_a_mesh_are_found_as_well_as_pressed_by_the_full_solver(kinds):
    accuracy = bayes_accuracy(kinds["mesh"].parts, "column", draws=200)
    assert accuracy.share > 0.99


@pytest.mark.parametrize("name", [UNEVEN, "mesh"])
def test_a_calibration_finds_what_a_twin_was_given(kinds, name):
    scene, given = kinds[name], {"sheet_resistance": 0.3, "capacitance": -0.2}
    twin = Solver(parts_with(scene.parts, given), 1e-4)
    presses = [parse_press(text, 2.0) for text in ("none", "none", "1,1", "1,2")]
    read = read_out(simulate(twin, presses), scene.readout, np.random.default_rng(3))
    fit = calibrate(scene, read)
    assert fit.chi_squared < 3
    for parameter, value in given.items():
        low, high = fit.intervals[parameter]
        assert abs(fit.values[parameter] - value) <= max(high - low, 0.01)
    assert fit.scene.skin.foam.map == scene.skin.foam.map


@pytest.mark.slow
def test_tables_of_the_inverting_localizer_hold_the_pixels_there_are(kinds):
    scene = kinds["l with a hole"].with_({"dataset.press.factor": 2.0})
    tables = templates(scene.parts, "pixel")
    assert tables["pixels"].tolist() == [[1, 1], [1, 2], [2, 1]]
    assert np.abs(tables["single"]).max(axis=(1, 2)).min() > 1e-3
    assert np.isfinite(tables["skin"]).all()
