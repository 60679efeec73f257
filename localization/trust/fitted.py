"""A trained pipeline with calibrated probabilities, a threshold, and guards."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.pipeline import Pipeline

from ...simulator.arrays import Mask, Real
from ..learners.decisions import decisions
from .answers import Answers, decide
from .kinds import KindGuard
from .rates import CountedRate
from .several import SeveralGuard
from .temperature import probabilities


@dataclass(frozen=True, eq=False)
class Guards:
    """Guards fitted to the training sweeps.

    kinds: guard by kind of press. several: guard against several touches; None if `several_guard`
    does not apply. changes: guards of the changes from the baseline of the same sweeps, where the
    localizer itself does not use these.
    """

    kinds: KindGuard
    several: SeveralGuard | None = None
    changes: Guards | None = None

    def novel(self, X: Real, changes: Real | None = None) -> Mask:
        """True for sweeps unlike those of the training, shape (n,).

        X: shape (n, feature). changes: as in `baseline_changes`, shape (n, feature).
        """
        novel = self.kinds.predict(X) < 0
        if self.several is not None:
            novel |= self.several.predict(X) < 0
        if self.changes is not None and changes is not None:
            known = with_known_baseline(changes)
            if known.size:
                novel[known] |= self.changes.novel(changes[known])
        return novel


def with_known_baseline(changes: Real) -> NDArray[np.intp]:
    """Indices of the sweeps whose changes are known. changes: shape (n, feature)."""
    return np.flatnonzero(np.isfinite(changes).all(axis=1))


def has_novelty_test(pipeline: Pipeline) -> bool:
    """True if the last step itself detects novel sweeps."""
    return hasattr(pipeline[-1], "novel")


@dataclass(frozen=True, eq=False)
class Learned:
    """Fitted pipeline with its guards.

    guards: None if the pipeline itself detects novel sweeps.
    """

    pipeline: Pipeline
    guards: Guards | None

    def novel(self, X: Real, changes: Real | None = None) -> Mask:
        """True for sweeps unlike those of the training, shape (n,).

        X: shape (n, feature). changes: from the baseline, for guards that use them.
        """
        if self.guards is not None:
            return self.guards.novel(X, changes)
        last: Any = self.pipeline[-1]
        return last.novel(X)


@dataclass(frozen=True, eq=False)
class Classifier(Learned):
    """Localizer of classes.

    sharpness: factor of decisions before the softmax that gives probabilities. threshold: the
    minimum probability of an answer. right, answered: number of held-out sweeps whose most probable
    class is right, and that reach the threshold. held_out: number of held-out sweeps. independent:
    see `CountedRate`, of the right ones.
    """

    sharpness: float
    threshold: float
    right: int
    answered: int
    held_out: int
    independent: float | None

    @property
    def outcome(self) -> str:
        """Share of held-out sweeps whose most probable class is right, as text."""
        rate = CountedRate(self.right, self.held_out, self.independent)
        return f"most probable class right: {rate.text}"

    @property
    def classes(self) -> NDArray:
        """Classes in ascending order, shape (K,)."""
        return self.pipeline.classes_

    def probabilities(self, X: Real) -> Real:
        """Probability of each class, shape (n, K)."""
        return probabilities(decisions(self.pipeline, X), self.sharpness)

    def answers(self, X: Real, changes: Real | None = None) -> Answers:
        """A class or CANNOT_TELL for each row. changes: as in `novel`."""
        novel = self.novel(X, changes)
        return decide(self.classes, self.probabilities(X), novel, self.threshold)


@dataclass(frozen=True, eq=False)
class Regressor(Learned):
    """Localizer of positions.

    factor: correction of the standard deviations, from held-out sweeps, shape (3,). spread:
    predicts variances from positions, where the pipeline has no deviations of its own.
    median_error: median error of the held-out sweeps, mm.
    """

    factor: Real
    spread: Pipeline | None
    median_error: float

    @property
    def outcome(self) -> str:
        """Median error on the held-out sweeps, as text."""
        return f"median error {self.median_error:.1f} mm"

    def positions(self, X: Real) -> tuple[Real, Real]:
        """Positions (x, y in mm, strength) and standard deviations, each of shape (n, 3)."""
        if self.spread is None:
            places, deviation = self.pipeline.predict(X, return_std=True)
            return places, self.factor * deviation
        places = self.pipeline.predict(X)
        return places, self.factor * np.sqrt(self.spread.predict(places))
