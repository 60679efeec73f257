"""Reduced models where `test_contract` does not reach: cosine modes, other bodies, and walls."""

from dataclasses import replace

import numpy as np
import pytest
import rcskin
from rcskin.simulator.bounds.full_fields import FullFields
from rcskin.simulator.bounds.touch_rasterizers import AreaRasterizer, TouchSize
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.limits.random_press_limits import RandomPresses
from rcskin.simulator.models.parameters import HALF_WAVES, Variation, nominal, parts_with
from rcskin.simulator.models.reduced.cases import Case
from rcskin.simulator.models.reduced.forward import Forward
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.models.reduced.slopes import sensitivities, sensitivity
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.batch import NOTHING, TouchedCells
from rcskin.simulator.press.parts import parts_of
from rcskin.simulator.press.press import Press, parse_press, press_on
from rcskin.simulator.press.rasterized import touched_cells
from rcskin.simulator.scene.frequency import Loss
from rcskin.simulator.scene.randomisation import Uniform
from rcskin.simulator.sweeps import InputError
from rcskin.tests.library.scenes import KINDS

RTOL, CLOSELY, STEP = 1e-3, 1e-4, 1e-3


@pytest.mark.slow
def test_cosine_modes_of_the_sheets_are_maps_of_the_sheets(kinds):
    """Conductance raised by a wave in a reduced model, and drawn as a map of resistance."""
    plain = kinds["hexagon"]

    def one(random):
        return Case(
            Variation(
                np.array([1.0, *random.uniform(-0.2, 0.2, 3)]),
                np.array([1.0, *random.uniform(-0.2, 0.2, 3)]),
                np.ones(2),
                np.ones(plain.pixels.shape),
                Loss(0.0),
            ),
            np.zeros(0, dtype=np.int64),
            np.zeros(0),
        )

    reduced = reduce(plain.parts, RTOL, one, modes=len(HALF_WAVES), same_sheets=False)
    wave = 0.15
    nodes = np.linspace(0, 1, 41)
    factors = 1 / (1 + wave * np.cos(np.pi * nodes))
    mapped = plain.with_({"skin.top.map": {"kind": "grid", "values": [factors.tolist()] * 2}})
    own = Variation(
        np.array([1.0, wave, 0, 0]), np.eye(1, 4).ravel(), np.ones(2), np.ones((2, 2)), Loss(0.0)
    )
    Z = reduced.at(own).sweep(*NOTHING)
    truth = Solver(mapped.parts, 1e-4).solve(Press()).Z
    assert relative_difference(Z, truth).max() <= RTOL


SERVED = {
    "sheet-3x3": (
        1e-5,
        1e-7,
        {
            "2,2": "",
            "2,2:30": "reduced: the model is trained on factors from 0.5 to 3.0, got 2,2:30.0",
            "rect(0.05,0.07,0.03,0.02):2.5": "the model takes touches of whole pixels only",
        },
    ),
    "l with a hole": (
        1e-3,
        1e-4,
        {"1,1": "", "1,1:9": "reduced: ", "disc(0.09,0.03,0.01):2": "reduced: "},
    ),
}
"""Tolerance of a scene, that of what it is compared with, and why presses are left to elements."""


@pytest.mark.parametrize(
    "name", ["sheet-3x3", pytest.param("l with a hole", marks=pytest.mark.slow)]
)
def test_the_solver_takes_the_reduced_model_where_it_serves(library, name):
    rtol, closely, presses = SERVED[name]
    scene = library.scene(name) if name in KINDS else rcskin.load(name)
    solver, full = Solver(scene.parts, rtol, "reduced"), Solver(scene.parts, closely)
    for text, reason in presses.items():
        press = parse_press(text, 2.0)
        answer = solver.solve(press)
        assert ("reduced to" in answer.model) == (not reason)
        assert reason in solver.explain(press, answer)
        off = relative_difference(answer.Z, full.solve(press).Z)
        assert (off <= np.stack(answer.relative_errors) + closely).all() and off.max() <= rtol
    if name in KINDS:
        with pytest.raises(InputError, match="there is no skin at that place"):
            solver.solve(parse_press("2,2", 2.0))


def test_bodies_and_rims_of_other_sizes_need_no_other_basis(library):
    scene, values = library.scene("near a virtual earth"), {"body": 0.2, "rim": -0.3}
    variation = replace(nominal(scene.parts.skin), body=np.exp(0.2), rim=np.exp(-0.3))
    model = library.model("near a virtual earth")
    own = model.at(variation)
    truth = Solver(parts_with(scene.parts, values), CLOSELY).solve(Press()).Z
    estimated = own.certificate(*NOTHING).max() + model.mesh_error
    assert relative_difference(own.sweep(*NOTHING), truth).max() <= estimated + CLOSELY < 2 * RTOL


def test_a_finger_among_the_values_is_one_on_every_touched_pixel(library):
    forward = library.forward(library.scene("near a virtual earth"), rtol=0.1)
    given = forward.slopes(TouchedCells(np.array([2]), np.array([0.5])), {"finger": 3e-12}).Z
    touched = forward.slopes(TouchedCells(np.array([2, 6]), np.array([0.5, 3e-12]))).Z
    np.testing.assert_allclose(given, touched, rtol=1e-12)


def test_what_does_not_reduce_is_refused_by_its_key(library):
    with pytest.raises(InputError, match=r"cannot take `surroundings\.thickness`"):
        reduce(
            library.scene("by depth near earth").with_({"surroundings.thickness": True}).parts, RTOL
        )


