"""Rates as text, with counts and a lower confidence bound."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.report.page import Rate

if TYPE_CHECKING:
    from ...simulator.arrays import Integer, Mask

CONFIDENCE = 0.95
BOUNDING_SESSIONS = 5
"""Fewest sessions that bound a rate: by fewer, Student's t leaves next to nothing of it."""
MANY = 500
"""Number of cases from which on a bound is shown to a tenth of a per cent."""
CORRELATION = 0.1
"""Least correlation within a session of whether sweeps are right.

A few sessions cannot show it, least of all where all sweeps are right. On skins of a
three-dimensional solve it was 0 to 0.08 (`results/foreign_twin.csv`).
"""


@dataclass(frozen=True)
class CountedRate:
    """How many of some sweeps are right, answered or the like.

    independent: number of independent sweeps that bear as much on other sessions; None if these
    are of fewer than BOUNDING_SESSIONS.
    """

    count: int
    total: int
    independent: float | None = None

    @classmethod
    def of(cls, true: Mask, sessions: Integer, further: int = 0) -> CountedRate:
        """The rate of a mask, shape (sweep,), in sessions. further: sweeps where it is not so."""
        count, total = int(true.sum()), true.size + further
        effective = independent_sweeps(true, sessions)
        if effective is not None:
            effective *= total / true.size
        return cls(count, total, effective)

    @property
    def share(self) -> float:
        """Count over total."""
        return self.count / self.total

    def at_least(self, confidence: float = CONFIDENCE) -> float:
        """Lower confidence bound; needs BOUNDING_SESSIONS."""
        assert self.independent is not None
        return lower_bound(self.share * self.independent, self.independent, confidence)

    @property
    def interval(self) -> tuple[float, float]:
        """Two-sided interval at CONFIDENCE; the rate itself where nothing bounds it."""
        if self.independent is None:
            return self.share, self.share
        return interval(self.share * self.independent, self.independent)

    @property
    def text(self) -> str:
        """Text such as `98 % (52 of 53, at least 91 % with 95 % confidence)`.

        It is `none of 0` for none. The bound is left out for few sessions, and never rounded up.
        """
        if not self.total:
            return "none of 0"
        percent = "100" if self.count == self.total else f"{min(100 * self.share, 99.9):.3g}"
        bound = ""
        if self.independent is not None:
            tenths = 10 if self.independent >= MANY else 1
            least = math.floor(100 * tenths * self.at_least()) / tenths
            bound = f", at least {least:g} % with {100 * CONFIDENCE:g} % confidence"
        return f"{percent} % ({self.count} of {self.total}{bound})"


def independent_sweeps(true: Mask, sessions: Integer) -> float | None:
    """Number of independent sweeps whose rate is known as well; None below BOUNDING_SESSIONS.

    Sweeps of one session are right or wrong together. The variance of the rate is that between
    sessions, but not less than that of a CORRELATION within them; few sessions count less by the
    quantiles of Student's t: E. L. Korn, B. I. Graubard, Survey Methodology 24 (1998) 193-201.
    true, sessions: shape (sweep,).
    """
    from scipy.special import stdtrit

    _, index, sizes = np.unique(sessions, return_inverse=True, return_counts=True)
    count, total = sizes.size, true.size
    if count < BOUNDING_SESSIONS:
        return None
    rate = true.mean()
    excess = np.bincount(index, true) - rate * sizes
    variance = count / (count - 1) * float(np.square(excess).sum()) / total**2
    within = 1 + CORRELATION * (float(np.square(sizes).sum()) / total - 1)
    found = total / within
    if variance > 0:
        found = min(found, float(rate * (1 - rate)) / variance)
    few = stdtrit(total - 1, CONFIDENCE) / stdtrit(count - 1, CONFIDENCE)
    return float(found * few**2)


def lower_bound(count: float, total: float, confidence: float = CONFIDENCE) -> float:
    """Lower confidence bound of a rate, for independent cases; these need not be whole numbers.

    The bound is exact and one-sided: C. J. Clopper, E. S. Pearson, Biometrika 26 (1934) 404-413.
    """
    from scipy.special import betaincinv

    return float(betaincinv(count, total - count + 1, 1 - confidence)) if count else 0.0


def interval(count: float, total: float) -> tuple[float, float]:
    """Exact two-sided confidence interval of a rate of independent cases, at CONFIDENCE."""
    one_sided = (1 + CONFIDENCE) / 2
    above = lower_bound(total - count, total, one_sided)
    return lower_bound(count, total, one_sided), 1 - above


def with_intervals(rates: Mapping[str, CountedRate]) -> list[Rate]:
    """Rates for a chart by name; those of none are left out."""
    return [Rate(name, each.share, *each.interval) for name, each in rates.items() if each.total]
