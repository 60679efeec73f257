"""Reduced models of skins near earth: bodies, guards, fingers, the rim and the foam's thickness."""

from dataclasses import replace

import numpy as np
import pytest
import rcskin
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.cosine_modes.foam_modes import check_uniform_foam
from rcskin.simulator.models.network.network_skin import NetworkSkin
from rcskin.simulator.models.network.terminals import read, trained
from rcskin.simulator.models.parameters import nominal, scene_with
from rcskin.simulator.models.reduced.forward import Forward
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.models.reduced.model_file import load, save
from rcskin.simulator.models.reduced.slopes import sensitivity
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.batch import NOTHING, PressBatch
from rcskin.simulator.press.capacitance import touched_cells
from rcskin.simulator.press.press import Press, press_on
from rcskin.simulator.sweeps import InputError

RTOL, CLOSELY = 1e-3, 1e-4
FOAM = {
    "skin.foam.capacitance_per_area": None,
    "skin.foam.thickness": 4e-3,
    "skin.foam.relative_permittivity": 2.2,
}
EVERYTHING = {
    "low": "virtual earth",
    "body": {"distance": 5e-3},
    "cover": {"thickness": 1e-3, "relative_permittivity": 1.0},
    "rim": {"mutual": 5e-12, "top": 11e-12, "bottom": 6e-12},
    "thickness": True,
}
GUARD = EVERYTHING | {"body": {"distance": 5e-3, "potential": "high"}}
AROUND = {
    "virtual earth": EVERYTHING,
    "floating": EVERYTHING | {"low": "floating"},
    "guard": GUARD,
    "finger alone": {"cover": EVERYTHING["cover"]},
    "hexagon": EVERYTHING | {"thickness": False, "low": "floating"},
}
PRESSES = ("none", "2,2:2", "1,2:touch", "2,1:1.6:3pF+1,2:1.3:rod")


@pytest.fixture(scope="module")
def scenes(kinds):
    sheet = rcskin.load("sheet-5x5").with_({"pixels": 2, **FOAM})
    bare = dict.fromkeys(AROUND, sheet) | {"hexagon": kinds["hexagon"]}
    few = {"sweep.frequencies": [1e3, 1e4, 5e4, 2e5]}
    return {name: bare[name].with_({"surroundings": own, **few}) for name, own in AROUND.items()}


@pytest.fixture(scope="module")
def families(scenes):
    return {name: reduce(scene, RTOL) for name, scene in scenes.items()}


@pytest.mark.parametrize("name", AROUND)
def test_the_full_solver_agrees_within_the_estimate(families, scenes, name):
    scene, own = scenes[name], families[name].skin(None)
    solver = Solver(scene, CLOSELY)
    for text in PRESSES:
        press = press_on(scene, text)
        cells, rises = touched_cells(scene, press)
        off = relative_difference(own.sweep(cells, rises), solver.solve(press).Z)
        estimated = own.certificate(cells, rises) + families[name].mesh_error + 0.03 * RTOL
        assert (off <= estimated + CLOSELY).all()
        assert estimated.max() <= RTOL


def test_bodies_and_rims_of_other_sizes_need_no_other_basis(families, scenes):
    scene, values = scenes["virtual earth"], {"body": 0.2, "rim": -0.3}
    variation = replace(nominal(scene), body=np.exp(0.2), rim=np.exp(-0.3))
    own = families["virtual earth"].skin(variation)
    truth = Solver(scene_with(scene, values), CLOSELY).solve(Press()).Z
    estimated = own.certificate(*NOTHING).max() + families["virtual earth"].mesh_error
    assert relative_difference(own.sweep(*NOTHING), truth).max() <= estimated + CLOSELY < 2 * RTOL


def test_a_model_comes_back_from_its_file_whole(families, tmp_path):
    reduced = families["guard"]
    save(reduced, tmp_path / "model.npz")
    again, touched = load(tmp_path / "model.npz"), (np.array([2, 6]), np.array([0.5, 2e-12]))
    for each in ("sweep", "certificate"):
        first, second = (getattr(model.skin(None), each)(*touched) for model in (reduced, again))
        np.testing.assert_allclose(first, second, rtol=1e-6)


