"""Answers of a localizer, and the rule for "cannot tell"."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.report.findings import DataTable, Findings, Head, Rate, Result
from ...simulator.sweeps import InputError
from ...simulator.sweeps.errors import named

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...simulator.arrays import Integer, Mask, Real

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


CANNOT_TELL = "cannot tell"
"""The answer if no class is probable enough, or the sweep is unlike the training."""
ONE_TOUCH = "1"
"""Answer of a model of positions to a sweep that has a position."""
SHARES = (1.0, 0.85, 0.7, 0.5, 0.3, 0.15)
"""Candidate shares of sweeps to answer; the most probable sweeps are answered."""
NOTHING_PRESSED = ("0", "0,0")
"""Labels of the unpressed skin, as text."""


@dataclass(frozen=True, eq=False, repr=False)
class Answers(Result):
    """An answer to each sweep.

    labels: text of the class or CANNOT_TELL, shape (sweep,). probability: probability of the most
    probable class, also where the answer is CANNOT_TELL, shape (sweep,). novel: True if the sweep
    is unlike all of the training, shape (sweep,). chances: probability of each class, shape
    (sweep, K); K is 0 for a localizer of places.
    """

    labels: NDArray[np.str_]
    probability: Real
    novel: Mask
    chances: Real

    @property
    def answered(self) -> Mask:
        """True for sweeps with an answer, shape (sweep,)."""
        return self.labels != CANNOT_TELL

    @property
    def report(self) -> Findings:
        """The answer to each sweep."""
        rows = list(zip(self.labels.tolist(), self.probability, self.novel, strict=True))
        heads = [
            Head("sweep", form="d"),
            "answer",
            Head("probability", form=".4f"),
            "novel",
        ]
        table = DataTable("answers", heads, [(k, *row) for k, row in enumerate(rows)])
        return Findings(f"Answers to {len(rows)} sweeps", [table])

    def part(self, rows: NDArray[np.intp]) -> Answers:
        """Answers to these sweeps."""
        return Answers(*(getattr(self, each.name)[rows] for each in fields(self)))

    def among(self, rows: NDArray[np.intp], count: int, guess: float) -> Answers:
        """Answers to `count` sweeps: these at `rows`, CANNOT_TELL at all others.

        guess: probability of the others, and of each class for them.
        """
        chances = np.full((count, self.chances.shape[1]), guess)
        labels = np.full(count, CANNOT_TELL, dtype=object)
        probability, novel = np.full(count, guess), np.zeros(count, dtype=bool)
        labels[rows], probability[rows], novel[rows] = self.labels, self.probability, self.novel
        chances[rows] = self.chances
        return Answers(labels.astype(str), probability, novel, chances)


def decide(classes: NDArray, probabilities: Real, novel: Mask, threshold: float) -> Answers:
    """The most probable class of each sweep, or CANNOT_TELL.

    CANNOT_TELL is the answer if the sweep is novel or the probability is below the threshold.

    classes: shape (K,). probabilities: shape (sweep, K). novel: shape (sweep,).
    """
    best = probabilities.argmax(axis=1)
    probability = probabilities.max(axis=1)
    silent = novel | (probability < threshold)
    text = classes[best].astype(str).astype(object)
    labels = np.where(silent, CANNOT_TELL, text).astype(str)
    return Answers(labels, probability, novel, probabilities)


def threshold_of(probability: Real, right: Mask, certain: float) -> float:
    """Probability threshold above which answers are right at the rate `certain`.

    It is the threshold of the largest of SHARES that reaches the rate. The rate holds with
    CONFIDENCE for sweeps of the same sessions, which count as independent: each share takes its
    exact bound at an equal part of the significance level (Bonferroni), which accounts for the
    choice among SHARES. The candidate thresholds do not depend on which answers are right. Source:
    A. N. Angelopoulos, S. Bates, E. J. Candes, M. I. Jordan, L. Lei, "Learn then test",
    arXiv:2110.01052 (2021).

    probability: probability of the best class of sweeps that were not trained on. right: True where
    that class is the true one. Raises InputError if `certain` is not within (0, 1), or if no share
    reaches it.
    """
    if not 0 < certain < 1:
        raise InputError(f"{named('certain')} must be between 0 and 1, got {certain:g}")
    confidence = 1 - (1 - CONFIDENCE) / len(SHARES)
    best = 0.0
    for threshold in np.quantile(probability, 1 - np.array(SHARES), method="higher"):
        answered = right[probability >= threshold]
        least = lower_bound(int(answered.sum()), answered.size, confidence)
        if least >= certain:
            return float(threshold)
        best = max(best, least)
    raise InputError(
        f"{named('certain')} {certain:g} cannot be reached: of {right.size} held-out sweeps, the "
        f"most probable answers are right at a rate of {100 * best:.1f} % or more with "
        f"{100 * CONFIDENCE:g} % confidence"
    )
