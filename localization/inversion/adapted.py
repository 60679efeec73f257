"""Inversion adapted to the actual skin, which is identified by its baseline curve.

The simulator computes tables once for each new baseline curve. The answer to a sweep depends on its
own curve only, not on other sweeps in the same call.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator, ClassifierMixin, RegressorMixin, clone
from sklearn.utils.validation import check_is_fitted, validate_data

from ...simulator.arrays import Real
from .classifier import Builder, ModelBased, simulated
from .position import ModelBasedPosition
from .region import PlaceDistribution
from .skin_cache import SkinCache


class _Adapted(BaseEstimator):
    """Base of both adapted estimators: one inner estimator for each skin.

    Parameters
    ----------
    inner: unfitted estimator, cloned for each skin. builder: makes the tables; None for the
    simulator's.

    Attributes
    ----------
    mean_: the inner estimator, fitted to the mean skin. taught_: changes and labels for fine-tuning
    of the parameters of the skin that the baseline curve leaves open; absent without fine-tuning.
    """

    kind: type
    in_background = False
    """True if new tables are computed in the background, and the nearest skin's serve meanwhile."""

    def __init__(self, inner=None, builder: Builder | None = None):
        self.inner = inner
        self.builder = builder

    def fit(self, X, y=None):
        """Take the tables of the mean skin.

        X: shape (sweep, feature). y: labels. They fine-tune the estimators of other skins if
        `inner` has `learn`; otherwise X is only checked.
        """
        self._skins = SkinCache(self._fitted)
        self.mean_ = self._fitted(None)
        self.n_features_in_ = 2 * self.mean_.n_features_in_
        X = validate_data(self, X, reset=False)
        if getattr(self.inner, "learn", "nothing") != "nothing" and y is not None:
            self.taught_ = [np.split(X, 2, axis=1)[0], np.asarray(y)]
        return self

    def novel(self, X):
        """True if even the best fit exceeds what noise and skin allow, shape (sweep,)."""
        return self._by_skin(X, lambda inner, change: inner.novel(change)).astype(bool)

    def for_baseline(self, curve: Real):
        """The estimator for the skin with this baseline curve of lnZ0 and phase0, (number,)."""
        check_is_fitted(self)
        return self._of_skin(curve)

    def __getstate__(self):
        """State without the cache of skins, which is filled again when needed."""
        state: Any = super().__getstate__()
        return {name: value for name, value in state.items() if name != "_skins"}

    def _fitted(self, curve: Real | None):
        inner: Any = self.kind() if self.inner is None else clone(self.inner)
        inner.set_params(builder=self.builder)
        if curve is None:
            return inner.fit()
        of_skin = partial(self.builder or simulated, baseline=curve, averaged=inner.rest_sweeps)
        return inner.set_params(builder=of_skin).fit(*getattr(self, "taught_", []))

    def _by_skin(self, X, predict: Callable[[Any, NDArray], NDArray]) -> Real:
        """Result of `ask` for each row, by the estimator of its skin, shape (sweep, ...)."""
        check_is_fitted(self)
        X = validate_data(self, X, reset=False)
        change, rest = np.split(X, 2, axis=1)
        return self._by_curve(change, rest, predict)

    def _by_curve(
        self, change: NDArray, rest: NDArray, predict: Callable[[Any, NDArray], NDArray]
    ) -> Real:
        curves, skin = np.unique(rest, axis=0, return_inverse=True)
        if not len(curves):
            return predict(self.mean_, change)
        parts = [np.flatnonzero(skin == k) for k in range(len(curves))]
        results = [
            predict(self._of_skin(curve), change[rows])
            for curve, rows in zip(curves, parts, strict=True)
        ]
        return np.concatenate(results)[np.argsort(np.concatenate(parts))]

    def _of_skin(self, curve: Real):
        skins = self.__dict__.setdefault("_skins", SkinCache(self._fitted))
        if self.in_background:
            return skins.nearest(curve).estimator
        return (skins.exact(curve) or skins.fitted(curve)).estimator


class AdaptedClassifier(ClassifierMixin, _Adapted):
    """Posterior probabilities of touches, adapted to the skin of each sweep."""

    kind = ModelBased

    @property
    def classes_(self):
        """Classes in ascending order, shape (K,)."""
        check_is_fitted(self)
        return self.mean_.classes_

    def predict_proba(self, X):
        """Probability of each class, shape (sweep, class)."""
        return self._by_skin(X, lambda inner, change: inner.predict_proba(change))

    def log_densities(self, X, numbers: tuple[int, ...] | None = None):
        """`ModelBased.log_densities`, where numbers count changes, (sweep, class + 1)."""
        return self._by_skin(X, lambda inner, change: inner.log_densities(change, numbers))

    def predict(self, X):
        """The most probable class, shape (sweep,)."""
        return self.classes_[self.predict_proba(X).argmax(axis=1)]


class AdaptedPosition(RegressorMixin, _Adapted):
    """Place and strength of a touch, adapted to the skin of each sweep."""

    kind = ModelBasedPosition

    def predict(self, X, return_std=False):
        """x [mm], y [mm] and strength, shape (sweep, 3).

        return_std: also returns their deviations, of the same shape.
        """
        both = self._by_skin(X, _place_and_deviation)
        return (both[:, 0], both[:, 1]) if return_std else both[:, 0]

    def places(self, X) -> list[PlaceDistribution]:
        """The posterior of the place of each sweep."""
        return self._by_skin(
            X, lambda inner, change: np.array(inner.places(change), object)
        ).tolist()

    def cells(self, X):
        """`ModelBasedPosition.cells` for the skin of each sweep, shape (sweep, cell, 7)."""
        return self._by_skin(X, lambda inner, change: inner.cells(change))

    @property
    def bounds_(self):
        """Lowest and highest x, y [mm] and strength, shape (3, 2)."""
        return self.mean_.bounds_

    @property
    def mask(self):
        """Mask of the skin; None for a rectangle."""
        return self.mean_.mask

    def share_within(self, X, radius):
        """`ModelBasedPosition.share_within` for the skin of each sweep, shape (sweep,)."""
        return self._by_skin(X, lambda inner, change: inner.share_within(change, radius))


def _place_and_deviation(inner: ModelBasedPosition, change: NDArray) -> Real:
    place, deviation = inner.predict(change, return_std=True)
    return np.stack([place, deviation], axis=1)
