"""The uniform open RC line of total R and C: Z = R coth(q)/q with q² = s R C.

A line of uniform segments: the product of their chain matrices, Z = M11/M21. A lossy foam is a
loss-free one at the complex frequency s = omega (tan d + j). Leads and constant-phase foam:
closed forms of the line behind them, and tolerances kept.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.fem.circuit import one_field, two_fields
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.line import Line
from rcskin.simulator.models.lumped import OneRC
from rcskin.simulator.models.parameters import leads_of, own_values, parts_with
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.capacitance import capacitance_map
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.meter import Leads
from rcskin.simulator.sweeps import parallel_capacitance
from rcskin.tests.library.models import impedance
from scipy.optimize import brentq
from scipy.special import bernoulli, factorial

R = (50e3 + 30e3) * 0.10 / 0.08
C = 5e-9 * 0.10 * 0.08
"""Ohm and F of the scene that `make_scene` builds by default."""


def coth_over_q(z):
    """coth(q)/q for q² = z: sum of B_2k 2^2k z^(k-1) / (2k)! where |z| < 1, else as it stands."""
    k = np.arange(26)
    coefficients = bernoulli(50)[::2] * 4.0**k / factorial(2 * k)
    small = np.abs(z) < 1
    series = np.polyval(coefficients[::-1], np.where(small, z, 0)) / z
    q = np.sqrt(z)
    return np.where(small, series, 1 / (q * np.tanh(q)))


@pytest.fixture(scope="module")
def line(make_scene):
    scene = make_scene()
    return Line(scene.parts.skin, scene.parts.setup)


def at(model, frequency_at, u):
    return impedance(model, Press(), frequency_at(model, u))[0]


def relative_Cp(model, frequency_at, u):
    return parallel_capacitance(at(model, frequency_at, u), frequency_at(model, u)) / C


def test_line_is_the_coth_law_in_both_parts(line, frequency_at):
    u = np.geomspace(1e-9, 1e9, 181)
    expected = R * coth_over_q(1j * u)
    np.testing.assert_allclose(
        at(line, frequency_at, u).view(float), expected.view(float), rtol=1e-13
    )


def test_sheet_is_the_coth_law_in_both_parts(make_scene, frequency_at):
    scene = make_scene()
    sheet = SheetModel(
        scene.parts.skin,
        one_field(scene.parts.skin, scene.parts.setup),
        Resolution(order=8, cells=4),
    )
    u = np.geomspace(1e-9, 1e2, 12)
    expected = R * coth_over_q(1j * u)
    np.testing.assert_allclose(
        at(sheet, frequency_at, u).view(float), expected.view(float), rtol=1e-12
    )


def test_foster_sum(line, frequency_at):
    u, terms = np.geomspace(1e-2, 1e2, 17), 10_000
    m = np.arange(1, terms + 1)[:, None]
    poles = (2 / (1j * u + (m * np.pi) ** 2)).sum(axis=0)
    remainder = 2 / np.pi**2 / (terms + 0.5)
    expected = R * (1 / (1j * u) + poles + remainder)
    np.testing.assert_allclose(at(line, frequency_at, u), expected, rtol=1e-11)


def test_low_frequency_expansion(line, frequency_at):
    u = np.array([1e-9, 1e-6, 1e-3])
    np.testing.assert_allclose(
        at(line, frequency_at, u).real, R / 3 * (1 - 2 * u**2 / 315), rtol=1e-13
    )
    np.testing.assert_allclose(relative_Cp(line, frequency_at, u), 1 - 2 * u**2 / 15, rtol=1e-12)


def test_high_frequency_limit(line, frequency_at):
    u = np.geomspace(1e4, 1e9, 6)
    Z = at(line, frequency_at, u)
    np.testing.assert_allclose(Z.real, R / np.sqrt(2 * u), rtol=1e-13)
    np.testing.assert_allclose(relative_Cp(line, frequency_at, u), 1 / np.sqrt(2 * u), rtol=1e-13)
    np.testing.assert_allclose(np.angle(Z, deg=True), -45.0, rtol=1e-13)


@pytest.mark.parametrize(("fraction", "u"), [(0.9, 0.925), (0.5, 3.116)])
def test_where_Cp_has_fallen(line, frequency_at, fraction, u):
    root = brentq(lambda u: relative_Cp(line, frequency_at, u)[0] - fraction, 1e-3, 1e3)
    assert round(root, 3) == u


@pytest.mark.parametrize(("fraction", "u", "digits"), [(0.9, 4.33, 2), (0.5, 18.2, 1)])
def test_where_Rs_has_fallen(line, frequency_at, fraction, u, digits):
    root = brentq(lambda u: at(line, frequency_at, u)[0].real - fraction * R / 3, 1e-3, 1e3)
    assert round(root, digits) == u


def chain(s, R, C):
    """[[cosh q, Zc sinh q], [sinh q / Zc, cosh q]] with q² = s R C, Zc² = R / (s C)."""
    q, Zc = np.sqrt(s * R * C), np.sqrt(R / (s * C))
    return np.array([[np.cosh(q), Zc * np.sinh(q)], [np.sinh(q) / Zc, np.cosh(q)]])


@given(data=st.data(), edge=st.sampled_from(["left", "right", "bottom", "top"]))
def test_line_is_the_product_of_its_segments(make_scene, random, frequency_at, data, edge):
    across = edge in ("left", "right")
    count = data.draw(st.integers(1, 6))
    scene = make_scene(
        {f"top-{edge}": {}, f"bottom-{edge}": {}},
        **{"columns" if across else "rows": count},
        **{name: data.draw(random.logarithmic(1e2, 1e6)) for name in ("top", "bottom")},
    )
    press = data.draw(random.presses(scene))
    skin, frequency = scene.skin, frequency_at(scene, np.geomspace(1e-2, 1e3, 6))
    length, width = (skin.length, skin.width) if across else (skin.width, skin.length)
    R = (skin.top.sheet_resistance + skin.bottom.sheet_resistance) * length / width / count
    from_feed = capacitance_map(scene.parts.skin, press).ravel()[
        :: 1 if edge in ("left", "bottom") else -1
    ]
    expected = []
    for f in frequency:
        M = np.eye(2)
        for c in from_feed:
            M = M @ chain(2j * np.pi * f, R, c * length * width / count)
        expected.append(M[0, 0] / M[1, 0])
    np.testing.assert_allclose(
        Line(scene.parts.skin, scene.parts.setup).solve(press, frequency).Z[0],
        expected,
        rtol=1e-12,
    )


@given(data=st.data())
def test_a_uniform_line_may_be_cut_anywhere(make_scene, frequency_at, data):
    """Segments with the same c act as one."""
    frequency = frequency_at(make_scene(), np.geomspace(1e-6, 1e6, 13))
    scene = make_scene()
    whole = Line(scene.parts.skin, scene.parts.setup).solve(Press(), frequency).Z
    made = make_scene(columns=data.draw(st.integers(2, 50)))
    parts = (
        Line(
            made.parts.skin,
            made.parts.setup,
        )
        .solve(Press(), frequency)
        .Z
    )
    np.testing.assert_allclose(parts.view(float), whole.view(float), rtol=1e-12)


FINE = Resolution(order=8, cells=3)


@given(loss_tangent=st.floats(1e-4, 1.0))
def test_the_coth_law_at_complex_s(make_scene, frequency_at, loss_tangent):
    scene = make_scene(loss_tangent=loss_tangent)
    skin, frequency = scene.skin, frequency_at(scene, np.geomspace(1e-3, 30, 5))
    R = (skin.top.sheet_resistance + skin.bottom.sheet_resistance) * skin.length / skin.width
    C = skin.foam.unpressed_capacitance_per_area * skin.length * skin.width
    q = np.sqrt(2 * np.pi * frequency * (loss_tangent + 1j) * R * C)
    expected = R / (q * np.tanh(q))
    for model in (
        Line(scene.parts.skin, scene.parts.setup),
        SheetModel(scene.parts.skin, one_field(scene.parts.skin, scene.parts.setup), FINE),
    ):
        np.testing.assert_allclose(impedance(model, Press(), frequency)[0], expected, rtol=1e-12)


@pytest.mark.parametrize("loss_tangent", [0.01, 0.3])
def test_low_frequency_resistance_is_the_loss(make_scene, frequency_at, loss_tangent):
    """Rs = tan d / (omega C (1 + tan² d)) + R/3 as omega goes to 0."""
    scene = make_scene(loss_tangent=loss_tangent)
    skin, frequency = scene.skin, frequency_at(scene, [1e-6])
    R = (skin.top.sheet_resistance + skin.bottom.sheet_resistance) * skin.length / skin.width
    C = skin.foam.unpressed_capacitance_per_area * skin.length * skin.width
    loss = loss_tangent / (1 + loss_tangent**2) / (2 * np.pi * frequency * C)
    for model in (
        Line(scene.parts.skin, scene.parts.setup),
        OneRC(SheetModel(scene.parts.skin, two_fields(scene.parts.skin, scene.parts.setup), FINE)),
    ):
        Z = impedance(model, Press(), frequency)[0]
        np.testing.assert_allclose(Z.real, loss + R / 3, rtol=1e-12)


LEADS = Leads(resistance=300.0, inductance=2e-3, stray_capacitance=6e-12)
FREQUENCIES = (1e2, 1e3, 1e4, 1e5)


def behind(scene, leads=LEADS, **foam):
    skin = scene.skin.model_copy(update={"foam": scene.skin.foam.model_copy(update=foam)})
    return scene.model_copy(update={"leads": leads, "skin": skin})


@pytest.mark.parametrize("exponent", [0.6, 0.9, 1.0])
def test_the_coth_law_of_a_constant_phase_line_behind_leads(make_scene, exponent):
    scene = behind(make_scene(frequencies=FREQUENCIES), phase_exponent=exponent)
    f, skin = scene.frequencies, scene.skin
    R = (skin.top.sheet_resistance + skin.bottom.sheet_resistance) * skin.length / skin.width
    C = skin.foam.unpressed_capacitance_per_area * skin.length * skin.width
    charging = 2e3j * np.pi * C * (1j * f / 1e3) ** exponent / 1j
    q = np.sqrt(R * charging)
    line = R / np.tanh(q) / q
    omega = 2j * np.pi * f
    stray = 1 / (1 / line + omega * LEADS.stray_capacitance)
    expected = LEADS.resistance + omega * LEADS.inductance + stray
    np.testing.assert_allclose(Solver(scene.parts).solve(Press()).Z[0], expected, rtol=1e-10)


@pytest.mark.parametrize("exponent", [0.8, 1.0])
@pytest.mark.parametrize("rtol", [1e-3, pytest.param(1e-5, marks=pytest.mark.slow)])
def test_the_tolerance_is_kept_behind_leads(make_scene, exponent, rtol):
    crossed = make_scene({"top-left": {}, "bottom-bottom": {}}, rows=2, columns=2, c=2e-8)
    scene = behind(crossed, phase_exponent=exponent)
    press = parse_press("1,2", 2.0)
    answer, truth = (Solver(scene.parts, each).solve(press) for each in (rtol, 1e-8))
    off = relative_difference(answer.Z, truth.Z).reshape(2, -1)
    told = np.stack(answer.relative_errors).reshape(2, -1)
    assert (off <= told).all()
    assert (told <= rtol).all()


def test_ideal_leads_change_no_bit(make_scene):
    scene = make_scene(rows=1, columns=2)
    press = parse_press("1,2", 2.0)
    plain, led = Solver(scene.parts).solve(press), Solver(behind(scene, Leads()).parts).solve(press)
    np.testing.assert_array_equal(plain.Z, led.Z)
    np.testing.assert_array_equal(plain.Rs_error, led.Rs_error)


@pytest.mark.parametrize("guard", [0.0, 0.4, 1.0])
def test_a_guard_keeps_its_part_of_the_stray_capacitance_from_the_meter(make_scene, guard):
    """Wherever leads enter: solved as they stand, and as parameters of a reduced model."""
    scene = make_scene(rows=1, columns=2, frequencies=FREQUENCIES)
    guarded = behind(scene, LEADS.model_copy(update={"guard": guard}))
    left = LEADS.model_copy(update={"stray_capacitance": (1 - guard) * LEADS.stray_capacitance})
    press = parse_press("1,2", 2.0)
    one, other = (Solver(each.parts).solve(press) for each in (guarded, behind(scene, left)))
    np.testing.assert_allclose(one.Z, other.Z, rtol=1e-14)
    np.testing.assert_allclose(one.Cp_error, other.Cp_error, rtol=1e-9)
    assert leads_of(own_values(guarded.parts.skin, guarded.parts.setup)).unguarded == pytest.approx(
        left.stray_capacitance
    )
    assert parts_with(guarded.parts, {}).setup.leads.unguarded == pytest.approx(
        left.stray_capacitance
    )


def test_a_perfect_guard_alone_leaves_ideal_leads():
    assert Leads(stray_capacitance=1e-12, guard=1.0).ideal
    assert not Leads(stray_capacitance=1e-12, guard=0.9).ideal
