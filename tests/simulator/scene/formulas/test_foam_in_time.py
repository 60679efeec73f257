"""Formulas of foam that creeps, and of the weather."""

import numpy as np
import pytest
from rcskin.simulator.measure.foam_state import FoamState
from rcskin.simulator.press.foam_creep import Creep, unloading_strain
from rcskin.simulator.press.press import Press, press_on
from scipy.integrate import solve_ivp


@pytest.fixture
def solids(rng):
    """Shares and time constants of two solids."""
    return rng.uniform(0.01, 0.2, 2), rng.uniform(0.1, 10.0, 2)


@pytest.fixture
def creeping(make_scene, solids):
    keys = [{"share": s, "time_constant": t} for s, t in np.transpose(solids).tolist()]
    return make_scene(columns=3).with_({"skin.foam.relaxation": keys})


def strain(state, t):
    """Of the only touch of a foam state, so many s later."""
    (touch,) = state.after(t).touches
    return 1 - 1 / touch.factor


def test_creep_and_recovery(creeping, solids, rng):
    """
    e = x + y_1 + y_2
    t_k dy_k/dt = s_k x - y_k
    e = x (1 + s_1 (1 - exp(-t / t_1)) + s_2 (1 - exp(-t / t_2)))
    e = y_1 exp(-t / t_1) + y_2 exp(-t / t_2)
    """
    (s, T), (held, t) = solids, rng.uniform(0.1, 5.0, 2)
    pressed = FoamState(creeping.parts.skin).then(
        press_on(creeping.parts.skin, creeping.press, "1,2:2.0"), 0.0
    )
    x = 0.5
    assert strain(pressed, t) == pytest.approx(x * (1 + (s * (1 - np.exp(-t / T))).sum()))
    y = solve_ivp(lambda _, y: (s * x - y) / T, (0, held), [0.0, 0.0], rtol=1e-10, atol=1e-13).y[
        :, -1
    ]
    assert strain(pressed, held) == pytest.approx(x + y.sum(), rel=1e-7)
    let_go = pressed.then(Press(), held)
    assert strain(let_go, t) == pytest.approx((y * np.exp(-t / T)).sum(), rel=1e-6)


def test_a_constant_depth(solids, rng):
    """
    t_k dy_k/dt = s_k (e - y_1 - y_2) - y_k
    F / F(0) = (1 + s_1 exp(-(1 + s_1) t / t_1)) / (1 + s_1)
    """
    (s, T), (e, t) = solids, rng.uniform(0.1, 0.6, 2)
    y = solve_ivp(
        lambda _, y: (s * (e - y.sum()) - y) / T, (0, t), [0.0, 0.0], rtol=1e-10, atol=1e-13
    )
    two = Creep(s, T)
    np.testing.assert_allclose(two.clamped(two.nothing(), np.array(e), t), y.y[:, -1], rtol=1e-7)
    one = Creep(s[:1], T[:1])
    force = 1 - one.clamped(one.nothing(), np.array(e), t).sum() / e
    relaxed = (1 + s[0] * np.exp(-(1 + s[0]) * t / T[0])) / (1 + s[0])
    assert force == pytest.approx(relaxed, rel=1e-12)


def test_unloading(rng):
    """
    x' = x + 3 h x (1 - x / x_max)
    """
    x, more, h = rng.uniform(0.0, 0.3, (3, 8))
    x_max = x + more
    np.testing.assert_allclose(
        [unloading_strain(*each) for each in zip(x, x_max, h, strict=True)],
        x + 3 * h * x * (1 - x / x_max),
        rtol=1e-14,
    )


def test_the_weather(make_scene, rng):
    """
    c_T = c (1 + a (T - reference))
    R_T = R0 (1 + b (T - reference))
    """
    a, b = rng.uniform(-5e-3, 5e-3, 2)
    table = {"reference": 20.0, "capacitance": a, "sheet_resistance": b}
    scene = make_scene().with_({"skin.foam.humidity": table, "experiment.humidity": 55.0})
    assert scene.skin.foam.unpressed_capacitance_per_area == pytest.approx(5e-9 * (1 + a * 35.0))
    assert scene.skin.bottom.sheet_resistance == pytest.approx(30e3 * (1 + b * 35.0))
