"""Evidence of each sweep for the states of a chain, in parts where the state may change.

A model that inverts the simulator gives the likelihood of any part of a sweep. Any other model
predicts a spliced sweep: the early readings with the late ones of the previous sweep. If that
agrees with the previous state, and the whole sweep is novel, the state changed within the sweep.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Mask, Real
from ..inversion.adapted import AdaptedClassifier
from ..inversion.classifier import ModelBased
from ..model.localizer_model import Model
from ..trust.fitted import Classifier
from .cell_grid import CellGrid
from .chain import Cut, Evidence

ERROR_RATE = 0.02
"""Assumed error rate of any model: of its answers, and of calling a known touch novel."""
CUTS = (0.25, 0.5, 0.75)
"""Fractions of a sweep's readings at which the state may change."""


@dataclass
class Observer:
    """Evidence of sweeps in the order of measurement. grid: cells of a model of positions."""

    model: Model
    grid: CellGrid | None = None
    _before: Real | None = field(default=None, init=False)

    def forget(self) -> None:
        """Forget all sweeps so far: the next one has no predecessor."""
        self._before = None

    def observe(self, X: Real, changes: Real | None = None) -> list[Evidence]:
        """Evidence of rows of features; each follows the previous one, also across calls.

        changes: see `Model.guard_changes`.
        """
        if inverts(self.model):
            return self._by_likelihoods(X)
        first, before = self._before is None, X[:1] if self._before is None else self._before
        earlier = np.concatenate([before, X[:-1]])
        self._before = X[-1:].copy()
        whole, novel = self._likelihoods(X, changes)
        spliced, _ = self._likelihoods(np.where(self._early(0.5, X.shape[1]), X, earlier))
        late = np.log(np.where(novel, 1.0, self._known_likelihood))
        return [
            Evidence(
                likelihoods,
                () if first and not k else (Cut(early, np.full(likelihoods.size, after)),),
            )
            for k, (likelihoods, early, after) in enumerate(zip(whole, spliced, late, strict=True))
        ]

    def _by_likelihoods(self, X: Real) -> list[Evidence]:
        step, learned = self.model.predictor, self.model.learned
        assert isinstance(step, ModelBased | AdaptedClassifier)
        assert isinstance(learned, Classifier)

        def likely(numbers: Mask) -> Real:
            kept = tuple(np.flatnonzero(numbers).tolist())
            return learned.sharpness * step.log_densities(X, kept)

        early = [self._early(cut, 2 * self._readings) for cut in CUTS]
        cuts = [(likely(part), likely(~part)) for part in early]
        whole = learned.sharpness * step.log_densities(X)
        return [
            Evidence(whole[k], tuple(Cut(before[k], after[k]) for before, after in cuts))
            for k in range(len(X))
        ]

    def _likelihoods(self, X: Real, changes: Real | None = None) -> tuple[Real, Mask]:
        """ln likelihood of each state, (sweep, state), and True if the sweep is novel, (sweep,).

        The likelihood is up to a constant of the sweep.
        """
        learned = self.model.learned
        novel = learned.novel(X, changes)
        if isinstance(learned, Classifier):
            known, other = _with_error_rate(learned.probabilities(X)), np.full(len(X), ERROR_RATE)
        else:
            known, other, gated = self._places(X)
            novel = novel & gated
        known[novel] = ERROR_RATE
        return np.log(np.column_stack([known, np.where(novel, 1.0, other)])), novel

    def _places(self, X: NDArray) -> tuple[NDArray, NDArray, Mask]:
        """Likelihoods of known states and of more touches, and True if there is one, (sweep,)."""
        assert self.grid is not None
        shares = self.grid.cell_moments(X)[..., 0]
        cells = _with_error_rate(shares) * shares.shape[1]
        if self.model.gate is None:
            return cells, np.full(len(X), ERROR_RATE), np.ones(len(X), dtype=bool)
        gate = self.model.gate.learned
        assert isinstance(gate, Classifier)
        count = np.array([int(label) for label in gate.classes])
        chance = _with_error_rate(gate.probabilities(X))
        one, more = (chance[:, kind].sum(axis=1) for kind in (count == 1, count > 1))
        known = np.column_stack([chance[:, count == 0], cells * one[:, None]])
        return known, np.maximum(more, ERROR_RATE), count[chance.argmax(axis=1)] == 1

    @property
    def _known_likelihood(self) -> float:
        """Likelihood of any state by the late readings of a sweep that is not novel.

        It is one over the number of classes of the model or of its gate, 1 without classes. Sweeps
        with a change midway are mostly novel.
        """
        if isinstance(self.model.learned, Classifier):
            return 1 / len(self.model.classes)
        return 1.0 if self.model.gate is None else 1 / len(self.model.gate.classes)

    @property
    def _readings(self) -> int:
        return self.model.problem.features // len(self.model.quantities)

    def _early(self, cut: float, features: int) -> Mask:
        """Mask of the features read before a cut, in the order of measurement."""
        return np.arange(features) % self._readings < max(1, round(cut * self._readings))


def inverts(model: Model) -> bool:
    """True if the model is a classifier that has likelihoods of parts of a sweep."""
    return isinstance(model.predictor, ModelBased | AdaptedClassifier)


def _with_error_rate(probabilities: Real) -> Real:
    return (1 - ERROR_RATE) * probabilities + ERROR_RATE / probabilities.shape[1]
