"""A rectangle fed along whole edges, where nothing varies across it.

Discs and annuli fed at a whole rim, on curved cells: Z in Bessel functions. Bending leaves the
electrical problem alone; stretch changes it as closed forms say.
"""

import numpy as np
import pytest
from rcskin.benchmarks.accuracy import known_problems as discs
from rcskin.simulator.fem.circuit import two_fields
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.heterogeneous.materials import Materials, metric, position
from rcskin.simulator.models.line import Line
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.models.uniform import equivalent_press
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.press.touch import Polygon, Rectangle, Touch
from rcskin.simulator.scene.scene import Scene

EDGES = ["left", "right", "bottom", "top"]
FINE = Resolution(order=8, cells=3)
U = np.geomspace(1e-6, 30, 9)


def sheet_impedance(scene, press, frequency):
    return SheetModel(
        scene.parts.skin, two_fields(scene.parts.skin, scene.parts.setup), FINE
    ).impedance(press, frequency)[0]


@pytest.mark.parametrize("edge", EDGES)
def test_both_sheets_fed_along_one_edge_are_a_line(make_scene, frequency_at, edge):
    scene = make_scene({f"top-{edge}": {}, f"bottom-{edge}": {}}, rows=2, columns=2)
    column, row = "1,2:3+2,2:3", "2,1:3+2,2:3"
    press = parse_press(column if edge in ("left", "right") else row, 2.0)
    frequency = frequency_at(scene, U)
    line = Line(scene.parts.skin, scene.parts.setup).solve(press, frequency).Z[0]
    sheet = sheet_impedance(scene, press, frequency)
    np.testing.assert_allclose(sheet.view(float), line.view(float), rtol=1e-11)


@pytest.mark.parametrize("edge", EDGES)
def test_contact_resistance_adds_in_series(make_scene, frequency_at, edge):
    """Z grows by (r_t + r_b) / W, here with a ratio of the two unlike that of the sheets."""
    ideal = make_scene({f"top-{edge}": {}, f"bottom-{edge}": {}})
    foiled = make_scene(
        {f"top-{edge}": {"resistance": 70.0}, f"bottom-{edge}": {"resistance": 9.0}}
    )
    W = ideal.skin.width if edge in ("left", "right") else ideal.skin.length
    frequency = frequency_at(ideal, U)
    added = sheet_impedance(foiled, Press(), frequency) - sheet_impedance(ideal, Press(), frequency)
    np.testing.assert_allclose(added.real, (70.0 + 9.0) / W, rtol=1e-8)


@pytest.mark.parametrize(("high", "low"), [("left", "right"), ("top", "bottom")])
def test_sheets_fed_from_opposite_ends(make_scene, frequency_at, high, low):
    """R1 R2/(R1 + R2) (1 + 2/(q sinh q)) + (R1² + R2²)/(R1 + R2) coth(q)/q, q² = s C (R1 + R2)."""
    scene = make_scene({f"top-{high}": {}, f"bottom-{low}": {}})
    skin, frequency = scene.skin, frequency_at(scene, np.geomspace(1e-2, 30, 9))
    squares = skin.length / skin.width if high == "left" else skin.width / skin.length
    R1, R2 = (sheet.sheet_resistance * squares for sheet in (skin.top, skin.bottom))
    C = skin.foam.unpressed_capacitance_per_area * skin.length * skin.width
    q = np.sqrt(2j * np.pi * frequency * C * (R1 + R2))
    expected = R1 * R2 / (R1 + R2) * (1 + 2 / (q * np.sinh(q)))
    expected += (R1**2 + R2**2) / (R1 + R2) / (q * np.tanh(q))
    np.testing.assert_allclose(sheet_impedance(scene, Press(), frequency), expected, rtol=1e-12)


