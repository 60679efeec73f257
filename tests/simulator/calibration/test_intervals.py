"""Intervals by the profile of the likelihood: of straight problems, curved ridges and limits."""

from types import SimpleNamespace

import numpy as np
import pytest
from rcskin.simulator.calibration.choice import Options
from rcskin.simulator.calibration.law import NORMAL
from rcskin.simulator.calibration.profile import Along, Profile
from rcskin.simulator.calibration.run import calibrate
from scipy.optimize import least_squares

FREE = (np.full(2, -np.inf), np.full(2, np.inf))
GRID = np.linspace(-6, 6, 2401)


def fit_of(reading, slopes, u, bounds=FREE):
    """Two unknowns with priors of 1, and readings with their slopes to them."""
    problem = SimpleNamespace(
        residuals=lambda u: np.append(reading(u), u),
        jacobian=lambda u: np.vstack([slopes(u), np.eye(2)]),
        bounds=lambda: bounds,
    )
    asked = SimpleNamespace(fitted={"first": None, "second": None})
    return SimpleNamespace(problem=problem, asked=asked, u=np.array(u, dtype=float))


def along(k, limits=(-np.inf, np.inf)):
    return Along(lambda u: (float(u[k]), np.eye(2)[k]), k, limits)


def integrated(reading, k, bounds=FREE):
    """The exact 95 % of an unknown, with equal tails, by summing over all of the other's values."""
    u = np.stack(np.meshgrid(GRID, GRID, indexing="ij"))
    readings = np.reshape(reading(u), (-1, *u.shape[1:]))
    chance = np.exp(-((readings**2).sum(axis=0) + (u**2).sum(axis=0)) / 2)
    for each, low, high in zip(u, *bounds, strict=True):
        chance[(each < low) | (each > high)] = 0.0
    below = np.cumsum(chance.sum(axis=1 - k))
    return np.interp([0.025, 0.975], below / below[-1], GRID)


def least_of(reading, bounds=FREE):
    return least_squares(
        lambda u: np.append(reading(u), u), np.array([0.5, 0.1]), bounds=bounds, xtol=1e-12
    ).x


def straight(u):
    return (u[0] + 2 * u[1] - 1) / 0.3


def slopes_of_straight(u):
    return np.array([1.0, 2.0]) / 0.3


def test_where_all_is_linear_the_interval_is_the_linear_one():
    u = np.linalg.lstsq(np.array([[1 / 0.3, 2 / 0.3], [1, 0], [0, 1]]), [1 / 0.3, 0, 0])[0]
    for scale in (1.0, 1.7):
        profile = Profile(fit_of(straight, slopes_of_straight, u), scale, NORMAL)
        for k in (0, 1):
            assert profile.linear(along(k))
            reach, middle = NORMAL * profile.deviation(along(k)), profile.best[k]
            found = profile.law(along(k)).interval(0.95)
            np.testing.assert_allclose(found, (middle - reach, middle + reach), atol=5e-3 * reach)


def test_a_wider_law_is_wider_by_as_much():
    fit = fit_of(straight, slopes_of_straight, least_of(straight))
    own, wide = (
        np.ptp(Profile(fit, 1.0, times * NORMAL).law(along(0)).interval(0.95)) for times in (1, 1.5)
    )
    assert wide == pytest.approx(1.5 * own, rel=5e-3)


@pytest.mark.parametrize("k", [0, 1])
def test_a_curved_ridge_ends_where_the_integral_does(k):
    """Far above a cut-off the ratio is told, and of the product that it is large, not how large."""

    def reading(u):
        wall = (np.exp(-1.5 * (u[0] + u[1])) - 0.05) / 0.1
        return np.array([wall, (u[0] - u[1] - 0.1 * u[0] ** 2) / 0.1])

    def slopes(u):
        fall = -15 * np.exp(-1.5 * (u[0] + u[1]))
        return np.array([[fall, fall], [(1 - 0.2 * u[0]) / 0.1, -10.0]])

    fit = fit_of(reading, slopes, least_of(reading))
    profile = Profile(fit, 1.0, NORMAL)
    assert not profile.linear(along(k))
    exact = integrated(reading, k)
    found = np.array(profile.law(along(k)).interval(0.95))
    reach = NORMAL * profile.deviation(along(k))
    linear = profile.best[k] + np.array([-reach, reach])
    np.testing.assert_allclose(found, exact, atol=0.05 * np.ptp(exact))
    assert np.abs(found - exact).max() < 0.5 * np.abs(linear - exact).max()


def test_what_a_bound_of_another_unknown_cuts_off_is_missing():
    bounds = (np.array([0.0, -np.inf]), np.full(2, np.inf))
    best = least_of(straight_down, bounds)
    profile = Profile(
        fit_of(straight_down, lambda u: np.array([1.0, 1.0]) / 0.3, best, bounds), 1.0, NORMAL
    )
    assert not profile.linear(along(1))
    exact = integrated(straight_down, 1, bounds)
    found = profile.law(along(1)).interval(0.95)
    np.testing.assert_allclose(found, exact, atol=0.03 * np.ptp(exact))


def straight_down(u):
    """At its least the first unknown would be below 0."""
    return (u[0] + u[1] + 0.5) / 0.3


def test_a_limit_of_the_quantity_itself_ends_its_law():
    """Of a normal law cut off above its middle the likeliest begin at the limit."""
    bounds = (np.array([0.0, -np.inf]), np.full(2, np.inf))
    best = least_of(straight_down, bounds)
    fit = fit_of(straight_down, lambda u: np.array([1.0, 1.0]) / 0.3, best, bounds)
    low, high = Profile(fit, 1.0, NORMAL).law(along(0, (0.0, np.inf))).interval(0.95)
    u = np.stack(np.meshgrid(GRID, GRID, indexing="ij"))
    chance = np.exp(-(straight_down(u) ** 2 + (u**2).sum(axis=0)) / 2).sum(axis=1)
    chance[GRID < 0] = 0
    exact = np.interp(0.95, np.cumsum(chance) / chance.sum(), GRID)
    assert low == 0
    assert high == pytest.approx(exact, rel=0.03)


def test_far_above_the_cut_off_the_sheets_are_told_from_below_alone(line, read):
    """Only R/C is seen there: both may be far larger at once, but not far smaller."""
    truth = {"sheet_resistance": 3.5, "capacitance": 3.5}
    found = calibrate(
        line,
        read(line, truth, ("none",) * 4, seed=1),
        Options(fit=("sheet_resistance", "capacitance"), fix=("others",)),
    )
    for name, value in found.values.items():
        if name in truth:
            low, high = found.intervals[name]
            assert low < truth[name] < high
            assert high - value > 1.3 * (value - low)
    sum_of = {each.name: each for each in found.quantities}["foam capacitance"]
    assert np.log([sum_of.low, sum_of.high]) - np.log(sum_of.start) == pytest.approx(
        found.intervals["capacitance"]
    )
