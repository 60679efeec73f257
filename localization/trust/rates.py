"""Rates as text, with counts and a lower confidence bound."""

from __future__ import annotations

import math
from collections.abc import Mapping

from ...simulator.report.rate_bars import Rate

CONFIDENCE = 0.95
MANY = 500
"""Number of cases from which on a bound is shown to a tenth of a per cent."""


def lower_bound(right: int, total: int, confidence: float = CONFIDENCE) -> float:
    """Lower confidence bound of a rate, for independent cases.

    The bound is exact and one-sided: C. J. Clopper, E. S. Pearson, Biometrika 26 (1934) 404-413.
    Sweeps of one session are not independent: they say less about other sessions.
    """
    from scipy.stats import binomtest

    found = binomtest(right, total, alternative="greater").proportion_ci(confidence, "exact")
    return float(found.low)


def rate_text(right: int, total: int, *, bounded: bool = True) -> str:
    """Text such as `98 % (52 of 53, at least 91 % with 95 % confidence)`; `none of 0` for none.

    The bound is never rounded up. bounded: False leaves it out.
    """
    if not total:
        return "none of 0"
    tenths = 10 if total >= MANY else 1
    least = math.floor(100 * tenths * lower_bound(right, total)) / tenths
    rate = 100 * right / total
    percent = "100" if right == total else f"{min(rate, 99.9):.3g}"
    bound = f", at least {least:g} % with {100 * CONFIDENCE:g} % confidence" if bounded else ""
    return f"{percent} % ({right} of {total}{bound})"


def interval(right: int, total: int) -> tuple[float, float]:
    """Exact two-sided confidence interval of a rate, at CONFIDENCE."""
    from scipy.stats import binomtest

    found = binomtest(right, total).proportion_ci(CONFIDENCE, "exact")
    return float(found.low), float(found.high)


def with_intervals(counts: Mapping[str, tuple[int, int]]) -> list[Rate]:
    """Rates for a chart from counts and totals by name; those of none are left out."""
    return [
        Rate(name, count / total, *interval(count, total))
        for name, (count, total) in counts.items()
        if total
    ]
