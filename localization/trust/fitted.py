"""A trained predictor with calibrated probabilities, a threshold, and guards."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Mask, Real
from ..parts.parts import NearestErrors
from ..parts.plain import Plain, Sizes, require
from ..parts.predictor import Predictor
from .answers import Answers, CountedRate, decide
from .kinds import KindGuard
from .several import SeveralGuard
from .temperature import probabilities


@dataclass(frozen=True, eq=False)
class Guards(Plain):
    """Guards fitted to the training sweeps.

    kinds: guard by kind of press. several: guard against several touches; None if `several_guard`
    does not apply. changes: guards of the changes from the baseline of the same sweeps, where the
    localizer itself does not use these.
    """

    kinds: KindGuard
    several: SeveralGuard | None = None
    changes: Guards | None = None

    def _check(self, sizes: Sizes) -> None:
        several, changes = self.several, self.changes
        fits = several is None or several.features == self.features
        require(fits, "several.features", f"must be {self.features}")
        require(changes is None or changes.changes is None, "changes", "must have no changes")

    @property
    def features(self) -> int:
        """Number of features of a sweep."""
        return self.kinds.features

    def novel(self, X: Real, changes: Real | None = None) -> Mask:
        """True for sweeps unlike those of the training, shape (n,).

        X: shape (n, feature). changes: as in `baseline_changes`, shape (n, feature).
        """
        novel = self.kinds.novel(X)
        if self.several is not None:
            novel |= self.several.novel(X)
        if self.changes is not None and changes is not None:
            known = with_known_baseline(changes)
            if known.size:
                novel[known] |= self.changes.novel(changes[known])
        return novel


def with_known_baseline(changes: Real) -> NDArray[np.intp]:
    """Indices of the sweeps whose changes are known. changes: shape (n, feature)."""
    return np.flatnonzero(np.isfinite(changes).all(axis=1))


@dataclass(frozen=True, eq=False)
class Learned(Plain):
    """Trained predictor with its guards.

    guards: None if the predictor itself detects novel sweeps.
    """

    predictor: Predictor
    guards: Guards | None

    def _check(self, sizes: Sizes) -> None:
        of_classes = isinstance(self, Classifier) == (self.predictor.classes is not None)
        require(of_classes, "predictor", "must predict classes or positions, as its localizer")
        guards, features = self.guards, self.predictor.features
        require(guards is not None or self.predictor.detects_novelty, "guards", "are missing")
        fits = guards is None or guards.features == features
        require(fits, "guards.kinds.features", f"must be {features}")

    def novel(self, X: Real, changes: Real | None = None) -> Mask:
        """True for sweeps unlike those of the training, shape (n,).

        X: shape (n, feature). changes: from the baseline, for guards that use them.
        """
        if self.guards is not None:
            return self.guards.novel(X, changes)
        return self.predictor.novel(X)

    def predict(self, X: Real) -> NDArray:
        """The most probable class of each row, shape (n,), or its position, shape (n, 3)."""
        return self.predictor.predict(X)


@dataclass(frozen=True, eq=False)
class Classifier(Learned):
    """Localizer of classes.

    sharpness: factor of decisions before the softmax that gives probabilities. threshold: the
    minimum probability of an answer. right, answered: number of held-out sweeps whose most probable
    class is right, and that reach the threshold. held_out: number of held-out sweeps. independent:
    see `CountedRate`, of the right ones.
    """

    sharpness: Annotated[float, ">0"]
    threshold: Annotated[float, ">=0"]
    right: Annotated[int, ">=0"]
    answered: Annotated[int, ">=0"]
    held_out: Annotated[int, ">=0"]
    independent: Annotated[float, ">0"] | None

    def _check(self, sizes: Sizes) -> None:
        super()._check(sizes)
        require(self.right <= self.held_out, "right", f"must be at most {self.held_out}")
        require(self.answered <= self.held_out, "answered", f"must be at most {self.held_out}")

    @property
    def outcome(self) -> str:
        """Share of held-out sweeps whose most probable class is right, as text."""
        rate = CountedRate(self.right, self.held_out, self.independent)
        return f"most probable class right: {rate.text}"

    @property
    def classes(self) -> NDArray:
        """Classes in ascending order, shape (K,)."""
        classes = self.predictor.classes
        assert classes is not None
        return classes

    def probabilities(self, X: Real) -> Real:
        """Probability of each class, shape (n, K)."""
        return probabilities(self.predictor.decisions(X), self.sharpness)

    def answers(self, X: Real, changes: Real | None = None) -> Answers:
        """A class or CANNOT_TELL for each row. changes: as in `novel`."""
        novel = self.novel(X, changes)
        return decide(self.classes, self.probabilities(X), novel, self.threshold)


@dataclass(frozen=True, eq=False)
class Regressor(Learned):
    """Localizer of positions.

    factor: correction of the standard deviations, from held-out sweeps, shape (3,). spread: the
    variances, where the predictor knows no deviations. median_error: median error of the held-out
    sweeps, mm.
    """

    factor: Annotated[Real, "3 >=0"]
    spread: NearestErrors | None
    median_error: Annotated[float, ">=0"]

    def _check(self, sizes: Sizes) -> None:
        super()._check(sizes)
        known = self.spread is not None or self.predictor.detects_novelty
        require(known, "spread", "is missing")

    @property
    def outcome(self) -> str:
        """Median error on the held-out sweeps, as text."""
        return f"median error {self.median_error:.1f} mm"

    def positions(self, X: Real) -> tuple[Real, Real]:
        """Positions (x, y in mm, strength) and standard deviations, each of shape (n, 3)."""
        places, deviation = self.predictor.positions(X)
        if self.spread is not None:
            deviation = np.sqrt(self.spread(places))
        assert deviation is not None
        return places, self.factor * deviation
