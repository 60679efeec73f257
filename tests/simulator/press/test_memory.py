"""Standard linear solids: creep, recovery, a held depth, and what unloading does not give back."""

import numpy as np
import pytest
from rcskin.simulator.press.foam_creep import Creep, unloading_strain
from scipy.integrate import quad, solve_ivp

ONE = Creep(np.array([0.1]), np.array([1.0]))
TWO = Creep(np.array([0.3, 0.1]), np.array([7.0, 0.5]))
BOTH = pytest.mark.parametrize("creep", [ONE, TWO], ids=["one solid", "two"])


def under(creep, y, x, seconds):
    """Strain so many s after a load was put on, of memory y."""
    return x + creep.loaded(y, np.array(x), creep.decay(seconds)).sum()


@BOTH
@pytest.mark.parametrize("t", [0.0, 0.2, 3.0])
def test_the_step_response_of_a_standard_linear_solid(creep, t):
    """e / x = 1 + sum_k share_k (1 - exp(-t / time_k))"""
    expected = 1 + (creep.share * (1 - np.exp(-t / creep.time))).sum()
    assert under(creep, creep.nothing(), 0.4, t) == pytest.approx(0.4 * expected, rel=1e-14)


@BOTH
def test_at_once_it_is_elastic_and_in_the_end_it_has_crept_by_its_shares(creep):
    assert under(creep, creep.nothing(), 0.4, 0.0) == 0.4
    end = under(creep, creep.nothing(), 0.4, 1e4)
    assert end == pytest.approx(0.4 * (1 + creep.share.sum()), rel=1e-14)
    assert creep.greatest(creep.nothing(), np.array(0.4)) == pytest.approx(end, rel=1e-14)


@BOTH
@pytest.mark.parametrize("t", [0.1, 2.0])
def test_recovery_mirrors_creep(creep, t):
    """What is left of a foam that had crept to its end is what creep had yet to come to."""
    settled = creep.loaded(creep.nothing(), np.array(0.4), creep.decay(1e5))
    left = under(creep, settled, 0.0, t)
    to_come = under(creep, creep.nothing(), 0.4, 1e5) - under(creep, creep.nothing(), 0.4, t)
    assert left == pytest.approx(to_come, rel=1e-12)


@BOTH
def test_any_course_of_loads_is_boltzmann_s_superposition(creep):
    """e(T) = sum of steps dx_i J(T - t_i), whatever is between them: no error of a time step."""
    begins, loads, end = np.array([0.0, 0.7, 1.9, 2.0]), np.array([0.4, 0.1, 0.5, 0.2]), 6.5
    y = creep.nothing()
    for load, seconds in zip(loads, np.diff([*begins, end]), strict=True):
        y = creep.loaded(y, np.array(load), creep.decay(seconds))
    steps, ages = np.diff([0.0, *loads]), end - begins
    J = 1 + (creep.share * (1 - np.exp(-ages[:, None] / creep.time))).sum(axis=1)
    assert loads[-1] + y.sum() == pytest.approx(steps @ J, rel=1e-13)


@BOTH
def test_a_held_depth_is_the_solution_of_its_equations(creep):
    """The readable twin: time_k dy_k/dt = share_k (e - sum y) - y_k, in small steps."""
    e, y, t = 0.5, creep.nothing() + 0.02, 1.3
    twin = solve_ivp(
        lambda _, y: (creep.share * (e - y.sum()) - y) / creep.time, (0, t), y, rtol=1e-11, atol=0
    )
    np.testing.assert_allclose(creep.clamped(y, np.array(e), t), twin.y[:, -1], rtol=1e-9)


@BOTH
def test_the_force_of_a_held_depth_relaxes_to_its_end(creep):
    """From the elastic force to 1 / (1 + sum of shares) of it; of one solid with its own rate."""
    share, e = creep.share.sum(), np.array(0.5)
    force = [1 - creep.clamped(creep.nothing(), e, t).sum() / e for t in (0.0, 1e4)]
    assert force == pytest.approx([1.0, 1 / (1 + share)], rel=1e-13)
    if len(creep.share) == 1:
        t, faster = 0.4, (1 + share) / creep.time[0]
        after = 1 - creep.clamped(creep.nothing(), e, t).sum() / e
        assert after == pytest.approx((1 + share * np.exp(-faster * t)) / (1 + share), rel=1e-13)


@BOTH
def test_two_spans_are_one(creep):
    e, y = np.array([0.5, 0.2]), creep.nothing(2)
    halves = creep.clamped(creep.clamped(y, e, 0.3), e, 0.9)
    np.testing.assert_allclose(halves, creep.clamped(y, e, 1.2), rtol=1e-12)


@pytest.mark.parametrize("h", [0.0, 0.1, 1 / 3])
def test_unloading_does_not_give_back_its_share_of_the_work(h):
    """Of a foam whose stress is proportional to x: the area between both ways, over M² / 2."""
    most = np.array(0.6)
    between, _ = quad(lambda x: float(unloading_strain(np.array(x), most, h)) - x, 0, 0.6)
    assert between == pytest.approx(h * 0.6**2 / 2, rel=1e-12, abs=1e-16)
    x = np.linspace(0, 0.6, 50)
    assert (np.diff(unloading_strain(x, most, h)) >= -1e-15).all()
    assert unloading_strain(most, most, h) == most and unloading_strain(np.array(0.0), most, h) == 0
    assert unloading_strain(np.array(0.0), np.array(0.0), h) == 0
