"""Whether a sweep is of no kind of press that a localizer was trained on: two touches are another.

Of one touch at one place the sweeps spread little: by strength, by noise, by what differs between
skins. A second touch leads out of that spread, though not out of all that one touch can do. What no
press does, as a reading that failed, leads out of the components that presses are looked at by.
"""

from __future__ import annotations

from functools import reduce

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.decomposition import PCA
from sklearn.utils.validation import validate_data

from ..inputs.features import press_features
from ..inputs.samples import Samples
from .answers import NOTHING_PRESSED
from .folds import Splits, by_session
from .guard import Guard

COMPONENTS = 6
"""Of features, that a press is looked at by: more of them hold noise alone."""
SWEEPS_FOR_EACH = 4
"""Sweeps beyond the means of kinds that tell how a component spreads."""
LENT = 10
"""Sweeps of all kinds together that each kind's own spread is filled up with."""
MOST_PLACES, SWEEPS_OF_PLACE = 25, 20
"""Parts of a skin that positions are taken for, and how many sweeps each has at least."""
FURTHER, FURTHER_UNSEEN = 1.15, 2.0
"""How many times farther off than sweeps held out a known kind reaches, on skins that differ more
than sessions that were held out; and where none were, so that none are known to differ."""
LEAST_VARIANCE = 1e-9
"""Of the largest within kinds."""
SHARE_BESIDE, FURTHER_BESIDE = 0.99, 1.3
"""Of sweeps held out, those that lie no farther beside the components; and how many times farther
beside is no novelty yet: noise alone is there, more of it where fewer rests came before."""
LEAST_BESIDE = 1e-5
"""Of how features spread: sweeps held out count as lying at least so far beside the components."""
TAILS = 0.01
"""Part of the training at either end of a feature that may be outliers."""


