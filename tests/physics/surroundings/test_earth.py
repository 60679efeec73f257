"""Earth beside the sheets: bodies, guards and both kinds of meters, against closed forms."""

import numpy as np
import pytest
from rcskin.simulator.bounds.field_choice import fields_of
from rcskin.simulator.bounds.touch_rasterizers import TouchSize
from rcskin.simulator.dataset.skin_model import reduced
from rcskin.simulator.fem.circuit import two_fields
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.fem.sweep import swept
from rcskin.simulator.models.heterogeneous.elements_model import Elements
from rcskin.simulator.models.model import GivenPress
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press, press_on
from rcskin.simulator.sweeps import InputError

FREQUENCIES = np.geomspace(1.0, 2e6, 8).tolist()
LOST = 1e-9
"""Of Rs at 1 Hz, what the closed form loses of its digits."""
BODIES = [(0.0, 1.77e-9), (3e-10, 1.77e-9), (8e-9, 2e-8)]
"""Capacitance per area of the top and of the bottom sheet to a body, F/m²."""


def bodies(top, bottom, **more):
    sides = {"top": top, "bottom": bottom}
    return [{"side": side, "capacitance_per_area": c, **more} for side, c in sides.items() if c > 0]


def assert_told(answer, exact, rtol=1e-6):
    """Within the tolerance, and within the error that is told."""
    off = relative_difference(answer.Z, np.atleast_2d(exact))
    assert off.max() <= rtol
    assert (off <= np.stack(answer.relative_errors) + LOST).all()


@pytest.mark.parametrize(("top", "bottom"), BODIES)
def test_current_into_a_virtual_earth(around, solve, three_conductors, top, bottom):
    scene = around({"body": bodies(top, bottom)}, frequencies=FREQUENCIES)
    exact = -1 / three_conductors(scene, top, bottom)[:, 0, 1]
    assert_told(solve(scene), exact)


def test_a_body_behind_a_thin_film(around, solve, three_conductors):
    """0.1 mm of plastic: the field ends far nearer to the foils than by the foam alone."""
    scene = around({"body": bodies(0.0, 3e-7)}, frequencies=FREQUENCIES[2:-1])
    answer = solve(scene, rtol=1e-4)
    assert "triangles" not in answer.model
    assert_told(answer, -1 / three_conductors(scene, 0.0, 3e-7)[:, 0, 1], 1e-4)


@pytest.mark.parametrize(("top", "bottom"), BODIES)
def test_a_meter_that_floats_feeds_no_current_to_earth(
    around, solve, three_conductors, top, bottom
):
    given = {"low": "floating", "body": bodies(top, bottom)}
    scene = around(given, frequencies=FREQUENCIES)
    Y = three_conductors(scene, top, bottom)
    high, low = Y[:, 0], Y[:, 1]
    raised = -(high[:, 0] + low[:, 0]) / (high + low).sum(axis=1)
    assert_told(solve(scene), 1 / (high[:, 0] + raised * high.sum(axis=1)))


def test_a_guard_that_follows_high(around, solve, three_conductors):
    """All is at the guard's potential but for what low draws."""
    scene = around({"body": bodies(0.0, 1.77e-9, potential="high")}, frequencies=FREQUENCIES)
    assert_told(solve(scene), 1 / three_conductors(scene, 0.0, 1.77e-9)[:, 1, 1])


def test_a_guard_that_follows_low_is_earth_where_low_is(around, solve):
    earthed, guard = (
        solve(around({"body": bodies(0.0, 1.77e-9, potential=potential)}))
        for potential in ("earth", "low")
    )
    np.testing.assert_array_equal(guard.Z, earthed.Z)


def test_a_guard_that_follows_low_of_a_meter_that_floats(around, solve, three_conductors):
    """Nothing else is near: low is the reference, and what the guard takes up is low's."""
    given = {"low": "floating", "body": bodies(0.0, 1.77e-9, potential="low")}
    scene = around(given, frequencies=FREQUENCIES)
    assert_told(solve(scene), 1 / three_conductors(scene, 0.0, 1.77e-9)[:, 0, 0])


@pytest.mark.parametrize("low", ["virtual earth", "floating"])
def test_a_body_that_floats_takes_no_charge(around, low, solve):
    """A plane is nothing to a sheet that is at one potential, and shorts one that is not."""
    plane = {"body": bodies(0.0, 1.77e-9, potential="floating")}
    scene = around({"low": low, **plane}, frequencies=[1.0, 1e6])
    Z = solve(scene).Z[0]
    alone = solve(around(None, frequencies=[1.0, 1e6])).Z[0]
    assert Z[0].imag == pytest.approx(alone[0].imag, rel=1e-6)
    assert Z[1].real < 0.99 * alone[1].real
    if low == "floating":
        virtual = solve(around({"low": "virtual earth", **plane}, frequencies=[1.0, 1e6]))
        np.testing.assert_allclose(virtual.Z[0], Z, rtol=2e-6)


