"""Answers of a localizer, and the rule for "cannot tell"."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.notebook_display import Tabular
from ...simulator.sweeps import InputError
from .rates import CONFIDENCE, lower_bound

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...simulator.arrays import Mask, Real

CANNOT_TELL = "cannot tell"
"""The answer if no class is probable enough, or the sweep is unlike the training."""
ONE_TOUCH = "1"
"""Answer of a model of positions to a sweep that has a position."""
SHARES = (1.0, 0.85, 0.7, 0.5, 0.3, 0.15)
"""Candidate shares of sweeps to answer; the most probable sweeps are answered."""
NOTHING_PRESSED = ("0", "0,0")
"""Labels of the unpressed skin, as text."""


@dataclass(frozen=True, eq=False, repr=False)
class Answers(Tabular):
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

    def _table(self) -> tuple[str, list[tuple[object, ...]]]:
        each = zip(self.labels, self.probability, self.novel, strict=True)
        rows = [(k, label, f"{p:.4f}", novel) for k, (label, p, novel) in enumerate(each)]
        return f"Answers to {len(rows)} sweeps", [
            ("sweep", "answer", "probability", "novel"),
            *rows,
        ]

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
        raise InputError(f"`certain` must be between 0 and 1, got {certain:g}")
    confidence = 1 - (1 - CONFIDENCE) / len(SHARES)
    best = 0.0
    for threshold in np.quantile(probability, 1 - np.array(SHARES), method="higher"):
        answered = right[probability >= threshold]
        least = lower_bound(int(answered.sum()), answered.size, confidence)
        if least >= certain:
            return float(threshold)
        best = max(best, least)
    raise InputError(
        f"`certain` {certain:g} cannot be reached: of {right.size} held-out sweeps, the most "
        f"probable answers are right at a rate of {100 * best:.1f} % or more with "
        f"{100 * CONFIDENCE:g} % confidence"
    )
