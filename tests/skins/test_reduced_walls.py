"""Walls around presses in everything that reduced models serve, against the full solver."""

from itertools import combinations

import numpy as np
import pytest
import rcskin
from rcskin.simulator.bounds.fields import FullFields, TouchSize
from rcskin.simulator.bounds.touches.area_rasterizer import AreaRasterizer
from rcskin.simulator.dataset.dataset_plan import Plan
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.limits.random_press_limits import RandomPresses
from rcskin.simulator.models.network.network_skin import NetworkSkin
from rcskin.simulator.models.network.terminals import read, trained
from rcskin.simulator.models.parameters import nominal, scene_with
from rcskin.simulator.models.reduced.forward import Forward
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.models.reduced.model_file import load, save
from rcskin.simulator.models.reduced.slopes import sensitivities, sensitivity
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.press.capacitance import touched_cells
from rcskin.simulator.press.parts import parts_of
from rcskin.simulator.press.press import parse_press, press_on
from rcskin.simulator.scene.draws.draw_distributions import Uniform
from rcskin.simulator.sweeps import InputError, impedance, open_zarr

RTOL, CLOSELY = 2e-3, 2e-4
FOAM = {
    "skin.foam.capacitance_per_area": None,
    "skin.foam.thickness": 4e-3,
    "skin.foam.relative_permittivity": 2.2,
}
WALLED = {
    "body": {"distance": 5e-3},
    "cover": {"thickness": 1e-3, "relative_permittivity": 1.0},
    "thickness": True,
    "edges": True,
}
FEW = {"sweep.frequencies": [1e3, 2e4, 2e5]}


@pytest.fixture(scope="module")
def scenes(kinds):
    sheet = rcskin.load("sheet-5x5").with_({"pixels": 2, **FOAM})
    bare = {"sheet": sheet, "hexagon": kinds["hexagon"], "mesh": kinds["mesh"]}
    return {
        name: scene.with_({**FOAM, "surroundings": WALLED, **FEW}) for name, scene in bare.items()
    }


@pytest.fixture(scope="module")
def families(scenes):
    return {name: reduce(scene, RTOL) for name, scene in scenes.items()}


def presses(scene, seed):
    """One, two and three pixels at random, the last two beside each other; by rods and fingers."""
    random, (rows, columns) = np.random.default_rng(seed), scene.pixels.shape
    pixels = [(i + 1, j + 1) for i in range(rows) for j in range(columns)]
    near = [
        (one, other)
        for one, other in combinations(pixels, 2)
        if abs(one[0] - other[0]) + abs(one[1] - other[1]) == 1
    ]
    alone, pair = (pixels[random.integers(len(pixels))],), near[random.integers(len(near))]
    far = tuple(pixels[k] for k in random.choice(len(pixels), min(3, len(pixels)), replace=False))
    for each in (alone, pair, far):
        strengths = random.uniform(0.6, 2.8, len(each)).round(2)
        hands = random.choice(["rod", "3pF"], len(each))
        touches = zip(each, strengths, hands, strict=True)
        yield "+".join(f"{row},{column}:{factor}:{hand}" for (row, column), factor, hand in touches)


@pytest.mark.parametrize("name", ["sheet", "hexagon", "mesh"])
def test_the_full_solver_agrees_within_the_estimate(families, scenes, name):
    scene, own = scenes[name], families[name].skin(None)
    solver, straight = (
        Solver(each, CLOSELY) for each in (scene, scene.with_({"surroundings.edges": False}))
    )
    most = 0.0
    for text in presses(scene, seed=3):
        press = press_on(scene, text)
        touched = touched_cells(scene, press)
        truth = solver.solve(press).Z
        estimated = own.certificate(*touched).max() + families[name].mesh_error + 0.03 * RTOL
        assert relative_difference(own.sweep(*touched), truth).max() <= estimated + CLOSELY
        assert estimated <= 2 * RTOL
        most = max(most, relative_difference(straight.solve(press).Z, truth).max())
    assert most > 2 * RTOL


def test_walls_between_groups_of_a_mesh_are_where_these_meet(scenes):
    """Two groups with foam of no pixel between them, and none of them beside the other."""
    assert parts_of(scenes["mesh"]).walls.pairs.tolist() == [[0, 2], [1, 2]]


