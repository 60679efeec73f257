"""Inversion for the skin at hand: what it is like is told by its own curve at rest.

The simulator makes tables for each skin that is met, once; rows of which the skin at rest differs
by no more than drift are of one skin.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator, ClassifierMixin, RegressorMixin, clone
from sklearn.utils.validation import check_is_fitted, validate_data

from .classifier import QUANTITIES as CHANGE
from .classifier import Builder, ModelBased
from .position import ModelBasedPosition
from .skins import ALIKE, Skin, Skins, away

QUANTITIES = (*CHANGE, "lnZ0", "phase0")
"""Features that it takes, in this order."""


class _Adapted(BaseEstimator):
    """What both kinds share: one inner estimator for each skin.

    Parameters
    ----------
    inner: of the mean skin, unfitted; those of other skins are made like it. builder: makes the
    tables; not kept on disk: a model that is read back is given it anew.

    Attributes
    ----------
    mean_: the inner one, fitted to the skin of the sessions' mean.
    """

    kind: type
    beside = False
    """Whether new tables are made beside the work, which goes on with those of the nearest skin."""

    def __init__(self, inner=None, builder: Builder | None = None):
        self.inner = inner
        self.builder = builder

    def fit(self, X, y=None):
        """Take the tables of the mean skin; X, y are only checked. Raises ValueError without
        builder."""
        self._skins = Skins(self._fitted)
        self.mean_ = self._fitted(None)
        self.n_features_in_ = 2 * self.mean_.n_features_in_
        validate_data(self, X, reset=False)
        return self

    def novel(self, X):
        """Whether even the best fit is beyond what noise and skin allow, shape (sweep,)."""
        return self._told(X, lambda inner, change: inner.novel(change)).astype(bool)

    def at_hand(self, curve: NDArray[np.float64]):
        """The estimator of the skin with this curve at rest, of lnZ0 and phase0, (number,)."""
        check_is_fitted(self)
        return self._of_one_skin(curve[None], np.zeros(1, dtype=np.intp))[1].estimator

    def __getstate__(self):
        """Numbers and text only, once it is fitted."""
        state: Any = super().__getstate__()
        kept = {name: value for name, value in state.items() if name != "_skins"}
        return {**kept, "builder": None} if "mean_" in kept else kept

    def _fitted(self, curve: NDArray[np.float64] | None):
        if self.builder is None:
            raise ValueError("`builder` is needed: it makes the tables of each skin")
        inner: Any = self.kind() if self.inner is None else clone(self.inner)
        known = {} if curve is None else {"rest": curve, "averaged": inner.rest_sweeps}
        return inner.set_params(builder=partial(self.builder, **known)).fit()

    def _told(self, X, ask: Callable[[Any, NDArray], NDArray]) -> NDArray[np.float64]:
        """What the estimator of each row's skin tells of it, shape (sweep, ...)."""
        check_is_fitted(self)
        X = validate_data(self, X, reset=False)
        change, rest = np.split(X, 2, axis=1)
        parts, left = [], np.arange(len(rest))
        told = [] if left.size else [ask(self.mean_, change)]
        while left.size:
            rows, skin = self._of_one_skin(rest, left)
            told.append(ask(skin.estimator, change[rows] + aside(skin, rest[rows])))
            parts.append(rows)
            left = np.setdiff1d(left, rows)
        return np.concatenate(told)[np.argsort(np.concatenate(parts))] if parts else told[0]

    def _of_one_skin(self, rest: NDArray, left: NDArray[np.intp]) -> tuple[NDArray[np.intp], Skin]:
        """Rows of those left that are of the same skin as the first of them, and that skin."""
        skins = self.__dict__.setdefault("_skins", Skins(self._fitted))
        first = rest[left[0]]
        if self.beside:
            return left[:1], skins.at_once(first)
        known = skins.of(first)
        rows = left[away(rest[left], known.curve if known else first) < ALIKE]
        return rows, known or skins.made(rest[rows].mean(axis=0))


def aside(skin: Skin, rest: NDArray[np.float64]) -> NDArray[np.float64]:
    """What changes are more by against a skin's own curve than against other curves at rest.

    What these differ by and foam and sheets cannot is noise; the rest is drift, and left out.
    Shapes (sweep, number).
    """
    noisy = rest - skin.curve
    drift = skin.estimator.drift_
    return noisy - (drift @ np.linalg.lstsq(drift, noisy.T, rcond=None)[0]).T


class AdaptedClassifier(ClassifierMixin, _Adapted):
    """Posterior probabilities of the touches of whatever skin is at hand."""

    kind = ModelBased

    @property
    def classes_(self):
        """In ascending order, shape (K,)."""
        check_is_fitted(self)
        return self.mean_.classes_

    def predict_proba(self, X):
        """Of each class, shape (sweep, class)."""
        return self._told(X, lambda inner, change: inner.predict_proba(change))

    def log_densities(self, X, numbers: tuple[int, ...] | None = None):
        """As of `ModelBased`, where numbers are those of changes, (sweep, class + 1)."""
        return self._told(X, lambda inner, change: inner.log_densities(change, numbers))

    def predict(self, X):
        """The most probable class, shape (sweep,)."""
        return self.classes_[self.predict_proba(X).argmax(axis=1)]


class AdaptedPosition(RegressorMixin, _Adapted):
    """Place and strength of a touch on whatever skin is at hand."""

    kind = ModelBasedPosition

    def predict(self, X, return_std=False):
        """x [mm], y [mm] and strength, shape (sweep, 3), and their deviations, if asked."""
        both = self._told(X, _place_and_deviation)
        return (both[:, 0], both[:, 1]) if return_std else both[:, 0]

    def cells(self, X):
        """As of `ModelBasedPosition`, on whatever skin is at hand, shape (sweep, cell, 7)."""
        return self._told(X, lambda inner, change: inner.cells(change))

    @property
    def bounds_(self):
        """Lowest and highest x, y [mm] and strength, shape (3, 2)."""
        return self.mean_.bounds_

    def share_within(self, X, radius):
        """As of `ModelBasedPosition`, on whatever skin is at hand, shape (sweep,)."""
        return self._told(X, lambda inner, change: inner.share_within(change, radius))


def _place_and_deviation(inner: ModelBasedPosition, change: NDArray) -> NDArray[np.float64]:
    place, deviation = inner.predict(change, return_std=True)
    return np.stack([place, deviation], axis=1)
