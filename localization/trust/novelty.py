"""Whether a sweep is unlike all that a localizer was trained on."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator
from sklearn.metrics import pairwise_distances_argmin_min
from sklearn.utils.validation import check_is_fitted, validate_data

from ..cores import count_cores

LEAST_VARIANCE = 1e-10
"""Of the largest: directions along which the training varies less count as varying so much."""

TAILS = 0.01
"""Part of the training at either end of a feature that may be outliers."""
PARTS = 5
"""Into which training is cut to see how far from the rest each part lies."""


class Guard(BaseEstimator):
    """Tells novelties by how far they are `away` from what was learned, against `limit_`."""

    limit_: float

    def away(self, X: NDArray[np.float64]) -> NDArray[np.float64]:
        """From what is nearest of what was learned, shape (n,)."""
        raise NotImplementedError

    def distances(self, X) -> NDArray[np.float64]:
        """The same over the limit: above 1 is novel. Shape (n,)."""
        check_is_fitted(self)
        X = np.asarray(validate_data(self, X, reset=False, dtype=np.float64))
        return self.away(X) / self.limit_

    def predict(self, X):
        """1 for a sweep like what was learned, -1 for a novelty; shape (n,)."""
        return np.where(self.distances(X) > 1, -1, 1)


class NoveltyGuard(Guard):
    """Distance to the nearest sweep of the training, in features whitened by all of the training.

    A few bad sweeps among the training do not widen it: features count no farther than TAILS, and
    the limit is a quantile.

    Parameters
    ----------
    most: sweeps of the training that are kept.
    share: of the training's sweeps, each held out with its group, that are to lie within the
        quantile of distances; reach: how many times that is no novelty yet.

    Attributes
    ----------
    told_: features looked at, shape (told,). mean_: shape (told,). whitening_: shape (told, told).
    kept_: shape (kept, told), whitened. limit_: the largest distance that is no novelty.
    """

    def __init__(self, most=1000, share=0.99, reach=1.3):
        self.most = most
        self.share = share
        self.reach = reach

    def fit(
        self, X, y=None, *, groups: ArrayLike | None = None, told: NDArray[np.intp] | None = None
    ):
        """Learn what sweeps look like, and how far new ones of that kind lie from those known.

        X: shape (n, feature). groups: of sweeps that resemble each other, as those of a session
        do, shape (n,); without it each is its own. told: features to look at, all without. Returns
        self.
        """
        X = np.asarray(validate_data(self, X, ensure_min_samples=2, dtype=np.float64))
        own = np.arange(len(X)) if groups is None else np.asarray(groups)
        self.told_ = np.arange(X.shape[1]) if told is None else told
        unseen = [self._learn(X[~part]).away(X[part]) for part in _parts(own)]
        self._learn(X)
        farthest = np.quantile(np.concatenate(unseen), self.share, method="lower")
        self.limit_ = self.reach * float(farthest) or 1.0
        return self

    def away(self, X: NDArray[np.float64]) -> NDArray[np.float64]:
        """To the nearest sweep that is kept, in whitened features, shape (n,)."""
        count_cores()
        return pairwise_distances_argmin_min(self._whitened(X[:, self.told_]), self.kept_)[1]

    def _learn(self, X: NDArray[np.float64]) -> NoveltyGuard:
        X = _without_outliers(X[:, self.told_])
        random = np.random.default_rng(0)
        kept = np.sort(random.permutation(len(X))[: self.most])
        self.mean_ = X.mean(axis=0)
        self.whitening_ = _whitening(X - self.mean_)
        self.kept_ = self._whitened(X[kept])
        return self

    def _whitened(self, X: NDArray[np.float64]) -> NDArray[np.float64]:
        return (X - self.mean_) @ self.whitening_


def _without_outliers(X: NDArray[np.float64]) -> NDArray[np.float64]:
    """With features clipped as far beyond TAILS as these are apart."""
    low, high = np.quantile(X, [TAILS, 1 - TAILS], axis=0)
    return np.clip(X, 2 * low - high, 2 * high - low)


def _whitening(centred: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turns features of any units so that each varies by 1, and on its own."""
    scale = centred.std(axis=0)
    scale[scale == 0] = 1.0
    variance, turn = np.linalg.eigh(np.cov(centred / scale, rowvar=False).reshape(2 * scale.shape))
    floor = max(LEAST_VARIANCE * variance.max(), np.finfo(float).tiny)
    return turn / np.sqrt(np.maximum(variance, floor)) / scale[:, None]


def _parts(groups: NDArray) -> list[NDArray[np.bool_]]:
    """Sweeps in at most PARTS parts of whole groups, as masks; each its own where all are one."""
    names = np.unique(groups)
    if names.size < 2:
        return _parts(np.arange(groups.size))
    return [np.isin(groups, some) for some in np.array_split(names, min(PARTS, names.size))]
