"""Skins of any outline: discs and annuli against formulas, and what holds for all."""

import numpy as np
import pytest
from rcskin.simulator.models.heterogeneous.elements_model import circuit_of
from rcskin.simulator.models.heterogeneous.triangle_meshes import Triangles
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press
from scipy.special import iv, ive, kv, kve

R, C = 1e5, 5e-9
"""ohm/sq of both sheets together, F/m²."""
SHEETS = {"top": 0.6 * R, "bottom": 0.4 * R, "c": C}
SIDE = {"length": 0.12, "width": 0.12}
RADIUS, INNER = 0.06, 0.02
ROUNDING = 1e-9
"""What formulas lose of Rs at u = 1e-6, where it is 1e-7 of |Z|."""
CIRCLE = [0.06, 0.06, RADIUS]
L_SHAPE = [[0, 0], [0.12, 0], [0.12, 0.06], [0.06, 0.06], [0.06, 0.12], [0, 0.12]]
SQUARE = [[0, 0], [0.12, 0], [0.12, 0.12], [0, 0.12]]


def both(edge, **more):
    """The same foil on both sheets; films in proportion to the sheets' resistances."""
    film = more.pop("resistance", 0.0)
    return {
        f"top-{edge}": {**more, "resistance": 0.6 * film},
        f"bottom-{edge}": {**more, "resistance": 0.4 * film},
    }


def solved(scene, rtol, press=None):
    return Solver(scene.parts, rtol).solve(press or Press())


def assert_kept(answer, Z, rtol, off):
    """Rs and Cp are as near to those of Z as was asked, and as was told."""
    estimated, true = np.stack(answer.relative_errors), off(answer.Z, Z)
    assert estimated.max() <= rtol * (1 + 1e-9)
    assert true.max() <= rtol
    assert (true <= estimated + ROUNDING).all()


def disc(s):
    """R/(2 pi k a) I0(ka)/I1(ka), k² = s c R."""
    ka = np.sqrt(s * C * R) * RADIUS
    return R / (2 * np.pi * ka) * ive(0, ka) / ive(1, ka)


def annulus(s, fed, other):
    """Fed at one rim, no current through the other; I and K without their exponentials."""
    x, y = (np.sqrt(s * C * R) * r for r in (fed, other))
    I0x, I1x, I1y = (ive(n, z) * np.exp(-1j * z.imag) for n, z in ((0, x), (1, x), (1, y)))
    K0x, K1x, K1y = kve(0, x), kve(1, x), kve(1, y)
    in_, out = (np.exp(2 * (x - y)), 1.0) if fed < other else (1.0, np.exp(2 * (y - x)))
    outward = 1 if fed < other else -1
    Z = (I0x * K1y * in_ + K0x * I1y * out) / (I1y * K1x * out - I1x * K1y * in_)
    return outward * R / (2 * np.pi * x) * Z


def frequencies(low, high, points):
    """Hz, of u = omega R C a²."""
    u = np.geomspace(low, high, points)
    return u / (2 * np.pi * R * C * RADIUS**2)


@pytest.mark.parametrize(("rtol", "highest"), [(1e-2, 1e4), (1e-3, 1e3), (1e-4, 1e2), (1e-7, 1e2)])
def test_disc(varied, off, rtol, highest):
    f = frequencies(1e-6, highest, 6)
    scene = varied({"outline.circle": CIRCLE}, both("outline"), frequencies=f, **SHEETS, **SIDE)
    assert_kept(solved(scene, rtol), disc(2j * np.pi * f), rtol, off)


@pytest.mark.parametrize(
    ("rtol", "highest"),
    [pytest.param(1e-2, 1e4, marks=pytest.mark.slow), (1e-3, 1e3), (1e-5, 1e1)],
)
@pytest.mark.parametrize(
    ("edge", "fed", "other"), [("outline", RADIUS, INNER), ("hole1", INNER, RADIUS)]
)
def test_annulus(varied, off, edge, fed, other, rtol, highest):
    f = frequencies(1e-6, highest, 6)
    skin = {"outline": {"circle": CIRCLE, "holes": [{"circle": [0.06, 0.06, INNER]}]}}
    scene = varied(skin, both(edge), frequencies=f, **SHEETS, **SIDE)
    assert_kept(solved(scene, rtol), annulus(2j * np.pi * f, fed, other), rtol, off)


def pressed_disc(s, radius, factor, resistance=R):
    """Pressed around its middle: I0 there, I0 and K0 around it, current and V joined at `radius`.

    resistance: of both sheets where they are pressed.
    """
    k, within = np.sqrt(s * C * R), np.sqrt(s * C * factor * resistance)
    x, y, rim = within * radius, k * radius, k * RADIUS
    slope = R / resistance * within * iv(1, x) / iv(0, x)
    part = (k * iv(1, y) - slope * iv(0, y)) / (k * kv(1, y) + slope * kv(0, y))
    along = iv(0, rim) + part * kv(0, rim)
    return R / (2 * np.pi * rim) * along / (iv(1, rim) - part * kv(1, rim))


@pytest.mark.parametrize("piezoresistance", [0.0, 2.0])
@pytest.mark.parametrize("rtol", [1e-3, 1e-5, pytest.param(1e-7, marks=pytest.mark.slow)])
def test_a_disc_pressed_on_a_disc(varied, off, rtol, piezoresistance):
    """By a factor of 3, which without mechanics is a strain of 2/3."""
    f, factor = frequencies(1e-2, 1e2, 4), 3.0
    skin = {"outline.circle": CIRCLE}
    skin |= {f"{sheet}.piezoresistance": piezoresistance for sheet in ("top", "bottom")}
    scene = varied(skin, both("outline"), frequencies=f, **SHEETS, **SIDE)
    answer = solved(scene, rtol, parse_press("disc(0.06,0.06,0.0373):3", 2.0))
    pressed = R * (1 + piezoresistance * (1 - 1 / factor))
    assert_kept(answer, pressed_disc(2j * np.pi * f, 0.0373, factor, pressed), rtol, off)


