"""Intervals by the profile of the likelihood: of straight problems, curved ridges and limits."""

from types import SimpleNamespace

import numpy as np
import pytest
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.calibration.distributions import Profile, ProfiledQuantity
from rcskin.simulator.calibration.prior import Prior
from rcskin.simulator.calibration.profile_distribution import (
    NORMAL,
    ProfileDistribution,
    cut_normal,
)
from rcskin.simulator.calibration.run import calibrate
from rcskin.simulator.calibration.sheet_intervals import COMMON, MISMATCH, series_intervals
from rcskin.simulator.models.parameters import own_values
from scipy.optimize import least_squares
from scipy.special import ndtr

FREE = (np.full(2, -np.inf), np.full(2, np.inf))
GRID = np.linspace(-6, 6, 2401)


def fit_of(reading, slopes, u, bounds=FREE):
    """Two unknowns with priors of 1, and readings with their slopes to them."""

    def condensed(u, scale):
        share = scale**-0.5
        residuals = np.append(share * reading(u), u)
        return residuals, np.vstack([share * slopes(u), np.eye(2)])

    problem = SimpleNamespace(reduced_system=condensed, bounds=lambda: bounds)
    spec = SimpleNamespace(fitted={"first": None, "second": None})
    return SimpleNamespace(problem=problem, spec=spec, u=np.array(u, dtype=float))


def along(k, limits=(-np.inf, np.inf)):
    return ProfiledQuantity(lambda u: (float(u[k]), np.eye(2)[k]), k, limits)


def rises(reading, k, bounds=FREE):
    """Of the misfit above its least, the other unknown at its best, by trying all of its values."""
    u = np.stack(np.meshgrid(GRID, GRID, indexing="ij"))
    readings = np.reshape(reading(u), (-1, *u.shape[1:]))
    misfit = (readings**2).sum(axis=0) + (u**2).sum(axis=0)
    for each, low, high in zip(u, *bounds, strict=True):
        misfit[(each < low) | (each > high)] = np.inf
    profile = misfit.min(axis=1 - k)
    return profile - profile.min()


def ends(reading, k, bounds=FREE):
    """Of all values where the misfit has risen by no more than it does along an interval."""
    within = GRID[rises(reading, k, bounds) <= NORMAL**2]
    return np.array([within.min(), within.max()])


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
            found = profile.distribution(along(k)).interval(NORMAL)
            np.testing.assert_allclose(found, (middle - reach, middle + reach), atol=5e-3 * reach)


def test_a_wider_interval_is_wider_by_as_much():
    fit = fit_of(straight, slopes_of_straight, least_of(straight))
    own, wide = (
        np.ptp(Profile(fit, 1.0, width).distribution(along(0)).interval(width))
        for width in (NORMAL, 1.5 * NORMAL)
    )
    assert wide == pytest.approx(1.5 * own, rel=5e-3)


@pytest.mark.parametrize("loose", [0.1, 0.5, 2.0])
@pytest.mark.parametrize("k", [0, 1])
def test_an_interval_on_a_curved_ridge_ends_where_the_misfit_has_risen(k, loose):
    """Far above a cut-off the ratio is told, and of the product that it is large, not how large."""

    def reading(u):
        wall = (np.exp(-1.5 * (u[0] + u[1])) - 0.05) / 0.1
        return np.array([wall, (u[0] - u[1] - 0.1 * u[0] ** 2) / loose])

    def slopes(u):
        fall = -15 * np.exp(-1.5 * (u[0] + u[1]))
        return np.array([[fall, fall], [(1 - 0.2 * u[0]) / loose, -1 / loose]])

    fit = fit_of(reading, slopes, least_of(reading))
    profile = Profile(fit, 1.0, NORMAL)
    assert not profile.linear(along(k))
    exact = ends(reading, k)
    found = np.array(profile.distribution(along(k)).interval(NORMAL))
    reach = NORMAL * profile.deviation(along(k))
    linear = profile.best[k] + np.array([-reach, reach])
    np.testing.assert_allclose(found, exact, atol=0.03 * np.ptp(exact))
    assert np.abs(found - exact).max() < 0.5 * np.abs(linear - exact).max()


def test_a_bound_of_another_unknown_moves_the_ends():
    bounds = (np.array([0.0, -np.inf]), np.full(2, np.inf))
    best = least_of(straight_down, bounds)
    profile = Profile(
        fit_of(straight_down, lambda u: np.array([1.0, 1.0]) / 0.3, best, bounds), 1.0, NORMAL
    )
    assert not profile.linear(along(1))
    found = profile.distribution(along(1)).interval(NORMAL)
    exact = ends(straight_down, 1, bounds)
    np.testing.assert_allclose(found, exact, atol=0.03 * np.ptp(exact))


