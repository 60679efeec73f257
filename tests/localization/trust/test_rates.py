"""Rates are told with what they are of, and with what they say at least."""

import numpy as np
import pytest
from rcskin.localization.trust.rates import CONFIDENCE, lower_bound, rate_text


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
    assert rate_text(right, total) == told


@pytest.mark.parametrize("rate", [0.5, 0.9, 0.99])
def test_the_bound_holds_as_often_as_it_says(rate):
    found = np.random.default_rng(0).binomial(60, rate, 1500)
    counts, times = np.unique(found, return_counts=True)
    kept = sum(n for k, n in zip(counts, times, strict=True) if lower_bound(int(k), 60) <= rate)
    assert kept / found.size > CONFIDENCE - 0.015