def test_Rs_of_a_disc_at_low_frequency(varied):
    f = frequencies(1e-6, 1e-5, 2)
    scene = varied({"outline.circle": CIRCLE}, both("outline"), frequencies=f, **SHEETS, **SIDE)
    np.testing.assert_allclose(solved(scene, 1e-5).Z.real, R / (8 * np.pi), rtol=1e-6)


@pytest.mark.parametrize(("edge", "fed", "other"), [("outline", 0.06, 0.02), ("hole1", 0.02, 0.06)])
def test_contact_resistance_of_a_whole_rim_is_in_series(varied, off, edge, fed, other):
    """Z + r_c / (2 pi r), r_c that of both foils."""
    f, r_c = frequencies(1e-2, 1e2, 3), 400.0
    skin = {"outline": {"circle": CIRCLE, "holes": [{"circle": [0.06, 0.06, INNER]}]}}
    scene = varied(skin, both(edge, resistance=r_c), frequencies=f, **SHEETS, **SIDE)
    Z = annulus(2j * np.pi * f, fed, other) + r_c / (2 * np.pi * fed)
    assert_kept(solved(scene, 1e-4), Z, 1e-4, off)


@pytest.mark.parametrize("span", [(0.0, 1.0), (0.25, 0.75)])
def test_a_rectangle_turned_by_30_degrees_is_the_same_rectangle(varied, make_scene, off, span):
    """The straight one is solved by the plain code, a line where the foil is a whole edge."""
    f, along, across = [1e2, 1e4, 1e6], 0.08, 0.05
    turn = np.array([[3**0.5, -1], [1, 3**0.5]]) / 2
    corners = np.array([[0, 0], [along, 0], [along, across], [0, across]]) @ turn.T + [0.03, 0.01]
    foils = both("outline.4", span=span)
    turned = varied({"outline.points": corners.tolist()}, foils, frequencies=f, **SHEETS, **SIDE)
    foils = {f"{sheet}-left": {"span": span} for sheet in ("top", "bottom")}
    straight = make_scene(foils, length=along, width=across, frequencies=f, **SHEETS)
    assert_kept(solved(turned, 1e-4), solved(straight, 1e-6).Z, 1e-4, off)


def test_an_L_is_the_same_seen_in_its_mirror(varied, off):
    skin = {"outline.points": L_SHAPE}
    more = {"frequencies": [1e3, 1e5], "rows": 3, "columns": 3, **SHEETS, **SIDE}
    up = varied(skin, {"top-outline.6": {}, "bottom-outline.1": {}}, **more)
    along = varied(skin, {"top-outline.1": {}, "bottom-outline.6": {}}, **more)
    Z, mirrored = (
        solved(scene, 1e-4, parse_press(f"{press}:3", 2.0)).Z
        for scene, press in ((up, "1,2"), (along, "2,1"))
    )
    assert off(Z, mirrored).max() < 2e-4


def test_terminals_of_any_outline_are_reciprocal(varied):
    skin = {"outline.points": L_SHAPE, "top.anisotropy": {"ratio": 5.0, "angle": 0.4}}
    foils = {"top-outline.6": {}, "bottom-outline.1": {}, "top-outline.2": {"resistance": 9.0}}
    scene = varied(skin, foils, **SHEETS, **SIDE)
    found = Triangles(
        scene.parts.skin, circuit_of(scene.parts.skin, scene.parts.setup), Press(), 1e-2
    ).finer(scene.frequencies)
    s = 2j * np.pi * scene.frequencies
    network = found.coarse.space.network(found.coarse.system.mass, s)
    Y = network.conductance + network.dynamic
    np.testing.assert_allclose(Y, Y.transpose(0, 2, 1), rtol=0, atol=1e-13 * abs(Y).max())


HARD = {
    "outline": {"points": L_SHAPE, "holes": [{"circle": [0.03, 0.03, 0.012]}]},
    "top.anisotropy": {"ratio": 6.0, "angle": 1.0},
    "top.map": {"kind": "gradient", "x": 0.8, "y": 0.5},
    "bottom.piezoresistance": 2.0,
}


def test_any_outline_is_passive(varied):
    """Rs and Cp fall with frequency and the phase stays within -90 and 0 degrees."""
    f = np.geomspace(1e1, 1e5, 9)
    foils = {"top-outline.6": {"span": (0.3, 0.8)}, "bottom-outline.2": {}}
    scene = varied(HARD, foils, frequencies=f, rows=2, columns=2, **SHEETS, **SIDE)
    Z = solved(scene, 1e-2, parse_press("1,2:3", 2.0)).Z[0]
    Cp = (1 / Z).imag / (2 * np.pi * f)
    assert (np.diff(Z.real) <= 0).all()
    assert (np.diff(Cp) <= 0).all()
    assert (Z.imag < 0).all()
    assert (Z.real > 0).all()


def test_the_whole_capacitance_is_there_at_low_frequency(varied):
    """c times the area, of which that of the pressed pixel's part of the outline counts thrice."""
    foils = {"top-outline.6": {}, "bottom-outline.2": {}}
    scene = varied(HARD, foils, frequencies=[1e-3], rows=2, columns=2, **SHEETS, **SIDE)
    Z = solved(scene, 1e-2, parse_press("1,2:3", 2.0)).Z.item()
    whole = C * (0.06 * 0.06 * (2 + 3) - np.pi * 0.012**2)
    assert (1 / Z).imag / (2e-3 * np.pi) == pytest.approx(whole, rel=1e-9)
