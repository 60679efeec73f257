"""The three-dimensional reference, on coarse grids: closed forms, limits, and what touches do."""

import numpy as np
import pytest
from rcskin.benchmarks.accuracy.foreign_skin import ForeignSkin, Patch, step_excess
from rcskin.benchmarks.accuracy.static_elements import EPS0, Axis, Grid, Sheet, body
from rcskin.benchmarks.accuracy.static_solve import (
    Block,
    Solved,
    Static,
    block_of,
    cross_section,
    plates,
)
from rcskin.benchmarks.accuracy.three_dimensions_checks import local_rise
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError

COARSE = Grid(finest=0.3, ratio=0.12, order=3)
THICKNESS = 4e-3
PLANE, PLANE_PER_AREA = body(1e-6, 2e-4), EPS0 * 2e-4 / 1e-6
"""As thin a layer of so low a permittivity that the field in it is straight."""
SIDE = 0.12


def square(cells=1, order=1):
    """A sheet of 120 x 120 mm."""
    axis = Axis(np.linspace(0, SIDE, cells + 1), order)
    return Sheet(axis, axis)


@pytest.fixture(scope="module")
def scene():
    return load_scene("sheet-5x5").with_({"pixels": 3})


@pytest.fixture(scope="module")
def static(scene):
    return Static(block_of(scene, THICKNESS, order=2, grid=COARSE))


@pytest.fixture(scope="module")
def air(static):
    return static.solved()


@pytest.fixture(scope="module")
def insulated(scene):
    """Without air: its field is straight, so that charges are those of two dimensions."""
    return Static(block_of(scene, 1e-6, order=4, exterior=False, air=1e-12))


def test_strip_in_air():
    """32.005 eps0 for each metre at a width of 30 thicknesses, at 1/2 V and -1/2 V."""
    C = cross_section(Block(square(), SIDE / 30, 1.0).corrected()) / EPS0
    assert C[0, 0] / 2 - C[0, 1] / 2 == pytest.approx(32.005, rel=2e-5)


def in_the_box(far):
    """Two square plates close together, at one potential."""
    grid = Grid(finest=300.0, ratio=0.12, order=3, far=far)
    return plates(Block(square(), 1e-5 * SIDE, 1.0, grid=grid)).sum()


def test_square_plate_in_air():
    """0.36679 . 4 pi eps0 times its side."""
    assert in_the_box(25.0) / (4 * np.pi * EPS0 * SIDE) == pytest.approx(0.36679, rel=5e-3)


def test_walls_of_the_box_do_not_count():
    """A charge sees them by its images, which are taken out; else they counted by 6 and 1 %."""
    assert in_the_box(5.0) == pytest.approx(in_the_box(25.0), rel=5e-4)


def test_two_dimensional_limit(scene, insulated):
    skin = ForeignSkin(scene, insulated.solved(), low="floating", law="permittivity", rtol=1e-9)
    for text in ("none", "2,3:2.0", "1,1:1.5+3,3:3.0"):
        press = parse_press(text, 2.0)
        expected = Solver(scene.parts, 1e-8).solve(press).Z
        assert skin.impedance(press) == pytest.approx(np.asarray(expected), rel=1e-6)


def test_three_conductor_line(scene, insulated):
    """Z = -1 / [W G Gamma tanh(Gamma L)]_12 with Gamma² = s G^-1 C, and an earthed plane below."""
    skin = ForeignSkin(scene, insulated.solved(below=PLANE), rtol=1e-9)
    c, below = scene.skin.foam.unpressed_capacitance_per_area, PLANE_PER_AREA
    R = scene.skin.top.sheet_resistance
    for s, Z in zip(skin.s, skin.impedance()[0], strict=True):
        squared, modes = np.linalg.eig(s * R * np.array([[c, -c], [-c, c + below]]))
        root = np.sqrt(squared)
        Y = SIDE / R * (modes * (root * np.tanh(root * SIDE))) @ np.linalg.inv(modes)
        assert Z == pytest.approx(-1 / Y[0, 1], rel=1e-6)


