"""Guard against kinds of press that are not in the training, such as two touches.

Sweeps of one touch at one place spread little: by strength, by noise and by differences between
skins. A second touch leads out of that spread, but not out of the range of all single touches. A
sweep that no press can cause, such as a failed reading, leads out of the principal components.
"""

from __future__ import annotations

from functools import reduce

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.decomposition import PCA
from sklearn.utils.validation import validate_data

from ...simulator.arrays import Real
from ..inputs.features import press_features
from ..inputs.samples import Samples
from .answers import NOTHING_PRESSED
from .folds import Splits, by_session
from .guard import Guard

COMPONENTS = 6
"""Number of principal components that describe a press; further ones hold noise alone."""
SWEEPS_FOR_EACH = 4
"""Sweeps, less the number of kinds, that are needed for each component."""
POOLED_WEIGHT = 10
"""Weight of the pooled covariance in the covariance of each kind, as a number of sweeps."""
MAX_CLUSTERS, SWEEPS_OF_PLACE = 25, 20
"""Maximum number of clusters of positions, and minimum mean number of sweeps in each."""
LIMIT_MARGIN, LIMIT_MARGIN_OF_ONE_SESSION = 1.15, 2.0
"""Factor of the limit over the distances of held-out sweeps.

The first allows for skins that differ more than the held-out sessions. The second applies where no
session was held out, so that the difference between sessions is unknown.
"""
MIN_VARIANCE = 1e-9
"""Variance added to each component, relative to the total variance within kinds."""
OUTSIDE_QUANTILE, OUTSIDE_MARGIN = 0.99, 1.3
"""Quantile of held-out distances outside the components, and factor of the limit over it.

Only noise lies outside the components. It is larger after fewer baseline sweeps.
"""
MIN_OUTSIDE_DISTANCE = 1e-5
"""Minimum of that quantile, relative to the root-sum-square spread of the features."""
TAILS = 0.01
"""Share of the training at either end of a feature that may be outliers."""