@pytest.mark.parametrize("name", ["walls", "walls of a hexagon", "walls of groups"])
def test_walls_change_more_than_a_model_leaves_out(library, name):
    scene, press = library.scene(name), parse_press("1,1:2.6:rod+1,2:1.4:rod", np.nan)
    ends = (scene, scene.with_({"surroundings.edges": False}))
    Z = [Solver(each.parts, 0.1 * KINDS[name].rtol).solve(press).Z for each in ends]
    assert relative_difference(*Z).max() > 2 * KINDS[name].rtol


def test_walls_between_groups_of_a_mesh_are_where_these_meet(library):
    """Two groups with foam of no pixel between them, and none of them beside the other."""
    assert parts_of(library.scene("walls of groups").parts.skin).walls.pairs.tolist() == [
        [0, 2],
        [1, 2],
    ]


def test_slopes_where_the_foam_of_pixels_differs_are_differences(library):
    """Walls go with the mean of the permittivity on both sides."""
    scene = library.scene("walls").with_({"pixels": {"rows": 2, "columns": 3}})
    reduced, rises = library.forward(scene, rtol=0.1).reduced, np.array([0.5, 0.8])
    foam = nominal(reduced.parts.skin)
    foam.capacitance[:] = np.linspace(0.8, 1.2, 6).reshape(2, 3)
    skin, cells = reduced.at(foam), np.array([1, 4])
    found = sensitivity(skin, cells, rises, skin.reduced.frequency)
    together = sensitivities(skin, cells[None], rises[None], skin.reduced.frequency)
    for k in range(2):
        step = 1e-4 * np.eye(2)[k]
        up, down = (1 / skin.sweep(cells, rises + sign * step) for sign in (1, -1))
        expected = pytest.approx((up - down) / 2e-4 / skin.unpressed_factors[cells[k]], rel=1e-4)
        assert found.by_cell[..., cells[k]] == expected
        assert together.by_cell[0, ..., k] == expected


def test_slopes_by_place_are_those_of_walls_that_move_with_the_touch(library):
    """What walls add to them, on cells of 15 mm, beside differences of the full solver."""
    touch, place, step = TouchSize(0.04, 0.06, 1.0), (0.055, 0.0375), 1e-3
    moved = {"x": (step, 0, 0), "strength": (0, 0, step)}
    found, expected = [], []
    for edges in (True, False):
        scene = library.scene("walls").with_({"surroundings": {"thickness": True, "edges": edges}})
        fields, solver = FullFields(scene.parts, 2e5), Solver(scene.parts, 1e-4)
        changes = AreaRasterizer.of(scene.parts.skin, fields.grid).raised(place, touch)
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


def test_random_skins_have_walls_of_their_own_foam(library):
    """Skin with more capacitance at the same thickness: with more permittivity."""
    scene = library.scene("walls of groups")
    foam = nominal(scene.parts.skin)
    foam.capacitance[:] = 1.2
    foam = type(foam)(**{**vars(foam), "beyond_pixels": 1.2})
    press = press_on(scene.parts.skin, scene.press, "1,1:2.2:rod+1,2:1.5:rod")
    truth = Solver(parts_with(scene.parts, {"capacitance": np.log(1.2)}), 2e-4).solve(press).Z
    found = library.model("walls of groups").at(foam).sweep(*touched_cells(scene.parts.skin, press))
    assert relative_difference(found, truth).max() <= 2e-3


REFUSED = {
    "a disc": lambda scene: touched_cells(
        scene.parts.skin,
        press_on(scene.parts.skin, scene.press, "disc(0.05,0.05,0.02):2"),
    ),
    "places of a data set": lambda scene: DatasetPlan(
        scene.with_({"dataset.press.place": "anywhere"}).parts, 20, 1, RTOL
    ),
    "offset of a data set": lambda scene: DatasetPlan(
        scene.with_({"dataset.press.offset": 0.1}).parts, 20, 1, RTOL
    ),
    "cells of pixels": lambda scene: Forward(scene.parts, 3),
    "presses at random positions": lambda scene: RandomPresses.of_pixels(
        scene.parts, Uniform(low=1.5, high=2.5), offset=0.1
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_touches_beside_pixels_are_refused_in_one_line(library, name):
    with pytest.raises(InputError, match=r"cannot take `surroundings\.edges`.*leave it out"):
        REFUSED[name](library.scene("walls"))


def test_slopes_beside_bodies_are_differences_where_the_foam_loses_and_air_does_not(library):
    model, press = library.model("near a virtual earth"), (np.array([2, 6]), np.array([0.5, 3e-12]))
    lossy = replace(nominal(model.parts.skin), loss=Loss(tangent=0.03, exponent=0.97), body=1.2)
    f, skin = model.frequency, model.at(lossy)
    found = sensitivity(skin, *press, f)
    together = sensitivities(skin, *(each[None] for each in press), f)
    ends = (model.at(replace(lossy, body=1.2 + sign * STEP)).sweep(*press) for sign in (1, -1))
    up, down = (1 / Z for Z in ends)
    body = found.by_fixed[..., skin.parts.fixed.index("body")]
    assert body == pytest.approx((up - down) / (2 * STEP), rel=1e-5)
    for name in ("Y", "of_foam", "by_weight", "by_finger", "by_fixed"):
        np.testing.assert_allclose(getattr(together, name)[0], getattr(found, name), rtol=1e-9)
    assert found.Y == pytest.approx(1 / skin.sweep(*press), rel=1e-7)
