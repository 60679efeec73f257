"""A trained pipeline with what makes its answers honest: probabilities, a threshold, a guard."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sklearn.pipeline import Pipeline

from ..learners.decisions import decisions
from .answers import Answers, decide
from .kinds import KindGuard
from .novelty import NoveltyGuard
from .spread import Spread
from .temperature import probabilities


@dataclass(frozen=True, eq=False)
class Guards:
    """What sweeps of the training looked like: all of them, and of presses by one touch each kind.

    kinds: None where the localizer knows more touches than one.
    """

    sweeps: NoveltyGuard
    kinds: KindGuard | None = None

    def novel(self, X: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Which sweeps are unlike those of the training, shape (n,). X: shape (n, feature)."""
        unlike = self.sweeps.predict(X) < 0
        return unlike if self.kinds is None else unlike | (self.kinds.predict(X) < 0)


@dataclass(frozen=True, eq=False)
class Classifier:
    """Tells classes.

    sharpness: factor of decisions of which the softmax tells probabilities. threshold: the least
    probability that is answered. guards: know what sweeps of the training looked like. right,
    held_out: how many of the sweeps held out were told right, and of how many.
    """

    pipeline: Pipeline
    sharpness: float
    threshold: float
    guards: Guards
    right: int
    held_out: int

    @property
    def classes(self) -> NDArray:
        """In ascending order, shape (K,)."""
        return self.pipeline.classes_

    def probabilities(self, X: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of each class, shape (n, K)."""
        return probabilities(decisions(self.pipeline, X), self.sharpness)

    def answers(self, X: NDArray[np.float64]) -> Answers:
        """A class or CANNOT_TELL for each row."""
        return decide(self.classes, self.probabilities(X), self.guards.novel(X), self.threshold)


@dataclass(frozen=True, eq=False)
class Regressor:
    """Tells positions.

    factor: of the pipeline's own standard deviations, by which they were too small on held-out
    sweeps, shape (3,). spread: tells deviations where the pipeline has none of its own.
    median_error: mm, of the sweeps held out.
    """

    pipeline: Pipeline
    factor: NDArray[np.float64]
    spread: Spread | None
    guards: Guards
    median_error: float

    def positions(self, X: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Positions and standard deviations, in mm and of the strength, each of shape (n, 3)."""
        if self.spread is None:
            told, deviation = self.pipeline.predict(X, return_std=True)
            return told, self.factor * deviation
        told = self.pipeline.predict(X)
        return told, self.spread.predict(told)
