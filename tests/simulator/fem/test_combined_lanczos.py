"""Right-hand sides, and excitations, solved together are those solved one by one."""

import numpy as np
import pytest
from rcskin.simulator.fem.circuit import two_fields
from rcskin.simulator.fem.factors import MIN_RIGHT_HAND_SIDES
from rcskin.simulator.fem.lanczos import potentials, potentials_of_all
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.scene_files import load_scene

SHIFTS = np.geomspace(1e3, 1e6, 4)


@pytest.fixture(scope="module")
def sheet():
    scene = load_scene("sheet-5x5-two-interfaces")
    return SheetModel(
        scene.parts.skin,
        two_fields(scene.parts.skin, scene.parts.setup),
        Resolution(order=3, layers=2),
    )


@pytest.mark.kernel
@pytest.mark.parametrize("sides", [1, MIN_RIGHT_HAND_SIDES, 11])
def test_many_right_hand_sides_are_solved_as_one_by_one(sheet, sides):
    y = np.random.default_rng(sides).normal(size=(sheet.space.inner, sides))
    one_by_one = np.stack([sheet.space.solve(each) for each in y.T], axis=1)
    error = np.abs(sheet.space.solve(y) - one_by_one).max() / np.abs(one_by_one).max()
    assert error < 1e-12
    residual = sheet.space.K @ sheet.space.solve(y) - y
    assert np.abs(residual).max() < 1e-9 * np.abs(y).max()


@pytest.mark.parametrize("rtol", [1e-2, 1e-6])
def test_all_potentials_at_once_are_each_by_itself(sheet, rtol):
    """Pencils of two excitations, unpressed and under a touch; some need more steps than others."""
    masses = [sheet.mass(parse_press(text, 2.0)) for text in ("none", "2,3:9")]
    excitations = sheet.circuit.excitations
    inside = [sheet.space.restricted(mass) for mass in masses]
    pencils = sheet.space.pencils(inside, excitations)
    together = potentials_of_all(pencils, SHIFTS, rtol)
    alone = [
        potentials(sheet.space.pencil(mass, excitation, 0.0), SHIFTS, rtol)
        for mass in masses
        for excitation in excitations
    ]
    for found, expected in zip(together, alone, strict=True):
        np.testing.assert_allclose(found, expected, atol=1e-9 * np.abs(expected).max())
