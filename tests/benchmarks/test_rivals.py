"""Every rival is right on fine enough a mesh: a comparison with something broken shows nothing."""

import math
import shutil

import numpy as np
import pytest
from rcskin.benchmarks.rivals import bilinear, finite_elements, lines, ngspice_grid, rational_fit
from rcskin.benchmarks.rivals.bilinear import Cells
from rcskin.benchmarks.rivals.finite_elements import Elements
from rcskin.simulator.models.line import Line
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.sweeps import parallel_capacitance

COLUMNS = 4
PRESS = "1,2:3"
ENDS = {"top-left": {}, "bottom-right": {}}
U = np.array([0.1, 1.0, 10.0])
needs_ngspice = pytest.mark.skipif(shutil.which("ngspice") is None, reason="needs ngspice")
ON_CELLS = [
    bilinear.by_slope,
    bilinear.by_current,
    bilinear.by_deviation,
    pytest.param(ngspice_grid.impedance, marks=needs_ngspice),
]


def at(make_scene, u, contacts=None, **keywords):
    """A scene with the frequencies at which omega (R_t + R_b) c L² is u."""
    feed = {} if contacts is None else {"contacts": contacts}
    skin = make_scene(**feed, **keywords).skin
    sheets = skin.top.sheet_resistance + skin.bottom.sheet_resistance
    RC = sheets * skin.foam.unpressed_capacitance_per_area * skin.length**2
    return make_scene(**feed, **keywords, frequencies=np.asarray(u) / (2 * np.pi * RC))


@pytest.fixture
def line(make_scene):
    """A scene that is a line of four pixels, a press on the second, and the true Z."""
    scene = at(make_scene, U, columns=COLUMNS)
    press = parse_press(PRESS, 2.0)
    return (
        scene,
        press,
        Line(scene.parts.skin, scene.parts.setup).solve(press, scene.frequencies).Z[0],
    )


def error(scene, Z, truth):
    """Largest relative error of Rs and Cp."""
    Cp, true_Cp = (parallel_capacitance(each, scene.frequencies) for each in (Z, truth))
    return max(abs(Z.real / truth.real - 1).max(), abs(Cp / true_Cp - 1).max())


def slope(error_at, coarse, fine):
    """By which power of the cell's size an error falls."""
    return math.log(error_at(coarse) / error_at(fine)) / math.log(fine / coarse)


@pytest.mark.parametrize("impedance", ON_CELLS)
def test_on_cells_that_conform(line, impedance):
    """First order for the slope at the foil, second for the others."""
    scene, press, truth = line

    def error_at(cells):
        Z = impedance(scene, press, scene.frequencies, Cells(COLUMNS * cells, 2))
        return error(scene, Z, truth)

    expected = 1 if impedance is bilinear.by_slope else 2
    assert slope(error_at, 8, 16) == pytest.approx(expected, abs=0.3)
    assert error_at(16) < (0.2 if impedance is bilinear.by_slope else 2e-3)


def test_on_cells_across_pixel_edges(line):
    """Second order is lost: nearly as many cells as conform are much worse."""
    scene, press, truth = line
    impedance = bilinear.by_deviation
    askew, conforming = (
        error(scene, impedance(scene, press, scene.frequencies, Cells(cells, 1)), truth)
        for cells in (127, 128)
    )
    assert 10 * conforming < askew < 0.02


@pytest.mark.parametrize("impedance", ON_CELLS)
def test_fed_from_opposite_ends(make_scene, impedance):
    """Two fields, against Z = R1 R2/R (1 + 2/(q sinh q)) + (R1² + R2²)/R coth(q)/q, q² = s R C."""
    R1, R2 = 20e3, 80e3
    scene = at(make_scene, U, ENDS, length=0.1, width=0.1, top=R1, bottom=R2)
    q = np.sqrt(1j * U)
    truth = R1 * R2 / (R1 + R2) * (1 + 2 / (q * np.sinh(q)))
    truth = truth + (R1**2 + R2**2) / (R1 + R2) / (q * np.tanh(q))
    cells = Cells(100, 1)
    Z = impedance(scene, Press(), scene.frequencies, cells)
    assert error(scene, Z, truth) < (0.1 if impedance is bilinear.by_slope else 5e-4)