def test_the_terminals_of_a_network_make_the_same_readings(scenes):
    scene = scenes["virtual earth"]
    skin = read(trained(scene, 1e-2), scene.interfaces).skin(None)
    presses = [touched_cells(scene, press_on(scene, text)) for text in PRESSES]
    network, batch = NetworkSkin(skin), PressBatch.of(presses)
    Z = network.impedances(network.wiring(scene.interfaces), network.admittances(batch))
    np.testing.assert_allclose(Z, skin.sweeps(batch), rtol=1e-5)


STEPS = {"body": 1e-4, "rim": 1e-4, "capacitance": 1e-4, "finger": 1e-14, "loss_tangent": 1e-4}
MOVED = {"body": 0.1, "rim": -0.1, "finger": 2e-12, "capacitance": 0.05, "loss_tangent": 0.01}


@pytest.fixture(scope="module")
def forward(scenes):
    return Forward(scenes["virtual earth"], rtol=0.1)


@pytest.mark.parametrize("cells", [[1], [1, 4], [2, 3, 6]], ids=str)
def test_slopes_are_differences(forward, cells):
    """Slopes by rods, by a finger that does not press, and by both at once."""
    cells = np.array(cells)
    rises = np.where(cells < 4, 0.5, 3e-12)
    found = forward.respond(cells, rises, MOVED)
    together = forward.respond_together(cells[None], rises[None], MOVED)
    for name, step in STEPS.items():
        ends = ({**MOVED, name: MOVED[name] + sign * step} for sign in (1, -1))
        up, down = (forward.respond(cells, rises, values).Z for values in ends)
        expected = pytest.approx((up - down) / (2 * step), rel=1e-5)
        assert found.by_parameter[name] == expected
        assert together.by_parameter[name][0] == expected
    for k, step in enumerate(np.where(cells < 4, 1e-4, 1e-14)):
        ends = (rises + sign * step * (cells == cells[k]) for sign in (1, -1))
        up, down = (forward.respond(cells, moved, MOVED).Z for moved in ends)
        at_rest = forward.unpressed_factors(MOVED)[cells[k]]
        slope = at_rest * together.by_cell[0, ..., k]
        assert slope == pytest.approx((up - down) / (2 * step), rel=1e-5)


def test_a_finger_among_the_values_is_one_on_every_touched_pixel(forward):
    given = forward.respond(np.array([2]), np.array([0.5]), {"finger": 3e-12}).Z
    touched = forward.respond(np.array([2, 6]), np.array([0.5, 3e-12])).Z
    np.testing.assert_allclose(given, touched, rtol=1e-12)


ROUGH = 1e-2


@pytest.fixture(scope="module")
def deep():
    """Foam whose skins spread a press by depth."""
    few = {"pixels": {"rows": 1, "columns": 2}, "sweep.frequencies": [1e3, 1e5]}
    around = EVERYTHING | {"thickness": False}
    return rcskin.load("foam").with_({**few, "surroundings": around})


def test_fingers_press_by_depth(deep):
    own, press = reduce(deep, ROUGH).skin(None), press_on(deep, "1,1:0.5mm:1pF+1,2:1mm:5pF")
    cells, rises = touched_cells(deep, press)
    off = relative_difference(own.sweep(cells, rises), Solver(deep, RTOL).solve(press).Z)
    estimated = own.certificate(cells, rises) + own.reduced.mesh_error
    assert (off <= estimated + RTOL).all()
    assert estimated.max() <= ROUGH
    up, down = (1 / own.sweep(cells, rises + sign * 1e-14 * (cells > 1)) for sign in (1, -1))
    by_finger = sensitivity(own, cells, rises, own.reduced.frequency).by_finger
    assert by_finger == pytest.approx((up - down) / 2e-14, rel=1e-5)


def test_what_does_not_reduce_is_refused_by_its_key(scenes, deep):
    with pytest.raises(InputError, match=r"`surroundings\.thickness` does not reduce where"):
        reduce(deep.with_({"surroundings.thickness": True}), RTOL)
    with pytest.raises(InputError, match=r"fitted without `surroundings\.thickness`"):
        check_uniform_foam(scenes["virtual earth"])