def test_one_sheet_fed_at_both_ends_above_a_floating_one(make_scene, frequency_at):
    """R1 R2/(R1 + R2) + R1²/(R1 + R2) tanh(q/2)/(q/2) with q² = s C (R1 + R2).

    At low frequency the current stays in the driven sheet, at high both share it.
    """
    scene = make_scene({"top-left": {}, "top-right": {}})
    skin, frequency = scene.skin, frequency_at(scene, np.geomspace(1e-2, 30, 9))
    R1, R2 = (s.sheet_resistance * skin.length / skin.width for s in (skin.top, skin.bottom))
    C = skin.foam.unpressed_capacitance_per_area * skin.length * skin.width
    q = np.sqrt(2j * np.pi * frequency * C * (R1 + R2))
    expected = R1 * R2 / (R1 + R2) + R1**2 / (R1 + R2) * np.tanh(q / 2) / (q / 2)
    np.testing.assert_allclose(sheet_impedance(scene, Press(), frequency), expected, rtol=1e-12)


@pytest.mark.parametrize("r_c", [0.0, 300.0, 1.0, 1e-3, 1e-6, 1e-9])
def test_one_sheet_fed_at_both_ends_is_a_resistor_at_low_frequency(make_scene, r_c):
    scene = make_scene({"top-left": {"resistance": r_c}, "top-right": {"resistance": r_c}})
    skin = scene.skin
    Z = sheet_impedance(scene, Press(), np.array([1e-3]))
    R = (skin.top.sheet_resistance * skin.length + 2 * r_c) / skin.width
    np.testing.assert_allclose(Z.real, R, rtol=1e-9)
    assert 0 > Z.imag > -1e-6 * R


@pytest.mark.parametrize(
    "extra", ["top-right", pytest.param("bottom-right", marks=pytest.mark.slow)]
)
def test_a_whole_floating_foil_at_the_open_end_changes_nothing(make_scene, frequency_at, extra):
    """Nothing varies along it, so it has no current to carry."""
    bare = make_scene(columns=3)
    foiled = make_scene({"top-left": {}, "bottom-left": {}, extra: {}}, columns=3)
    press, frequency = Press(), frequency_at(bare, U)
    np.testing.assert_allclose(
        sheet_impedance(foiled, press, frequency),
        sheet_impedance(bare, press, frequency),
        rtol=1e-12,
    )


S = 1j * np.geomspace(1e-6, 1e2, 9)
R1, R2 = 0.3, 1.0


def off(Z, truth):
    """The largest relative error of Rs and Cp."""
    Y, true_Y = 1 / Z, 1 / truth
    return max(abs(Z.real / truth.real - 1).max(), abs(Y.imag / true_Y.imag - 1).max())


def test_formulas_at_low_frequency():
    """Rs(0) = R/(8 pi) for the disc, Cp(0) the whole capacitance for both."""
    s = np.array([1e-4j])
    disc, annulus = discs.disc_formula(s), discs.annulus_formula(s, R1, R2)
    assert disc.real == pytest.approx(1 / (8 * np.pi), rel=1e-6)
    assert (1 / disc).imag / 1e-4 == pytest.approx(np.pi, rel=1e-6)
    assert (1 / annulus).imag / 1e-4 == pytest.approx(np.pi * (R2**2 - R1**2), rel=1e-6)


def test_disc():
    """Each two orders more gain a digit at the least."""
    usable = S[S.imag > 1e-4]
    errors = [
        off(discs.impedance(discs.disc(2, p), 1.0, p, usable), discs.disc_formula(usable))
        for p in (4, 6, 8)
    ]
    assert errors[0] < 1e-3
    assert errors[2] < 1e-2 * errors[0]
    assert errors[2] < 1e-7


def test_Rs_of_a_disc_at_low_frequency():
    Z = discs.impedance(discs.disc(2, 8), 1.0, 8, S[:1])
    assert Z.real == pytest.approx(1 / (8 * np.pi), rel=1e-10)


@pytest.mark.parametrize("unrolled", [False, True])
def test_annulus(unrolled):
    usable, order = S[S.imag > 1e-4], 8
    way = discs.unrolled_annulus if unrolled else discs.annulus
    Z = discs.impedance(way(2, order, R1, R2), R1, order, usable)
    assert off(Z, discs.annulus_formula(usable, R1, R2)) < (1e-9 if unrolled else 2e-5)