def test_low_frequency(make_scene):
    """The deviation form keeps Rs at u = 1e-9, in single precision too; a current does not."""
    scene = at(make_scene, [1e-9], columns=COLUMNS)
    press, cells = parse_press(PRESS, 2.0), Cells(40, 1)
    truth = Line(scene.parts.skin, scene.parts.setup).solve(press, scene.frequencies).Z[0]

    def error_of(impedance, *number):
        return error(scene, impedance(scene, press, scene.frequencies, cells, *number), truth)

    assert error_of(bilinear.by_deviation) < 1e-3
    assert error_of(bilinear.by_deviation, np.complex64) < 1e-3
    assert error_of(bilinear.by_current) > 0.1


def test_single_precision_is_that(line):
    scene, press, _ = line
    given = scene, press, scene.frequencies, Cells(40, 1)
    single, double = (
        bilinear.by_deviation(*given, number) for number in (np.complex64, np.complex128)
    )
    assert single.dtype == np.complex64
    assert 1e-9 < error(scene, single, double) < 1e-3


def test_ladder(line):
    scene, press, truth = line
    impedance = lines.ladder

    def error_at(sections):
        return error(scene, impedance(scene, press, scene.frequencies, sections), truth)

    assert slope(error_at, 40, 80) == pytest.approx(2, abs=0.1)
    assert error_at(400) < 1e-4


def test_ladder_from_every_edge(make_scene):
    """Pixels are counted from the left and bottom edge, sections from the fed one."""
    for edge, pressed in (("left", "1,2:3"), ("right", "1,3:3"), ("bottom", "2,1:3")):
        upright = edge == "bottom"
        scene = make_scene(
            {f"top-{edge}": {}, f"bottom-{edge}": {}},
            length=0.1,
            width=0.1,
            rows=4 if upright else 1,
            columns=1 if upright else 4,
        )
        press = parse_press(pressed, 2.0)
        truth = Line(scene.parts.skin, scene.parts.setup).solve(press, scene.frequencies).Z[0]
        Z = lines.ladder(scene, press, scene.frequencies, 400)
        assert error(scene, Z, truth) < 1e-3


def test_a_ladder_is_not_fed_from_two_ends(make_scene):
    scene = make_scene(ENDS)
    with pytest.raises(ValueError, match="same edge"):
        lines.ladder(scene, Press(), scene.frequencies, 10)


def test_packaged_lines(line):
    pytest.importorskip("skrf")
    scene, press, truth = line
    Z = lines.cascade(scene, press, scene.frequencies)
    assert error(scene, Z, truth) < 1e-10


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_finite_element_script(line, order):
    """The current that the foil's unknowns draw converges at twice the order."""
    scene, press, truth = line

    def error_at(cells):
        elements = Elements(order, cells)
        return error(
            scene, finite_elements.script(scene, press, scene.frequencies, elements), truth
        )

    coarse = {1: 8, 2: 4, 3: 2, 4: 1}[order]
    assert slope(error_at, coarse, 2 * coarse) == pytest.approx(2 * order, abs=1)
    assert error_at(2 * coarse) < 2e-3


def test_over_resolved_reference(line):
    scene, press, truth = line
    Z = finite_elements.over_resolved(scene, press, scene.frequencies, Elements(8, 2))
    assert error(scene, Z, truth) < 1e-11


