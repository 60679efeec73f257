"""The solver keeps the tolerance it was asked for, at the least cost, or answers nothing.

Far above cut-off the field has a layer wherever what a sheet carries jumps: the error told.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rcskin.simulator.fem.circuit import one_field, two_fields
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.mesh.quadrilaterals import Resolution, singular_ends
from rcskin.simulator.models.heterogeneous.elements_model import circuit_of
from rcskin.simulator.models.heterogeneous.triangle_meshes import Triangles
from rcskin.simulator.models.line import Line
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, every_press, parse_press
from rcskin.simulator.scene.frequency import laplace_variable, penetration_depth
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import ToleranceError, parallel_capacitance

WHOLE_EDGES = [[(0.0, 1.0)]]


def assert_kept(answer, Z, frequency, rtol):
    """Rs and Cp are within rtol of those of Z, and the estimates own up to the worse one."""
    Cp, true_Cp = (parallel_capacitance(each, frequency) for each in (answer.Z, Z))
    true = max((abs(answer.Z.real / Z.real - 1)).max(), abs(Cp / true_Cp - 1).max())
    estimated = max((answer.Rs_error / Z.real).max(), (answer.Cp_error / true_Cp).max())
    assert estimated <= rtol * (1 + rtol)
    assert true <= rtol, answer.model
    assert true <= estimated + 1e-10, answer.model


def at(scene, frequency):
    """The scene swept over these frequencies."""
    sweep = scene.sweep.model_copy(update={"frequencies": tuple(frequency)})
    return scene.model_copy(update={"sweep": sweep})


def depth(scene):
    """Of the field at the highest frequency, for a press of factor 10, m."""
    skin = scene.skin
    sheets = skin.top.sheet_resistance + skin.bottom.sheet_resistance
    return penetration_depth(
        scene.frequencies[-1], sheets, 10 * skin.foam.unpressed_capacitance_per_area
    )


def over_resolved(scene, press):
    """Z of elements of higher order, on smaller cells, nearer to the ends of foils."""
    circuit = one_field(scene.parts.skin, scene.parts.setup) or two_fields(
        scene.parts.skin, scene.parts.setup
    )
    singular = bool(singular_ends(scene.contacts, scene.skin))
    finest = Resolution(
        order=8 if singular else 10,
        cells=1 if singular else 2,
        layers=11 if singular else 0,
        edge_cell=depth(scene),
    )
    ((Z, _),) = SheetModel(scene.parts.skin, circuit, finest).sweep(press, scene.frequencies, 1e-11)
    return Z


ASKED = {"data": st.data(), "rtol": st.sampled_from([1e-2, 1e-3, 1e-4, 1e-5, 1e-6])}


@settings(max_examples=2)
@given(**ASKED)
def test_any_foils_and_presses(random, frequency_at, data, rtol):
    assert_kept_anywhere(random, frequency_at, data, rtol)


@pytest.mark.slow
@settings(max_examples=40)
@given(**ASKED)
def test_many_foils_and_presses(random, frequency_at, data, rtol):
    assert_kept_anywhere(random, frequency_at, data, rtol)


def assert_kept_anywhere(random, frequency_at, data, rtol):
    scene = data.draw(random.between())
    press = data.draw(random.presses(scene))
    u = data.draw(random.logarithmic(1e-3, 1e3))
    scene = at(scene, frequency_at(scene, [u / 10, u]))
    answer = Solver(scene.parts, rtol).solve(press)
    assert_kept(answer, over_resolved(scene, press), scene.frequencies, rtol)


@settings(max_examples=6)
@given(**ASKED)
def test_smooth_fields(random, frequency_at, data, rtol):
    scene = data.draw(random.between(WHOLE_EDGES, [0.0]).filter(not_singular))
    press = data.draw(random.presses(scene))
    scene = at(scene, frequency_at(scene, data.draw(random.logarithmic(1e-3, 1e3))))
    answer = Solver(scene.parts, rtol).solve(press)
    assert_kept(answer, over_resolved(scene, press), scene.frequencies, rtol)


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, pytest.param(1e-7, marks=pytest.mark.slow)])
def test_a_field_nearly_even_across_its_pixels(make_scene, frequency_at, rtol):
    """Of which every second order gains next to nothing, however high."""
    feed = {"top-right": {}, "top-top": {}, "bottom-right": {}, "bottom-bottom": {}}
    meter = {"meter": (["top-right", "top-top"], ["bottom-bottom", "bottom-right"])}
    size = {"length": 0.1, "width": 0.022, "rows": 3, "columns": 3}
    scene = make_scene(feed, meter, top=180e3, bottom=2.5e3, **size)
    scene = at(scene, frequency_at(scene, 1.0))
    press = parse_press("1,3:5.17+2,3:1.27+3,3:9.36", 2.0)
    answer = Solver(scene.parts, rtol).solve(press)
    assert_kept(answer, over_resolved(scene, press), scene.frequencies, rtol)


def not_singular(scene):
    return not singular_ends(scene.contacts, scene.skin)


@pytest.mark.parametrize("rtol", [1e-2, 1e-4, 1e-5, 1e-6])
@pytest.mark.parametrize("u", [0.1, 1.0, 30.0])
def test_a_field_with_a_plane_of_symmetry(make_scene, frequency_at, u, rtol):
    """Every second order adds nothing to an even field, which does not mean that it is resolved.

    Equal sheets of total R fed from opposite ends: R/2 (1 + 2/(q sinh q) + 2 coth(q)/q), q² = 2sRC.
    """
    feed = {"top-left": {}, "bottom-right": {}}
    scene = make_scene(feed, length=0.1, width=0.1, top=50e3, bottom=50e3)
    scene = at(scene, frequency_at(scene, u))
    q = np.sqrt(1j * np.array([[u]]))
    Z = 50e3 / 2 * (1 + 2 / (q * np.sinh(q)) + 2 / (q * np.tanh(q)))
    assert_kept(Solver(scene.parts, rtol).solve(Press()), Z, scene.frequencies, rtol)


ENDING_WITHIN_AN_EDGE = {
    "a half against a whole": {"top-left": {"span": (0.0, 0.5)}, "bottom-left": {}},
    "a pair": {"top-left": {"span": (0.2, 0.7)}, "bottom-left": {"span": (0.2, 0.7)}},
    "a floating neighbour": {"top-left": {}, "bottom-right": {}, "top-bottom": {"span": (0.3, 1)}},
    "a film": {"top-left": {"span": (0.2, 0.7), "resistance": 30.0}, "bottom-left": {}},
    "a film at an ideal foil": {"top-left": {"resistance": 30.0}, "bottom-left": {}, "top-top": {}},
}
ONE_END_OF_TWO = "a half against a whole"


@pytest.mark.parametrize(
    "foils",
    [
        pytest.param(foils, id=name, marks=[pytest.mark.slow] if name == ONE_END_OF_TWO else [])
        for name, foils in ENDING_WITHIN_AN_EDGE.items()
    ],
)
def test_foils_that_end_within_an_edge(make_scene, frequency_at, foils):
    scene = make_scene(foils, rows=2, columns=2)
    scene = at(scene, frequency_at(scene, [1e-3, 1.0, 1e2]))
    press = parse_press("1,1:3+2,1:1.5", 2.0)
    Z = over_resolved(scene, press)
    for rtol in (1e-2, 1e-3, 1e-4):
        assert_kept(Solver(scene.parts, rtol).solve(press), Z, scene.frequencies, rtol)


@pytest.mark.parametrize("u", [1e2, 1e3, 1e4])
@pytest.mark.parametrize("rtol", [1e-2, 1e-3, 1e-4, 1e-5])
def test_thin_layers_at_high_frequency(make_scene, frequency_at, u, rtol):
    """Elements on a line, of which Z is known: two orders that agree need not be right."""
    scene = at(make_scene(), frequency_at(make_scene(), u))
    answer = Solver(scene.parts, rtol, "sheet").solve(Press())
    assert_kept(
        answer,
        Line(scene.parts.skin, scene.parts.setup).solve(Press(), scene.frequencies).Z,
        scene.frequencies,
        rtol,
    )


def resistance_across_a_gap(make_scene, sheets, gap, rtol):
    """Rs of a skin of which half the left foil floats, `gap` times W away from the driven half."""
    foils = {"top-left": {}, "bottom-left": {}}
    for sheet in sheets:
        foils[f"{sheet}-left"] = {"span": (0.0, 0.5)}
        foils[f"{sheet}-left-2"] = {"span": (0.5 + gap, 1.0)}
    return Solver(make_scene(foils, frequencies=[1.0]).parts, rtol).solve(Press()).Z.real.item()


@pytest.mark.parametrize("sheets", [["top"], ["top", "bottom"]], ids=["one sheet", "both"])
def test_foils_a_small_gap_apart(make_scene, sheets):
    """The gap conducts like ln(1/gap), so 1/(Rs - Rs of the whole foil) grows linearly with it."""
    scene = make_scene()
    whole = Line(scene.parts.skin, scene.parts.setup).solve(Press(), np.array([1.0])).Z.real.item()
    wide, narrow = (
        1 / (resistance_across_a_gap(make_scene, sheets, gap, 1e-4) - whole) for gap in (1e-3, 1e-4)
    )
    expected = whole + 1 / (narrow + (narrow - wide))
    Rs = resistance_across_a_gap(make_scene, sheets, 1e-5, 1e-2)
    assert Rs == pytest.approx(expected, rel=1e-2)


@pytest.mark.parametrize(("edge_end", "factor"), [(0.5, 1), (0.0, 2)])
def test_constriction_at_a_narrow_foil(make_scene, edge_end, factor):
    """Rs grows by R_t ln(w1/w2)/pi as the foil narrows within an edge, twice that at a corner.

    The current spreads from it as in a half or in a quarter of a plane: I R_t / (pi r) or
    2 I R_t / (pi r).
    """
    Rs = []
    for w in (1e-3, 1e-4):
        foils = {"top-left": {"span": (edge_end, edge_end + w)}, "bottom-left": {}}
        scene = make_scene(foils, frequencies=[1.0])
        Rs.append(Solver(scene.parts, 1e-3).solve(Press()).Z.real.item())
    expected = factor * scene.skin.top.sheet_resistance * np.log(10) / np.pi
    assert Rs[1] - Rs[0] == pytest.approx(expected, abs=2e-3 * Rs[1])


def test_a_mere_resistor_is_answered(make_scene):
    """Both sheets in parallel, with no volt across the foam: Cp is nothing but rounding."""
    ends = {f"{sheet}-{end}": {} for sheet in ("top", "bottom") for end in ("left", "right")}
    meter = (["top-left", "bottom-left"], ["top-right", "bottom-right"])
    scene = make_scene(ends, {"meter": meter}, rows=2, columns=2)
    skin = scene.skin
    R1, R2 = (s.sheet_resistance * skin.length / skin.width for s in (skin.top, skin.bottom))
    Z = Solver(scene.parts).solve(parse_press("1,1", 2.0)).Z
    np.testing.assert_allclose(Z, R1 * R2 / (R1 + R2), rtol=1e-11)


@pytest.mark.parametrize("name", ["strip-1x3", "strip-1x4", "strip-1x5"])
def test_the_line_is_chosen_where_it_is_exact(name):
    scene = load_scene(name)
    for press in every_press(scene.parts.skin, scene.press):
        answer = Solver(scene.parts, 1e-9).solve(press)
        assert answer.model == "exact line"
        assert not answer.rejected


def test_one_resistor_and_capacitor_are_chosen_at_low_frequency(make_scene, frequency_at):
    scene = make_scene(rows=2)
    scene = at(scene, frequency_at(scene, 1e-4))
    answer = Solver(scene.parts, 1e-4).solve(parse_press("1,1", 2.0))
    assert answer.model == "one R and one C"
    assert answer.rejected[0].startswith("line:")


def test_a_tolerance_out_of_reach_is_not_answered(make_scene):
    with pytest.raises(ToleranceError, match=r"estimated error .* of Rs at .* Hz .* 1e-15"):
        Solver(make_scene(rows=2).parts, 1e-15).solve(parse_press("1,1", 2.0))


def test_the_same_bits_on_a_second_run():
    scene = load_scene("sheet-3x3")
    first, second = (
        simulate(Solver(scene.parts), every_press(scene.parts.skin, scene.press)) for _ in range(2)
    )
    assert first.identical(second)


LENGTH, C, SHEET = 0.12, 5e-9, 2e4
BY_CHANCE = [
    # gauges of top and bottom, film, width in m, pixels, press, omega (R_t + R_b) c L², asked
    ((0.0, 2.1), 0.0, 0.02, (3, 5), "3,2:3.6", 1.57e4, 6e-4),
    pytest.param((2.5, 0.0), 30.0, 0.06, (2, 5), "2,3:2.6", 5e3, 1e-4, marks=pytest.mark.slow),
]


@pytest.fixture
def opposite(varied):
    """A rectangle fed from opposite ends, its sheets gauges."""

    def opposite(gauges, film, width, pixels, **keywords):
        return varied(
            {f"{s}.piezoresistance": g for s, g in zip(("top", "bottom"), gauges, strict=True)},
            {"top-left": {"resistance": film}, "bottom-right": {}},
            length=LENGTH,
            width=width,
            rows=pixels[0],
            columns=pixels[1],
            top=SHEET,
            bottom=SHEET,
            c=C,
            **keywords,
        )

    return opposite


def by_triangles(scene, press, rtol):
    """Z refined where it is least certain, whatever the coefficients."""
    finer = Triangles(
        scene.parts.skin, circuit_of(scene.parts.skin, scene.parts.setup), press, rtol
    )
    while True:
        rung = finer.finer(scene.frequencies).result(scene.frequencies, rtol)
        if rung.error.max() <= rtol:
            return rung.Z


@pytest.mark.parametrize(("gauges", "film", "width", "pixels", "press", "u", "rtol"), BY_CHANCE)
def test_orders_that_agree_by_chance_do_not_pass(
    opposite, frequency_at, off, gauges, film, width, pixels, press, u, rtol
):
    """In cells far wider than the layers every second order hardly changes the answer."""
    at_rest = opposite(gauges, film, width, pixels)
    scene = opposite(gauges, film, width, pixels, frequencies=frequency_at(at_rest, u).tolist())
    press = parse_press(press, 2.0)
    answer = Solver(scene.parts, rtol).solve(press)
    true = off(answer.Z, by_triangles(scene, press, rtol / 30))
    assert (true <= np.stack(answer.relative_errors)).all()


def two_lines(segments, s):
    """Z of segments (r_t, r_b [ohm/m], c [F/m], length [m]) fed at their opposite ends by 1 A.

    (r_t + r_b) I_t = r_b I - V', V = A exp(-k x) + B exp(-k (l - x)), k² = s c (r_t + r_b); I_t is
    I at the left end and 0 at the right one, V and I_t are continuous.
    """
    r_t, r_b, c, length = np.array(segments).T
    R, count = r_t + r_b, len(segments)
    k = np.sqrt(s * c * R)
    e, one = np.exp(-k * length), np.ones(count)
    V = np.array([[one, e], [e, one]])
    I_t = np.array([[k, -k * e], [k * e, -k]]) / R
    left, right = 0, 1
    system = np.zeros((2 * count, 2 * count), dtype=complex)
    given = np.zeros(2 * count, dtype=complex)
    system[0, :2], given[0] = I_t[left, :, 0], 1 - r_b[0] / R[0]
    for n in range(count - 1):
        here, there = np.s_[2 * n : 2 * n + 2], np.s_[2 * n + 2 : 2 * n + 4]
        for row, form in ((2 * n + 1, V), (2 * n + 2, I_t)):
            system[row, here], system[row, there] = form[right, :, n], -form[left, :, n + 1]
        given[2 * n + 2] = r_b[n + 1] / R[n + 1] - r_b[n] / R[n]
    system[-1, -2:], given[-1] = I_t[right, :, -1], -r_b[-1] / R[-1]
    weights = np.linalg.solve(system, given).reshape(count, 2)
    start, stop = (np.einsum("en,ne->n", V[end], weights) for end in (left, right))
    through_top = (r_b * length - (stop - start)) / R
    return start[0] + (r_b * (length - through_top)).sum()


@pytest.mark.parametrize("u", [1e1, 1e3, 5e3])
def test_a_strip_of_gauges_is_two_lines(opposite, frequency_at, off, u):
    gauges, width, factor = (1.5, 0.4), 0.02, 3.0
    at_rest = opposite(gauges, 0.0, width, (1, 3))
    scene = opposite(gauges, 0.0, width, (1, 3), frequencies=frequency_at(at_rest, u).tolist())
    strain = 1 - 1 / factor
    segments = [(SHEET / width, SHEET / width, C * width, LENGTH / 3)] * 3
    pressed = [SHEET / width * (1 + gauge * strain) for gauge in gauges]
    segments[1] = (*pressed, factor * C * width, LENGTH / 3)
    Z = np.array([[two_lines(segments, s) for s in laplace_variable(scene.frequencies)]])
    answer = Solver(scene.parts, 1e-4).solve(parse_press("1,2:3", 2.0))
    assert (off(answer.Z, Z) <= np.stack(answer.relative_errors)).all()
