"""Formulas of what is around a skin, and of its sizes."""

import numpy as np
import pytest
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.models.validity import rim_share, straight_share
from rcskin.simulator.press.finger import finger_capacitance
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Rectangle, Touch

EPS0 = 8.8541878128e-12
LOW = [1e-3]
"""Hz: each sheet is at one potential."""


@pytest.fixture
def drawn(rng, make_scene):
    """A skin of random numbers with all around it, and those numbers by name."""
    f, t, b = rng.uniform(1e-10, 1e-9), *rng.uniform(1e-12, 1e-11, 2)
    given = {
        "m": rng.uniform(1e-12, 1e-11),
        "t": t,
        "b": b,
        "top": {"side": "top", "capacitance_per_area": f},
        "bottom": {"side": "bottom", "distance": rng.uniform(1e-3, 1e-1)},
    }
    scene = make_scene(length=0.1, width=0.06, frequencies=LOW)
    return scene, given


def cp(scene, press=None):
    """Cp in F of a press at the lowest frequency."""
    found = Solver(scene.parts, 1e-6).solve(press or Press())
    return float((1 / found.Z).imag[0, 0] / (2 * np.pi * LOW[0]))


def test_charges_of_a_meter_that_floats(drawn):
    """
    c_e (V_s - V_e)^2 / 2
    (m (V_t - V_b)^2 + t V_t^2 + b V_b^2) / 2

    Sheets of one potential each: C_m between them, beside C_t and C_b to earth in series.
    """
    scene, n = drawn
    rim = {"mutual": n["m"], "top": n["t"], "bottom": n["b"]}
    near = {"low": "floating", "rim": rim, "body": [n["top"], n["bottom"]]}
    A, P = 0.1 * 0.06, 2 * (0.1 + 0.06)
    C_t = n["top"]["capacitance_per_area"] * A + n["t"] * P
    C_b = EPS0 / n["bottom"]["distance"] * A + n["b"] * P
    expected = 5e-9 * A + n["m"] * P + 1 / (1 / C_t + 1 / C_b)
    assert cp(scene.with_({"surroundings": near})) == pytest.approx(expected, rel=1e-6)


def test_charge_of_a_finger(drawn):
    """
    C_f / A V_s^2 / 2

    On the top sheet, over an eighth of the skin, and a body at the bottom one.
    """
    scene, n = drawn
    near = {"low": "floating", "body": n["bottom"]}
    A, C_f = 0.1 * 0.06, 4e-12
    C_b = EPS0 / n["bottom"]["distance"] * A
    pressed = Press((Rectangle(0.03, 0.03, 0.05, 0.015, 1.0, C_f),))
    expected = 5e-9 * A + 1 / (1 / C_f + 1 / C_b)
    assert cp(scene.with_({"surroundings": near}), pressed) == pytest.approx(expected, rel=1e-6)


def test_field_across_the_foam(rng, drawn):
    """
    eps d / 6 (G_t^2 + G_t . G_b + G_b^2)

    Of equal sheets, V_t = -V_b: a conductance beside that of the sheets in series.
    """
    scene, _ = drawn
    d, R, s = rng.uniform(2e-3, 6e-3), 2 * scene.skin.top.sheet_resistance, 2j * np.pi * 3e6
    changes = {"skin.bottom.sheet_resistance": R / 2, "skin.foam.thickness": d}
    thick = scene.with_(
        {**changes, "surroundings": {"thickness": True}, "sweep.frequencies": [3e6]}
    )
    G_t, G_b, eps = 1 / 2, -1 / 2, 5e-9 * d
    along = 2 * eps * d / 6 * (G_t**2 + G_t * G_b + G_b**2)
    series = 1 / (1 / R + s * along)
    q = np.sqrt(s * series * 5e-9) * 0.1
    found = Solver(thick.parts, 1e-6).solve(Press()).Z.item()
    assert found == pytest.approx(series * 0.1 / 0.06 / q / np.tanh(q), rel=1e-5)


def test_walls_of_a_touch(drawn):
    """
    eps E (V_t - V_b)^2 / 2
    E = 1 / pi ((1 + a^2) / a ln((1 + a) / (1 - a)) - 2 ln(4 a / (1 - a^2)))

    Around a half of the skin: its width is all the wall that there is.
    """
    scene, _ = drawn
    changes = {"skin.foam.thickness": 4e-3, "surroundings": {"thickness": True, "edges": True}}
    pressed, a = Press((Rectangle(0.025, 0.03, 0.05, 0.06, 3.0),)), 1 / 3
    E = 1 / np.pi * ((1 + a**2) / a * np.log((1 + a) / (1 - a)) - 2 * np.log(4 * a / (1 - a**2)))
    expected = 5e-9 * 0.1 * 0.06 * 2 + 5e-9 * 4e-3 * E * 0.06
    assert cp(scene.with_(changes), pressed) == pytest.approx(expected, rel=1e-6)


def test_current_into_a_virtual_earth(drawn):
    """
    Z = U_high / I_low

    What goes from the high side to earth does not reach the low one.
    """
    scene, n = drawn
    near = {"rim": {"mutual": n["m"], "top": n["t"]}, "body": [n["top"], n["bottom"]]}
    expected = 5e-9 * 0.1 * 0.06 + n["m"] * 2 * (0.1 + 0.06)
    assert cp(scene.with_({"surroundings": near})) == pytest.approx(expected, rel=1e-6)


def test_fingers(rng, make_scene):
    """
    C_f = 8.8541878128e-12 A / (t_c / eps_c + a)
    C_f' = C_f 150e-12 / (C_f + 150e-12)
    """
    t_c, eps_c, a = rng.uniform(1e-4, 1e-3), rng.uniform(1, 5), rng.uniform(0, 1e-2)
    scene = make_scene(length=0.1, width=0.06).with_(
        {"surroundings": {"air": a, "cover": {"thickness": t_c, "relative_permittivity": eps_c}}}
    )
    earthed, floating = (
        finger_capacitance(scene.parts.skin, Touch(1, 1, 1.0), how)
        for how in ("earthed", "floating")
    )
    C_f = 8.8541878128e-12 * 0.1 * 0.06 / (t_c / eps_c + a)
    assert earthed == pytest.approx(C_f)
    assert floating == pytest.approx(C_f * 150e-12 / (C_f + 150e-12))


def test_sizes(rng, make_scene):
    """
    P gamma / C
    gamma = 8.8541878128e-12 / (2 pi) (1 + ln(2 pi (w_m / d + 1 / 2))),  w_m = (L^-1.5 + W^-1.5)^(-2 / 3)
    (d / delta)^2 / 6
    """  # noqa: E501
    L, W, d, delta = 0.1, 0.06, rng.uniform(1e-3, 5e-3), rng.uniform(1e-2, 1e-1)
    scene = make_scene(length=L, width=W).with_({"skin.foam.thickness": d})
    C, P, pi = 5e-9 * L * W, 2 * (L + W), np.pi
    w_m = (L**-1.5 + W**-1.5) ** (-2 / 3)
    gamma = 8.8541878128e-12 / (2 * pi) * (1 + np.log(2 * pi * (w_m / d + 1 / 2)))
    assert rim_share(scene.parts.skin) == pytest.approx(P * gamma / C)
    assert straight_share(d, delta) == pytest.approx((d / delta) ** 2 / 6)