def test_rim_of_the_papers_sheet(scene, air):
    """Floating, its field adds 5.57 % to the capacitance at low frequencies."""
    floating = ForeignSkin(scene, air, low="floating")
    s = np.array([1j])
    C = (1 / floating.impedance(s=s) / s).real
    flat = scene.skin.foam.unpressed_capacitance_per_area * SIDE**2
    assert C / flat - 1 == pytest.approx(0.0557, abs=3e-4)


def test_earth_takes_from_the_current_into_low(scene, static):
    """22.82 % are added to Rs, 1.29 % to Cp, by a plane 5 mm below, at 1 kHz."""
    skin = ForeignSkin(scene, static.solved(below=body(5e-3)))
    Z, flat = skin.impedance()[0], np.asarray(Solver(scene.parts, 1e-6).solve(Press()).Z)[0]
    assert Z[0].real / flat[0].real - 1 == pytest.approx(0.2282, abs=2e-3)
    assert (1 / Z[0]).imag / (1 / flat[0]).imag - 1 == pytest.approx(0.0129, abs=1e-3)


def test_finger_at_low_frequency(scene, insulated):
    """dRs = R C_f c (L x - x²/2) / C², in the middle of its column and summed over it."""
    skin, finger = ForeignSkin(scene, insulated.solved(), rtol=1e-10), 1e-12
    s = np.array([1j * 10.0])
    R, c = scene.skin.top.sheet_resistance, scene.skin.foam.unpressed_capacitance_per_area
    for column in range(3):
        low, high = (SIDE * (column + more) / 3 for more in (0, 1))
        patch = Patch(low, high, SIDE / 3, 2 * SIDE / 3, finger=finger)
        rise = (skin.impedance([patch], s) - skin.impedance(s=s)).real
        mean = (SIDE * (high**2 - low**2) / 2 - (high**3 - low**3) / 6) / (high - low)
        assert rise == pytest.approx(
            R / SIDE * finger * c * SIDE * mean / (c * SIDE**2) ** 2, rel=1e-4
        )


@pytest.mark.parametrize("low", ["virtual earth", "floating"])
def test_plane_tied_to_a_terminal(scene, insulated, low):
    """It has no field towards the bottom sheet at low, and that of a capacitor at high."""
    s, area = np.array([1j]), SIDE**2
    foam = area * scene.skin.foam.unpressed_capacitance_per_area
    for tied, expected in (("low", foam), ("high", foam + area * PLANE_PER_AREA)):
        skin = ForeignSkin(scene, insulated.solved(below=PLANE), body=tied, low=low)
        assert (1 / skin.impedance(s=s) / s).real == pytest.approx(expected, rel=1e-6)


def test_drifting_factor(scene, air):
    """At each frequency Z is that of the factor there."""
    skin, bounds = ForeignSkin(scene, air), (0.0, 0.04, 0.04, 0.08)
    factors = np.linspace(1.6, 2.0, len(scene.frequencies))
    drifting = skin.impedance([Patch(*bounds, factor=factors)])[0]
    for index in (0, 7, -1):
        held = skin.impedance([Patch(*bounds, factor=factors[index])])[0]
        assert drifting[index] == pytest.approx(held[index], rel=1e-6)


def test_step_of_the_gap():
    """0.2498 eps for each metre, from 4 to 2 mm."""
    assert step_excess(2.0) == pytest.approx(0.2498, abs=1e-4)


@pytest.mark.parametrize(
    ("name", "thickness", "key"),
    [
        ("mug", THICKNESS, "skin.shape"),
        ("stretched", THICKNESS, "skin.stretch"),
        ("l-shape", THICKNESS, "skin.outline"),
        ("sheet-5x5", None, "skin.foam.thickness"),
    ],
)
def test_skins_that_are_not_solved(name, thickness, key):
    with pytest.raises(InputError, match=key):
        block_of(load_scene(name), thickness)


def test_local_rise_is_that_of_the_whole(scene):
    """Permittivity doubled below the middle pixel, to a hundredth of the meter's noise."""
    assert local_rise(scene, COARSE) < 0.01


def test_kept_in_a_file(scene, air, tmp_path):
    air.save(tmp_path / "air.npz")
    read = Solved.load(tmp_path / "air.npz")
    assert (read.charges == air.charges).all()
    skins = (ForeignSkin(scene, each).impedance() for each in (read, air))
    np.testing.assert_array_equal(*skins)