class KindGuard(Guard):
    """Guard by the Mahalanobis distance to the nearest kind of press.

    The distance outside all components, times `beside_`, counts instead where it is larger.

    Each kind is a normal distribution of leading components; the distance is that of
    P. C. Mahalanobis, Proc. Natl. Inst. Sci. India 2 (1936) 49-55. The unpressed skin, whose own
    spread is noise alone, takes the pooled spread of all kinds, so that it stays known while it
    drifts. A few bad training sweeps do not widen the guard: features are clipped beyond TAILS, and
    the limit is a quantile.

    Parameters
    ----------
    share: share of the held-out sweeps that are to be of a known kind. reach: factor of the limit
    over the distance of that share.

    Attributes
    ----------
    told_: indices of the features used, shape (k,). scale_: their divisors. pca_: components.
    means_: shape (kind, component). whitening_: shape (kind, component, component). limit_: the
    largest distance that is no novelty. beside_: factor that brings distances outside the
    components to the same limit.
    """

    def __init__(self, share=0.98, reach=LIMIT_MARGIN):
        self.share = share
        self.reach = reach

    def fit(
        self,
        X,
        kinds: ArrayLike,
        *,
        splits: Splits,
        columns: NDArray[np.intp] | None = None,
        equal_errors: bool = True,
    ):
        """Fit the spread of each kind, and the limit to the distances of held-out sweeps.

        X: shape (n, feature). kinds: a name for each sweep, shape (n,). columns: indices of the
        features to use; None uses all. equal_errors: True if these have equal errors; else each is
        scaled to unit variance. Returns self.
        """
        X = np.asarray(validate_data(self, X, ensure_min_samples=2, dtype=np.float64))
        kinds = np.asarray(kinds).astype(str)
        self.told_ = np.arange(X.shape[1]) if columns is None else columns
        held_out = [self._learn(X[a], kinds[a], equal_errors)._both(X[b]) for a, b in splits]
        self._learn(X, kinds, equal_errors)
        within, outside = np.concatenate(held_out, axis=1)
        self.limit_ = self.reach * float(np.quantile(within, self.share, method="higher")) or 1.0
        farthest = float(np.quantile(outside, OUTSIDE_QUANTILE, method="higher"))
        least = MIN_OUTSIDE_DISTANCE * np.sqrt(self.told_.size)
        self.beside_ = self.limit_ / (OUTSIDE_MARGIN * max(farthest, least))
        return self

    def away(self, X: Real) -> Real:
        """Distance from the nearest kind, or outside all components if larger, shape (n,)."""
        within, outside = self._both(X)
        return np.maximum(within, self.beside_ * outside)

    def _both(self, X: Real) -> Real:
        """Distance to the nearest kind within the components, and outside them, shape (2, n)."""
        shown = X[:, self.told_] / self.scale_
        components = self.pca_.transform(shown)
        squares = (
            np.square((components - mean) @ turn).sum(axis=1)
            for mean, turn in zip(self.means_, self.whitening_, strict=True)
        )
        outside = np.linalg.norm(shown - self.pca_.inverse_transform(components), axis=1)
        return np.array([np.sqrt(reduce(np.minimum, squares)), outside])

    def _learn(self, X: Real, kinds: NDArray[np.str_], equal_errors: bool) -> KindGuard:
        X = _without_outliers(X[:, self.told_])
        names, index = np.unique(kinds, return_inverse=True)
        spread = np.full(X.shape[1], X.std()) if equal_errors else X.std(axis=0)
        self.scale_ = np.where(spread > 0, spread, 1.0)
        enough = max(1, (len(X) - names.size) // SWEEPS_FOR_EACH)
        self.pca_ = PCA(min(COMPONENTS, enough, *X.shape), svd_solver="full").fit(X / self.scale_)
        components = self.pca_.transform(X / self.scale_)
        self.means_ = np.array([components[index == k].mean(axis=0) for k in range(names.size)])
        self.whitening_ = _whitenings(components - self.means_[index], index, names)
        return self


def kind_guard(samples: Samples, splits: Splits) -> KindGuard:
    """Guard for the classes of a target, or for places. splits: sweeps to train and hold out."""
    problem = samples.problem
    columns, equal_errors = press_features(problem.quantities, problem.features)
    kinds = _places(samples.y) if problem.continuous else samples.y
    reach = LIMIT_MARGIN if by_session(samples.sessions) else LIMIT_MARGIN_OF_ONE_SESSION
    return KindGuard(reach=reach).fit(
        samples.X, kinds, splits=splits, columns=columns, equal_errors=equal_errors
    )


def _without_outliers(X: Real) -> Real:
    """Clip each feature beyond its TAILS quantiles by the distance between them."""
    low, high = np.quantile(X, [TAILS, 1 - TAILS], axis=0)
    return np.clip(X, 2 * low - high, 2 * high - low)


def _whitenings(aside: Real, index: NDArray[np.intp], names: NDArray[np.str_]) -> Real:
    """Matrices that whiten deviations from each kind's mean, (kind, component, component)."""
    pooled = aside.T @ aside / max(1, len(aside) - names.size)
    floor = MIN_VARIANCE * max(float(np.trace(pooled)), np.finfo(float).tiny)
    pooled += floor * np.eye(len(pooled))
    found = []
    for k, name in enumerate(names):
        own = aside[index == k]
        blended = (own.T @ own + POOLED_WEIGHT * pooled) / (len(own) + POOLED_WEIGHT)
        spread = pooled if name in NOTHING_PRESSED else blended
        found.append(np.linalg.inv(np.linalg.cholesky(spread)).T)
    return np.array(found)


def _places(positions: Real) -> NDArray[np.intp]:
    """Cluster number of each touch, by its place. positions: shape (n, >= 2)."""
    from sklearn.cluster import KMeans

    count = int(np.clip(len(positions) // SWEEPS_OF_PLACE, 1, MAX_CLUSTERS))
    places = positions[:, :2]
    count = min(count, len(np.unique(places, axis=0)))
    return KMeans(count, random_state=0).fit_predict(places)
