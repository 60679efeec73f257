"""Rates are told with what they are of, and with what they say at least."""

import numpy as np
import pytest
from rcskin.localization.trust.answers import (
    BOUNDING_SESSIONS,
    CONFIDENCE,
    CountedRate,
    independent_sweeps,
    lower_bound,
)
from scipy.stats import binomtest


@pytest.mark.parametrize(
    ("right", "total", "told"),
    [
        (53, 53, "100 % (53 of 53, at least 94 % with 95 % confidence)"),
        (0, 10, "0 % (0 of 10, at least 0 % with 95 % confidence)"),
        (9999, 10000, "99.9 % (9999 of 10000, at least 99.9 % with 95 % confidence)"),
        (0, 0, "none of 0"),
    ],
)
def test_it_is_said_of_how_many(right, total, told):
    assert CountedRate.of(np.arange(total) < right, np.arange(total)).text == told


@pytest.mark.parametrize("sessions", range(1, BOUNDING_SESSIONS))
def test_few_sessions_bound_nothing(sessions):
    rate = CountedRate.of(np.ones(50, dtype=bool), np.arange(50) % sessions)
    assert (rate.text, rate.interval) == ("100 % (50 of 50)", (1.0, 1.0))


@pytest.mark.parametrize("rate", [0.5, 0.9, 0.99])
def test_the_bound_of_independent_sweeps_is_the_exact_one(rate):
    found = np.random.default_rng(0).binomial(60, rate, 1500)
    counts, times = np.unique(found, return_counts=True)
    kept = sum(n for k, n in zip(counts, times, strict=True) if lower_bound(int(k), 60) <= rate)
    assert kept / found.size > CONFIDENCE - 0.015
    exact = binomtest(int(counts[0]), 60, alternative="greater").proportion_ci(0.95, "exact").low
    assert lower_bound(int(counts[0]), 60) == pytest.approx(exact)


@pytest.mark.parametrize("count", [BOUNDING_SESSIONS, 10, 40])
@pytest.mark.parametrize("correlation", [0.0, 0.05, 0.1])
def test_the_bound_holds_in_other_sessions(count, correlation):
    """Rates of sessions are distributed as beta about 95 %; a session has 25 sweeps."""
    rate, each, random = 0.95, 25, np.random.default_rng(count)
    spread = 1 / correlation - 1 if correlation else np.inf
    sessions, kept, trials = np.repeat(np.arange(count), each), 0, 400
    for _ in range(trials):
        own = random.beta(rate * spread, (1 - rate) * spread, count) if correlation else rate
        true = random.random((each, count)) < own
        kept += CountedRate.of(true.T.ravel(), sessions).at_least() <= rate
    assert kept / trials > CONFIDENCE - 0.02


def test_sweeps_that_are_sessions_of_their_own_are_independent():
    true = np.random.default_rng(1).random(300) < 0.9
    assert independent_sweeps(true, np.arange(300)) == pytest.approx(300, rel=0.01)