def straight_down(u):
    """At its least the first unknown would be below 0."""
    return (u[0] + u[1] + 0.5) / 0.3


def test_no_point_lies_beyond_the_reach_of_the_model():
    reach = 1.2
    bounds = (np.array([-reach, -np.inf]), np.array([reach, np.inf]))

    def within_reach(u):
        assert abs(u[0]) < reach + 0.2
        return straight(u)

    best = least_of(straight)
    free, bounded = (
        Profile(fit_of(reading, slopes_of_straight, best, limits), 1.0, NORMAL)
        for reading, limits in ((straight, FREE), (within_reach, bounds))
    )
    exact = free.distribution(along(0)).interval(NORMAL)
    assert exact[1] > reach + 0.2
    np.testing.assert_allclose(bounded.distribution(along(0)).interval(NORMAL), exact, rtol=0.02)


def test_an_interval_ends_at_a_limit_of_the_quantity_and_is_shorter_beyond_it():
    bounds = (np.array([0.0, -np.inf]), np.full(2, np.inf))

    def above(u):
        return (u[0] + u[1] - 0.3) / 0.3

    fit = fit_of(above, lambda u: np.array([1.0, 1.0]) / 0.3, least_of(above, bounds), bounds)
    low, high = Profile(fit, 1.0, NORMAL).distribution(along(0, (0.0, np.inf))).interval(NORMAL)
    rise = rises(above, 0, bounds)
    at_limit = -np.sqrt(rise[np.searchsorted(GRID, 0.0)])
    _, share = cut_normal(0.0, 1.0, NORMAL, (at_limit, np.inf))
    assert low == 0
    assert share < NORMAL
    assert high == pytest.approx(GRID[rise <= share**2].max(), rel=0.03)


@pytest.mark.parametrize(("at_limit", "reached"), [(0.5, True), (1.9, True), (2.0, False)])
def test_an_interval_contains_a_limit_that_a_two_sided_test_does_not_reject(at_limit, reached):
    """The limit is exactly an end then, on both sides of a law, and 95 % of what is left within."""
    deviations = np.linspace(-at_limit, 3.0, 9)
    places = (deviations + at_limit) / 7.0
    law = ProfileDistribution(places, deviations, (0.0, np.inf))
    low, high = law.interval(NORMAL)
    assert (low == 0.0) == reached
    inside = ndtr(7.0 * high - at_limit) - ndtr(7.0 * low - at_limit)
    assert inside == pytest.approx(0.95 * ndtr(at_limit), abs=1e-6)
    mirrored = ProfileDistribution(1.0 - places[::-1], -deviations[::-1], (0.0, 1.0)).interval(
        NORMAL
    )
    assert mirrored == pytest.approx((1 - high, 1 - low))
    assert (mirrored[1] == 1.0) == reached


@pytest.mark.parametrize("off", [-1.5, 0.0, 1.5])
def test_equal_sheets_lie_within_the_interval_of_their_mean(line, off):
    """What is known of the sum alone leaves the mean largest where both are equal."""
    spread, names = 5e-3, (COMMON, MISMATCH)
    fit = SimpleNamespace(
        values=own_values(line.parts.skin, line.parts.setup) | {COMMON: off * spread},
        spec=SimpleNamespace(fitted=dict.fromkeys(names, Prior(0.0, 1.0))),
    )
    known = SimpleNamespace(names=names, covariance=np.diag([spread**2, 1.0]))
    low, high = series_intervals(line.parts.skin, line.parts.setup, fit, known, NORMAL)[COMMON]
    assert low < -0.3 and 0 <= high < 5 * spread
    assert low < np.log(1 / np.cosh(0.8)) < high


def test_far_above_the_cut_off_the_sheets_are_determined_from_below_alone(line, read):
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


def test_an_inductance_is_none_that_a_scene_may_not_have(line, read):
    """At low frequencies 50 H would have been within the prior."""
    low = line.with_({"sweep.frequencies": [1.0, 3.0, 10.0, 30.0]})
    found = calibrate(low, read(low, None, ("none",) * 4))
    assert 0 <= found.intervals["lead_inductance"][0] <= found.intervals["lead_inductance"][1] <= 10
