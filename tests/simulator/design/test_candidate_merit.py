"""Merits of candidates: slopes, concavity, and the bounds that follow from them."""

import itertools
import math

import numpy as np
import pytest
from rcskin.simulator.bounds.choice import best_selection, selection_bound
from rcskin.simulator.bounds.likelihood import LinearLikelihood, lower_triangle
from rcskin.simulator.bounds.merits import AccuracyMerit, Candidates, PositionMerit

ACCURACY = AccuracyMerit()
KNOWN, UNKNOWN = (0.0, 0.0), (2**0.5, 0.5**0.5)
"""Errors of the session over the noise, of ln |Z| and phase."""


def likelihood_of(by, session, prior):
    errors = np.broadcast_to(session, (1, *by.shape[1:4]))
    return LinearLikelihood(by, errors, prior, np.full(len(by), 1 / len(by)))


def some_pairs(session=KNOWN, seed=1, pairs=30, readings=7, frequencies=9, size=0.6):
    random = np.random.default_rng(seed)
    apart = size * random.standard_normal((pairs, readings, frequencies, 2, 3))
    return likelihood_of(apart, session, np.array([0.0, 1.0, 1.0]))


def by_reading(known, merit=ACCURACY):
    return Candidates(known.by_interface(), known.weight, merit)


def by_frequency(known, merit=ACCURACY):
    return Candidates(known.by_frequency(), known.weight, merit)


def by_both(known, merit=ACCURACY):
    return Candidates(known.by_reading(), known.weight, merit)


@pytest.mark.parametrize("told", [by_reading, by_frequency])
@pytest.mark.parametrize("session", [KNOWN, UNKNOWN])
def test_slopes_are_those_of_differences(told, session):
    share, random = told(some_pairs(session)), np.random.default_rng(2)
    weights = random.random(share.count)
    _, slope = share.slope(weights)
    h = 1e-5
    for k, step in enumerate(h * np.eye(share.count)):
        difference = (share.slope(weights + step)[0] - share.slope(weights - step)[0]) / (2 * h)
        assert slope[k] == pytest.approx(difference, rel=1e-5)


@pytest.mark.parametrize("told", [by_reading, by_frequency])
@pytest.mark.parametrize("session", [KNOWN, UNKNOWN])
def test_the_share_lies_below_all_its_tangents(told, session):
    share, random = told(some_pairs(session)), np.random.default_rng(3)
    for _ in range(20):
        at, other = random.random((2, share.count))
        value, slope = share.slope(at)
        assert share.slope(other)[0] <= value + slope @ (other - at) + 1e-12


@pytest.mark.parametrize("session", [KNOWN, UNKNOWN])
def test_errors_of_a_session_hide_what_all_frequencies_share(session):
    common = np.repeat(some_pairs(frequencies=1).by, 5, axis=2)
    known, unknown = (likelihood_of(common, each, some_pairs().prior) for each in (KNOWN, session))
    told = by_frequency(unknown).slope(np.ones(5))[0]
    assert told <= by_frequency(known).slope(np.ones(5))[0]
    assert by_reading(unknown).slope(np.ones(7))[0] == pytest.approx(told, rel=1e-12)


@pytest.mark.parametrize("session", [KNOWN, UNKNOWN])
def test_a_score_is_1_minus_the_merit_of_a_choice(session):
    share = by_frequency(some_pairs(session))
    choices = np.array([[0, 3, 5], [1, 2, 8]])
    for choice, score in zip(choices, share.score(choices), strict=True):
        weights = np.zeros(share.count)
        weights[choice] = 1
        assert 1 - score == pytest.approx(share.slope(weights)[0], abs=3e-6)


def test_few_choices_are_all_evaluated_and_none_exceeds_the_bound():
    share = by_reading(some_pairs())
    best = max(
        share.slope(np.isin(range(7), choice).astype(float))[0]
        for choice in itertools.combinations(range(7), 3)
    )
    found = best_selection(share, 3)
    assert (
        found.exhaustive
        and found.share == pytest.approx(best, abs=2e-6)
        and found.upper_bound == found.share
    )
    told = selection_bound(share.slope, np.array(found.candidates), 7)
    assert best <= told < 1


def test_exchanges_come_close_to_a_bound_that_holds(monkeypatch):
    share = by_reading(some_pairs(size=0.3))
    exact = best_selection(share, 3)
    monkeypatch.setattr("rcskin.simulator.bounds.choice.MAX_EXHAUSTIVE", 0)
    found = best_selection(share, 3)
    assert not found.exhaustive
    assert exact.share - 1e-3 < found.share <= exact.share + 1e-6 <= found.upper_bound + 1e-5


def test_more_is_never_less():
    share = by_reading(some_pairs(UNKNOWN, size=0.3))
    shares = [best_selection(share, n).share for n in range(1, 8)]
    assert shares == sorted(shares) and not math.isclose(shares[0], shares[-1])


def some_places(session, merit, seed=1, places=12):
    random = np.random.default_rng(seed)
    scale = np.array([2e2, 1e2, 1.0])
    apart = scale * random.standard_normal((places, 7, 9, 2, 3))
    return likelihood_of(apart, session, merit.prior)


@pytest.mark.parametrize("told", [by_reading, by_frequency])
@pytest.mark.parametrize("session", [KNOWN, UNKNOWN])
def test_the_merit_of_positions_is_concave_with_exact_slopes(told, session):
    merit, random = PositionMerit((0.1, 0.05)), np.random.default_rng(2)
    share = told(some_places(session, merit), merit)
    h = 1e-5
    for _ in range(10):
        weights, other = 0.2 + random.random((2, share.count))
        value, slope = share.slope(weights)
        assert 0 < value < 1
        assert share.slope(other)[0] <= value + slope @ (other - weights) + 1e-12
        ahead, behind = (share.slope(weights + sign * h * other)[0] for sign in (1, -1))
        assert slope @ other == pytest.approx((ahead - behind) / (2 * h), rel=1e-5)


def test_without_readings_the_distance_is_that_of_a_guess():
    near = PositionMerit((0.1, 0.05))
    value, _ = near(np.diag(near.prior)[None], np.ones(1))
    assert float(value) == pytest.approx(0, abs=1e-12)
    assert near.guess == pytest.approx(np.hypot(0.1, 0.05) / np.sqrt(12))


def test_frequencies_of_each_reading_bound_those_of_all():
    pairs, every = some_pairs(size=0.3), np.arange(9)
    told = by_both(pairs)
    assert told.count == 7 * 9
    shared = by_frequency(pairs)
    found = best_selection(shared, 3)
    own = np.add.outer(9 * np.arange(7), np.array(found.candidates)).ravel()
    weights = np.isin(np.arange(told.count), own).astype(float)
    assert told.slope(weights)[0] == pytest.approx(found.share, rel=1e-12)
    assert (
        found.share
        < selection_bound(told.slope, own, told.count)
        < shared.slope(every * 0 + 1.0)[0]
    )


@pytest.mark.parametrize(
    "merit", [AccuracyMerit(), PositionMerit((0.12, 0.08))], ids=["right", "near"]
)
def test_a_merit_without_slopes_equals_that_with_slopes(merit):
    ways = 20 * np.random.default_rng(5).standard_normal((6, 11, 5, 3))
    found = np.einsum("...ka,...kb->...ab", ways, ways) + np.eye(3)
    weight = np.full(11, 1 / 11)
    whole = merit(found, weight)[0]
    assert merit.value(lower_triangle(found), weight) == pytest.approx(whole, rel=1e-12)