X = np.random.default_rng(3).uniform(0, 1, (2, 200)) * np.array([0.10, 0.08])[:, None]
FREQUENCIES = (1e2, 1e4, 1e6)


def skin_with(scene, **tables):
    given = scene.model_dump(by_alias=True, exclude_none=True)
    given["skin"] |= tables
    return Scene.model_validate(given)


@pytest.mark.parametrize("axis", ["x", "y"])
def test_bending_to_a_mug_keeps_every_length(make_scene, axis):
    """G = F'F is the identity: to rounding by the tangents, and by distances along the skin."""
    bent = skin_with(make_scene(), shape={"kind": "cylinder", "radius": 0.03, "axis": axis})
    G = metric(bent.parts.skin, X).G
    np.testing.assert_allclose(G, np.array([1.0, 1.0, 0.0])[:, None] + 0 * G, atol=4e-16)
    close = X + 1e-5 * np.random.default_rng(4).normal(size=X.shape)
    in_space = np.sqrt(
        np.sum((position(bent.parts.skin, X) - position(bent.parts.skin, close)) ** 2, axis=0)
    )
    np.testing.assert_allclose(in_space, np.hypot(*(X - close)), rtol=1e-6)


def test_bending_to_a_mug_changes_no_bit_of_the_problem(make_scene):
    flat = make_scene(
        {"top-left": {}, "bottom-bottom": {"span": (0.2, 0.7)}}, rows=2, columns=2, factor=2.5
    )
    bent = skin_with(flat, shape={"kind": "cylinder", "radius": 0.04})
    of_flat, of_bent = Materials(flat.parts.skin), Materials(bent.parts.skin)
    for electrode in ("top", "bottom"):
        np.testing.assert_array_equal(
            of_bent.conductance(electrode, X), of_flat.conductance(electrode, X)
        )
    np.testing.assert_array_equal(of_bent.capacitance(X), of_flat.capacitance(X))
    assert bent.parts.skin.electrical == flat.parts.skin
    press = Press((Touch(1, 2, 2.5),))
    assert equivalent_press(bent.parts.skin, press) == press
    Z = [Solver(scene.parts.evened, 1e-3).solve(press).Z for scene in (flat, bent)]
    np.testing.assert_array_equal(*Z)


@pytest.mark.parametrize("film", [0.0, 50.0])
def test_a_strip_pulled_by_a_fifth_follows_its_line(make_scene, film):
    """By hand: a strip of 100 x 20 mm becomes 120 mm long and 20 / sqrt(1.2) mm wide.

    The rubber of its electrodes keeps its volume: with J = 1.2 / sqrt(1.2) = sqrt(1.2) they are J
    times thinner, R' = R sqrt(1.2), so the loop's resistance (R_t + R_b) L / W grows by sqrt(1.2) x
    1.2 sqrt(1.2) = 1.44. The foam, of Poisson ratio 0.3, thins by J^(0.3 / 0.7) = 1.2^(3 / 14), and
    the area grows by 1.2^(1 / 2): C grows by 1.2^(5 / 7). Contacts, of so many ohm m for the line
    of contact as it is, have a line that is sqrt(1.2) times shorter.
    """
    contacts = {"top-left": {"resistance": film}, "bottom-left": {"resistance": 0.6 * film}}
    strip = make_scene(contacts, length=0.1, width=0.02, frequencies=FREQUENCIES)
    scene = skin_with(strip, stretch={"x": 1.2, "foam_poisson_ratio": 0.3})
    R = (50e3 + 30e3) * 0.1 / 0.02 * 1.44
    C = 5e-9 * 0.1 * 0.02 * 1.2 ** (5 / 7)
    q = np.sqrt(2j * np.pi * scene.frequencies * R * C)
    expected = R / np.tanh(q) / q + 1.6 * film / 0.02 * 1.2**0.5
    folded = scene.parts.evened
    Z = Solver(folded).solve(Press()).Z[0]
    np.testing.assert_allclose(Z, expected, rtol=1e-11)
    by_elements = Solver(folded, 1e-6, model="sheet").solve(Press()).Z[0]
    np.testing.assert_allclose(by_elements, Z, rtol=2e-6)