def test_what_is_far_away_changes_nothing(around, solve):
    """The limit of no earth, of a skin in which nothing is even."""
    foils = {"top-left": {}, "bottom-bottom": {}}
    skin = {"contacts": foils, "rows": 2, "columns": 2}
    far = solve(around({"body": {"capacitance_per_area": 1e-15}}, **skin), "1,2:2.0", 1e-4)
    alone = solve(around(None, **skin), "1,2:2.0", 1e-4)
    assert relative_difference(far.Z, alone.Z).max() <= 2e-4


def test_low_frequency_law(around, solve):
    """Rs(0) = L/3W [R_t (1 + C_te/C) + R_b (1 + C_be/C)], and no digit is lost at 1 mHz."""
    scene = around({"body": bodies(3e-10, 1.77e-9)}, frequencies=[1e-3])
    skin, c = scene.skin, scene.skin.foam.unpressed_capacitance_per_area
    Rt, Rb = skin.sheet_resistances
    law = skin.length / 3 / skin.width * (Rt * (1 + 3e-10 / c) + Rb * (1 + 1.77e-9 / c))
    answer = solve(scene)
    assert answer.Z[0, 0].real == pytest.approx(law, rel=1e-6)
    assert -1 / (2e-3 * np.pi * answer.Z[0, 0].imag) == pytest.approx(
        c * skin.length * skin.width, rel=1e-9
    )


CROSSED = {"top-left": {"span": (0.3, 1.0)}, "top-right": {}, "bottom-bottom": {}}
UNEVEN = {"contacts": CROSSED, "rows": 3, "columns": 3}
SURROUNDED = {
    "body": bodies(1e-9, 1.77e-9),
    "rim": {"mutual": 5e-12, "top": 1e-11, "bottom": 6e-12},
    "thickness": True,
}


def test_reciprocity(around, solve):
    """What high drives into low is what low would drive into high."""
    ways = {"there": ("top-left", "bottom-bottom"), "back": ("bottom-bottom", "top-left")}
    answer = solve(around(SURROUNDED, interfaces=ways, **UNEVEN), "2,2:1.7", 1e-4)
    assert relative_difference(answer.Z[:1], answer.Z[1:]).max() <= 2e-4


@pytest.mark.parametrize(("low", "rtol"), [("virtual earth", 1e-3), ("floating", 1e-2)])
def test_estimated_errors_bound_the_truth(around, solve, low, rtol):
    """Ends of foils within an edge, and a guard beside an earthed body."""
    given = SURROUNDED | {
        "low": low,
        "body": [
            {"side": "top", "capacitance_per_area": 1e-9, "potential": "high"},
            {"side": "bottom", "capacitance_per_area": 1.77e-9},
        ],
    }
    scene = around(given, interfaces={"m": ("top-left", "bottom-bottom")}, **UNEVEN)
    truth, answer = solve(scene, "3,1:2.0", 1e-5), solve(scene, "3,1:2.0", rtol)
    off = relative_difference(answer.Z, truth.Z)
    assert off.max() <= rtol
    assert (off <= np.stack(answer.relative_errors) + 1e-5).all()


def discretised(scene, press, rtol):
    """First discretisation of a press."""
    skin, setup = scene.parts.skin, scene.parts.setup
    elements = Elements(skin, setup)
    return elements._meshes(GivenPress(skin, press, rtol), rtol).finer(scene.frequencies)


def test_terms_are_symmetric_and_never_negative(around):
    foils = {"top-left": {"width": 0.01}, "bottom-bottom": {}}
    scene = around(SURROUNDED, contacts=foils, rows=2, columns=2)
    press = parse_press(
        "2,2:1.7:5e-12F+rect(0.05,0.02,0.03,0.02):1.0:2pF", 2.0, scene.parts.skin, scene.press
    )
    found = discretised(scene, press, 1e-2)
    M = found.coarse.system.mass.toarray()
    assert np.abs(M - M.T).max() <= 1e-15 * np.abs(M).max()
    assert np.linalg.eigvalsh(M).min() >= -1e-14 * np.abs(M).max()
    assert np.linalg.eigvalsh(M)[0] > 0, "earth is there: no potential is without charge"