@pytest.mark.slow
def test_over_resolved_reference_at_the_end_of_a_foil(make_scene):
    """Two orders agree, numbers of layers agree better, and the graded cells matter."""
    span = {"span": (0.25, 0.75)}
    feed = {"top-left": span, "bottom-left": span}
    scene = at(make_scene, U, feed, rows=2, columns=2)
    impedance = finite_elements.over_resolved
    press = parse_press("1,1:2", 2.0)
    fine, other, fewer, plain = (
        impedance(scene, press, scene.frequencies, Elements(*settings))
        for settings in ((7, 1, 6), (6, 1, 5), (7, 1, 5), (7, 1, 0))
    )
    assert error(scene, other, fine) < 1e-6
    assert error(scene, fewer, fine) < 1e-10
    assert error(scene, plain, fine) > 1e-3


@pytest.mark.parametrize("fit", ["aaa", "polynomials"])
def test_fits_of_exact_samples(line, fit):
    scene, press, truth = line
    Z = rational_fit.impedance(scene, press, scene.frequencies, getattr(rational_fit, fit))
    assert error(scene, Z, truth) < 1e-6


def test_fits_of_readings_lose_rs_and_the_poles(make_scene):
    """Six digits of |Z| and phase do not determine Rs far below the knee."""
    scene = at(make_scene, [1e-8])
    given = scene, Press(), scene.frequencies
    truth = Line(scene.parts.skin, scene.parts.setup).solve(Press(), scene.frequencies).Z[0]
    assert error(scene, rational_fit.impedance(*given), truth) < 1e-6
    assert error(scene, rational_fit.impedance(*given, digits=6), truth) > 1e-2
    assert rational_fit.aaa(*rational_fit.sampled(*given, digits=6)).poles_off_axis > 0


def test_poles_of_a_passive_function():
    """1/(s + 1) + 2/(s + 30) + 1/s has its poles on s <= 0; with a pole pair aside it has not."""
    f = np.geomspace(0.01, 100, 40)
    s = 2j * np.pi * f
    passive = 1 / (s + 1) + 2 / (s + 30) + 1 / s
    assert rational_fit.polynomials(f, passive, degree=3).poles_off_axis == 0
    resonant = passive + 1 / (s**2 + s + 25)
    assert rational_fit.polynomials(f, resonant, degree=5).poles_off_axis == 2


def test_triangles_of_one_size_on_a_square(make_scene):
    """Order 1 falls by h², as the reference is smooth along a line."""
    from skfem import MeshTri

    scene = at(make_scene, U)
    skin, truth = (
        scene.skin,
        Line(scene.parts.skin, scene.parts.setup).solve(Press(), scene.frequencies).Z[0],
    )
    c = skin.foam.unpressed_capacitance_per_area
    square = MeshTri().scaled((skin.length, skin.width))

    def error_at(halved):
        Z = finite_elements.on_triangles(
            square.refined(halved),
            1,
            lambda x: x[0] < 1e-9,
            lambda x: np.full(x.shape[1:], c),
            skin.top.sheet_resistance + skin.bottom.sheet_resistance,
            scene.frequencies,
        )
        return error(scene, Z, truth)

    assert error_at(4) < 2e-2
    assert math.log2(error_at(3) / error_at(4)) > 1.7


def test_membrane_on_a_grid_falls_off_as_the_exponential():
    """Beside a held strip of linear foam w = depth exp(-x / sqrt(T d / E))."""
    from rcskin.simulator.scene.scene_files import load_scene

    tension, modulus, depth = 20.0, 30e3, 1e-6
    foam = {"porosity": 0.67, "solid_permittivity": 2.79, "modulus": modulus, "tension": tension}
    scene = load_scene("foam").with_(
        {"skin.foam.mechanics": foam, "pixels.rows": 1, "press.depth": depth}
    )
    w = finite_elements.deflection(scene, (1, 1), 64)[0]
    length = math.sqrt(tension * scene.skin.foam.thickness / modulus)
    cell = scene.skin.length / len(w)
    beside = w[64:72]
    expected = depth * np.exp(-cell * np.arange(1, 9) / length)
    assert beside == pytest.approx(expected, rel=5e-3)