@pytest.mark.parametrize("ratios", [(1.2, None), (1.3, 0.8), (1.5, 1.5)])
def test_uniform_coefficients_are_those_of_the_plain_scene(make_scene, ratios):
    """On the stretched skin S' = L S L / J and c' = c / J, L the stretch: that scene is plain."""
    stretch = {"x": ratios[0], "foam_poisson_ratio": 0.1}
    if ratios[1] is not None:
        stretch["y"] = ratios[1]
    scene = skin_with(make_scene(), stretch=stretch)
    plain, materials = Materials(scene.parts.skin.electrical), Materials(scene.parts.skin)
    along, across = scene.skin.stretch.ratios
    J, L = along * across, np.array([along**2, across**2, along * across])[:, None]
    moved = X * np.array([along, across])[:, None]
    for electrode in ("top", "bottom"):
        S = materials.conductance(electrode, X)
        np.testing.assert_allclose(L * S / J, plain.conductance(electrode, moved), rtol=1e-13)
    np.testing.assert_allclose(materials.capacitance(X) / J, plain.capacitance(moved), rtol=1e-13)
    edge = np.array([[1.0, 0.0], [0.0, 1.0]])
    np.testing.assert_allclose(materials.line_stretch(X[:, :2], edge), [along, across], rtol=1e-14)


def test_turned_fibres_stretch_as_their_directions_do(make_scene):
    """Pulled along x by a, along x a sheet is longer and thinner, by a each; across, wider too."""
    pulled = {"x": 1.2, "y": 1.0}
    tables = {"sheet_resistance": 50e3, "anisotropy": {"ratio": 4.0}}
    scene = skin_with(make_scene(), top=tables, stretch=pulled)
    S = Materials(scene.parts.skin).conductance("top", X)[:, 0]
    np.testing.assert_allclose(S[:2] * 50e3, [2 / 1.2**2, 0.5], rtol=1e-13)


CROSSED = {"top-left": {"resistance": 20.0}, "bottom-bottom": {"span": (0.2, 0.7)}}
UNEVENLY = {"x": 1.2, "y": 0.9}


def test_elements_with_a_metric_find_what_the_stretched_rectangle_has(make_scene):
    """A map that varies by nothing keeps the stretch from being folded in."""
    scene = make_scene(CROSSED, rows=2, columns=2)
    press = Press((Touch(1, 2, 2.0), Rectangle(0.03, 0.03, 0.02, 0.03, 1.5)))
    folded = Solver(skin_with(scene, stretch=UNEVENLY).parts, 1e-4).solve(press)
    nothing = {"kind": "gradient", "x": 1e-14}
    top = {"sheet_resistance": 50e3, "map": nothing}
    by_metric = Solver(skin_with(scene, stretch=UNEVENLY, top=top).parts, 1e-4).solve(press)
    assert folded.model != by_metric.model
    np.testing.assert_allclose(by_metric.Z, folded.Z, rtol=2e-4)


def test_a_place_pressed_moves_with_the_stretched_skin(make_scene):
    """What has no plain scene is solved at rest with a metric: a polygon, and where it has gone."""
    scene = skin_with(make_scene(CROSSED), stretch=UNEVENLY)
    corners = np.array([[0.02, 0.02], [0.07, 0.03], [0.04, 0.06]])
    at_rest = Polygon(tuple(map(tuple, corners.tolist())), 2.5)
    moved = Polygon(tuple(map(tuple, (corners * [1.2, 0.9]).tolist())), 2.5)
    one = Solver(scene.parts, 1e-4).solve(Press((at_rest,))).Z
    other = Solver(scene.parts.evened, 1e-4).solve(Press((moved,))).Z
    np.testing.assert_allclose(one, other, rtol=2e-4)