@pytest.mark.parametrize("low", ["virtual earth", "floating"])
def test_against_complex_solves(around, low):
    """A few real solves against one complex system for each frequency, whatever its reach."""
    guard = {"side": "top", "capacitance_per_area": 1e-9, "potential": "high"}
    foils = {"top-left": {}, "top-right": {}, "bottom-bottom": {}}
    given = SURROUNDED | {"low": low, "body": [guard, *bodies(0.0, 1.77e-9)]}
    interfaces = {"m": ("top-left", "bottom-bottom")}
    scene = around(given, contacts=foils, interfaces=interfaces, rows=2, columns=2)
    found = discretised(scene, Press(), 1e-3)
    s, space, M = 2j * np.pi * np.geomspace(1.0, 1e8, 9), found.fine.space, found.fine.system.mass
    excitations, combined = found.circuit.excitations, found.circuit.combination
    Q, error = swept(space, M, excitations, s, 1e-9)
    network = space.network(M, s)
    exact = np.stack([network.form(excitation) for excitation in excitations])
    off = relative_difference(combined.impedance(Q), combined.impedance(exact))
    assert (off[..., 3:] <= error[:, 3:] + 1e-8).all(), "complex solves lose digits below"
    assert error.max() <= 2e-9
    np.testing.assert_allclose(combined.impedance(Q), combined.impedance(exact), rtol=1e-8)


@pytest.mark.parametrize("model", ["line", "lumped"])
def test_smaller_models_refuse(around, model):
    scene = around({"body": bodies(0.0, 1.77e-9)})
    with pytest.raises(InputError, match=f"{model}.* cannot take `surroundings`"):
        Solver(scene.parts, 1e-3, model).solve(parse_press("none", 2.0))


FOLDED = {
    "a thick foam": {"thickness": True},
    "a rim between the sheets": {"rim": 5e-12},
    "a guard of high": {"body": {"distance": 5e-3, "potential": "high"}},
    "a body that floats": {"body": {"distance": 5e-3, "potential": "floating"}, "rim": 5e-12},
}


@pytest.mark.parametrize("name", FOLDED)
def test_a_virtual_earth_that_nothing_reaches_takes_one_excitation(around, name):
    """The form of both terminals at +1/2 V is 0, and the answer the same to rounding."""
    scene = around(FOLDED[name], {"thickness": 4e-3}, rows=2, columns=2)
    assert len(two_fields(scene.parts.skin, scene.parts.setup).excitations) == 2
    assert len(two_fields(scene.parts.skin.for_rods, scene.parts.setup).excitations) == 1
    press = press_on(scene.parts.skin, scene.press, "1,2:2.0:rod")
    found, both = Solver(scene.parts, 1e-4), Solver(scene.parts, 1e-4)
    vars(both)["_without_earth"] = None
    assert relative_difference(found.solve(press).Z, both.solve(press).Z).max() < 1e-13


@pytest.mark.parametrize(
    "earthed",
    [
        {"body": {"distance": 5e-3}},
        {"body": {"distance": 5e-3, "potential": "low"}},
        {"rim": True},
        {"rim": {"mutual": 5e-12, "top": 1e-12}},
        {"low": "floating", "thickness": True},
    ],
    ids=str,
)
def test_what_reaches_earth_is_not_left_out(around, earthed):
    scene = around(earthed, {"thickness": 4e-3})
    assert scene.parts.skin.for_rods is scene.parts.skin


def test_fingers_find_the_earth_that_rods_do_not_need(around):
    scene = around({"thickness": True}, {"thickness": 4e-3}, rows=2, columns=2)
    solver = Solver(scene.parts, 1e-4)
    rod, finger = (
        solver.solve(press_on(scene.parts.skin, scene.press, f"1,2:2.0:{how}")).Z
        for how in ("rod", "3pF")
    )
    assert relative_difference(finger, rod).max() > 1e-3


def test_readings_and_fields_of_rods_leave_idle_earth_out(around):
    scene = around({"thickness": True}, {"thickness": 4e-3}, rows=2, columns=2)
    touch = TouchSize(0.05, 0.04, 1.0)
    for given in (touch, touch._replace(finger=3e-12)):
        fields = fields_of(scene.parts, 1e4, given, cells=1)
        assert fields.parts.skin.around.low == ("virtual earth" if given.finger else "floating")


@pytest.mark.parametrize("drawn", [{}, {"dataset.press.finger": {"low": 0.0, "high": 5e-12}}])
def test_data_sets_of_rods_are_of_one_excitation(around, drawn):
    scene = around({"thickness": True}, {"thickness": 4e-3}, rows=1, columns=2).with_(drawn)
    model = reduced(scene.parts, 0.1)
    assert len(model.circuit.excitations) == (2 if drawn else 1)
    assert model.at(None).parts.fingers == (2 if drawn else 0)