def test_a_model_comes_back_from_its_file_whole(families, tmp_path):
    save(families["mesh"], tmp_path / "model.npz")
    touched = np.array([0, 1]), np.array([0.5, 1.0])
    first, second = (
        model.skin(None).sweep(*touched)
        for model in (families["mesh"], load(tmp_path / "model.npz"))
    )
    np.testing.assert_allclose(first, second, rtol=1e-9)


def test_the_terminals_of_a_network_make_the_same_readings(scenes):
    scene = scenes["mesh"]
    skin = read(trained(scene, 3e-2), scene.interfaces).skin(None)
    each = [touched_cells(scene, press_on(scene, text)) for text in presses(scene, seed=1)]
    network, batch = NetworkSkin(skin), PressBatch.of(each)
    Z = network.impedances(network.wiring(scene.interfaces), network.admittances(batch))
    np.testing.assert_allclose(Z, skin.sweeps(batch), rtol=1e-5)


@pytest.fixture(scope="module")
def forward(scenes):
    return Forward(scenes["sheet"].with_({"pixels": {"rows": 2, "columns": 3}}), rtol=0.1)


STEPS = {"body": 1e-4, "capacitance": 1e-4, "finger": 1e-14}
MOVED = {"body": 0.1, "finger": 2e-12, "capacitance": 0.05}


@pytest.mark.parametrize("cells", [[], [1], [1, 4], [0, 1, 2], [4, 7]], ids=str)
def test_slopes_are_differences(forward, cells):
    """Slopes by one pixel, by neighbours that differ, and with a finger next to a press."""
    cells = np.array(cells, dtype=np.int64)
    rises = np.where(cells < 6, 0.5 + 0.2 * np.arange(len(cells)), 3e-12)
    found = forward.respond(cells, rises, MOVED)
    together = forward.respond_together(cells[None], rises[None], MOVED)
    for name, step in STEPS.items():
        ends = ({**MOVED, name: MOVED[name] + sign * step} for sign in (1, -1))
        up, down = (forward.respond(cells, rises, values).Z for values in ends)
        expected = pytest.approx((up - down) / (2 * step), rel=1e-5)
        assert found.by_parameter[name] == expected
        assert together.by_parameter[name][0] == expected
    for k, step in enumerate(np.where(cells < 6, 1e-4, 1e-14)):
        ends = (rises + sign * step * (cells == cells[k]) for sign in (1, -1))
        up, down = (forward.respond(cells, moved, MOVED).Z for moved in ends)
        at_rest = forward.unpressed_factors(MOVED)[cells[k]]
        expected = pytest.approx((up - down) / (2 * step), rel=1e-5)
        assert at_rest * together.by_cell[0, ..., k] == expected
        if cells[k] < 6:
            assert at_rest * found.by_cell[..., cells[k]] == expected


def test_slopes_where_the_foam_of_pixels_differs_are_differences(forward):
    """Walls go with the mean of the permittivity on both sides."""
    reduced, rises = forward.reduced, np.array([0.5, 0.8])
    foam = nominal(reduced.scene)
    foam.capacitance[:] = np.linspace(0.8, 1.2, 6).reshape(2, 3)
    skin, cells = reduced.skin(foam), np.array([1, 4])
    found = sensitivity(skin, cells, rises, skin.reduced.frequency)
    together = sensitivities(skin, cells[None], rises[None], skin.reduced.frequency)
    for k in range(2):
        step = 1e-4 * np.eye(2)[k]
        up, down = (1 / skin.sweep(cells, rises + sign * step) for sign in (1, -1))
        expected = pytest.approx((up - down) / 2e-4 / skin.unpressed_factors[cells[k]], rel=1e-4)
        assert found.by_cell[..., cells[k]] == expected
        assert together.by_cell[0, ..., k] == expected