class KindGuard(Guard):
    """Distance to the nearest kind of press, in units of how sweeps of that kind spread; or that
    beside all components, times `beside_`, if it is more.

    Each kind is a normal distribution of leading components; the distance is that of
    P. C. Mahalanobis, Proc. Natl. Inst. Sci. India 2 (1936) 49-55. The skin at rest, of which noise
    alone would be the spread, is lent that of all kinds, for a rest that drifts must stay one. A
    few bad sweeps among the training do not widen it: features count no farther than TAILS, and the
    limit is a quantile.

    Parameters
    ----------
    share: of the sweeps held out that are to be of a known kind. reach: how many times farther off
    is no novelty yet.

    Attributes
    ----------
    told_: features looked at, shape (told,). scale_: what they are divided by. pca_: components.
    means_: shape (kind, component). whitening_: shape (kind, component, component). limit_: the
    largest distance that is no novelty. beside_: what makes it that of distances beside components.
    """

    def __init__(self, share=0.98, reach=FURTHER):
        self.share = share
        self.reach = reach

    def fit(
        self,
        X,
        kinds: ArrayLike,
        *,
        splits: Splits,
        told: NDArray[np.intp] | None = None,
        alike: bool = True,
    ):
        """Learn how sweeps of each kind spread, and how far held-out ones lie from their like.

        X: shape (n, feature). kinds: a name for each, shape (n,). told: features to look at, all
        without. alike: whether these err alike; else each is brought to unit variance. Returns
        self.
        """
        X = np.asarray(validate_data(self, X, ensure_min_samples=2, dtype=np.float64))
        kinds = np.asarray(kinds).astype(str)
        self.told_ = np.arange(X.shape[1]) if told is None else told
        unseen = [self._learn(X[a], kinds[a], alike)._both(X[b]) for a, b in splits]
        self._learn(X, kinds, alike)
        within, beside = np.concatenate(unseen, axis=1)
        self.limit_ = self.reach * float(np.quantile(within, self.share, method="higher")) or 1.0
        farthest = float(np.quantile(beside, SHARE_BESIDE, method="higher"))
        least = LEAST_BESIDE * np.sqrt(self.told_.size)
        self.beside_ = self.limit_ / (FURTHER_BESIDE * max(farthest, least))
        return self

    def away(self, X: NDArray[np.float64]) -> NDArray[np.float64]:
        """From the nearest kind, in units of its spread, or beside all of them, shape (n,)."""
        within, beside = self._both(X)
        return np.maximum(within, self.beside_ * beside)

    def _both(self, X: NDArray[np.float64]) -> NDArray[np.float64]:
        """Distance to the nearest kind within the components, and outside them, shape (2, n)."""
        shown = X[:, self.told_] / self.scale_
        seen = self.pca_.transform(shown)
        squares = (
            np.square((seen - mean) @ turn).sum(axis=1)
            for mean, turn in zip(self.means_, self.whitening_, strict=True)
        )
        beside = np.linalg.norm(shown - self.pca_.inverse_transform(seen), axis=1)
        return np.array([np.sqrt(reduce(np.minimum, squares)), beside])

    def _learn(self, X: NDArray[np.float64], kinds: NDArray[np.str_], alike: bool) -> KindGuard:
        X = _without_outliers(X[:, self.told_])
        names, index = np.unique(kinds, return_inverse=True)
        spread = np.full(X.shape[1], X.std()) if alike else X.std(axis=0)
        self.scale_ = np.where(spread > 0, spread, 1.0)
        enough = max(1, (len(X) - names.size) // SWEEPS_FOR_EACH)
        self.pca_ = PCA(min(COMPONENTS, enough, *X.shape), svd_solver="full").fit(X / self.scale_)
        seen = self.pca_.transform(X / self.scale_)
        self.means_ = np.array([seen[index == k].mean(axis=0) for k in range(names.size)])
        self.whitening_ = _whitenings(seen - self.means_[index], index, names)
        return self


def kind_guard(samples: Samples, splits: Splits) -> KindGuard:
    """Guard for the classes of a target, or for places. splits: sweeps to train and hold out."""
    problem = samples.problem
    told, alike = press_features(problem.quantities, problem.features)
    kinds = _places(samples.y) if problem.continuous else samples.y
    reach = FURTHER if by_session(samples.sessions) else FURTHER_UNSEEN
    return KindGuard(reach=reach).fit(samples.X, kinds, splits=splits, told=told, alike=alike)


def _without_outliers(X: NDArray[np.float64]) -> NDArray[np.float64]:
    """With features clipped as far beyond TAILS as these are apart."""
    low, high = np.quantile(X, [TAILS, 1 - TAILS], axis=0)
    return np.clip(X, 2 * low - high, 2 * high - low)


def _whitenings(
    aside: NDArray[np.float64], index: NDArray[np.intp], names: NDArray[np.str_]
) -> NDArray[np.float64]:
    """Turns what lies aside from a kind's mean so that it varies by 1, (kind, component, same)."""
    pooled = aside.T @ aside / max(1, len(aside) - names.size)
    floor = LEAST_VARIANCE * max(float(np.trace(pooled)), np.finfo(float).tiny)
    pooled += floor * np.eye(len(pooled))
    found = []
    for k, name in enumerate(names):
        own = aside[index == k]
        lent = (own.T @ own + LENT * pooled) / (len(own) + LENT)
        spread = pooled if name in NOTHING_PRESSED else lent
        found.append(np.linalg.inv(np.linalg.cholesky(spread)).T)
    return np.array(found)


def _places(positions: NDArray[np.float64]) -> NDArray[np.intp]:
    """A number for each touch, the same where they are near each other. positions: (n, >= 2)."""
    from sklearn.cluster import KMeans

    count = int(np.clip(len(positions) // SWEEPS_OF_PLACE, 1, MOST_PLACES))
    places = positions[:, :2]
    count = min(count, len(np.unique(places, axis=0)))
    return KMeans(count, random_state=0).fit_predict(places)