def test_slopes_by_place_are_those_of_walls_that_move_with_the_touch(scenes):
    """What walls add to them, on cells of 15 mm, beside differences of the full solver."""
    touch, place, step = TouchSize(0.04, 0.06, 1.0), (0.055, 0.0375), 1e-3
    moved = {"x": (step, 0, 0), "strength": (0, 0, step)}
    found, expected = [], []
    for edges in (True, False):
        scene = scenes["sheet"].with_({"surroundings": {"thickness": True, "edges": edges}})
        fields, solver = FullFields(scene, 2e5), Solver(scene, 1e-4)
        changes = AreaRasterizer.of(0.12, 0.12, fields.grid).raised(place, touch)
        answer = fields.respond(1 + changes["strength"], changes, scene.frequencies)
        found.append([answer.Z, *(answer.by_parameter[name] for name in moved)])

        def solved(by, sign=1.0, solver=solver):
            x, y, rise = np.add((*place, touch.rise), sign * np.array(by))
            text = f"rect({x},{y},{touch.width},{touch.height}):{1 + rise}:rod"
            return solver.solve(parse_press(text, np.nan)).Z

        slopes = [(solved(by) - solved(by, -1.0)) / (2 * step) for by in moved.values()]
        expected.append([solved((0, 0, 0)), *slopes])
    for own, truth in zip(np.subtract(*found), np.subtract(*expected), strict=True):
        assert np.abs(own - truth).max() < 0.2 * np.abs(truth).max()


SETTLED = {
    "readout.magnitude_noise": 0.0,
    "readout.phase_noise": 0.0,
    "readout.magnitude_accuracy": 0.0,
    "readout.phase_accuracy": 0.0,
    "readout.display_digits": 12,
    "dataset.session.unevenness": 0.0,
    "dataset.session.stray_capacitance": 0.0,
    "dataset.session.lead_resistance": 0.0,
    "dataset.press.finger": {"low": 0.0, "high": 5e-12},
}
SAME = {
    f"dataset.session.{name}": 1.0
    for name in ("sheet_resistance", "sheet_mismatch", "capacitance", "contact_resistance")
} | {"dataset.session.foam_spread": 0.0, "dataset.session.loss_tangent": 0.0}


def test_sweeps_of_a_data_set_are_those_of_the_full_model(scenes, tmp_path):
    scene = scenes["mesh"].with_(SETTLED | SAME)
    generate(Plan(scene, 20, 1, RTOL), tmp_path / "set.zarr")
    data = open_zarr(tmp_path / "set.zarr").load()
    solver, Z = Solver(scene, CLOSELY), impedance(data)
    for k in (3, 11, 17):
        truth = solver.solve(parse_press(str(data["press"].values[k]), np.nan)).Z
        off = relative_difference(Z[k], truth).max()
        assert off <= data.attrs["audit_bound"] + CLOSELY <= RTOL + CLOSELY


def test_random_skins_have_walls_of_their_own_foam(families, scenes):
    """Skin with more capacitance at the same thickness: with more permittivity."""
    scene, reduced = scenes["mesh"], families["mesh"]
    foam = nominal(scene)
    foam.capacitance[:] = 1.2
    foam = type(foam)(**{**vars(foam), "beyond_pixels": 1.2})
    press = press_on(scene, "1,1:2.2:rod+1,2:1.5:rod")
    truth = Solver(scene_with(scene, {"capacitance": np.log(1.2)}), CLOSELY).solve(press).Z
    found = reduced.skin(foam).sweep(*touched_cells(scene, press))
    assert relative_difference(found, truth).max() <= RTOL


REFUSED = {
    "a disc": lambda scene: touched_cells(scene, press_on(scene, "disc(0.05,0.05,0.02):2")),
    "places of a data set": lambda scene: Plan(
        scene.with_({"dataset.press.place": "anywhere"}), 20, 1, RTOL
    ),
    "offset of a data set": lambda scene: Plan(
        scene.with_({"dataset.press.offset": 0.1}), 20, 1, RTOL
    ),
    "cells of pixels": lambda scene: Forward(scene, 3),
    "presses at random positions": lambda scene: RandomPresses.of_pixels(
        scene, Uniform(low=1.5, high=2.5), offset=0.1
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_touches_beside_pixels_are_refused_in_one_line(scenes, name):
    with pytest.raises(InputError, match=r"cannot take `surroundings\.edges`.*leave `edges` out"):
        REFUSED[name](scenes["sheet"])
