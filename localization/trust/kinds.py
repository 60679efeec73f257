"""Guard against kinds of press that are not in the training, such as two touches.

Sweeps of one touch at one place spread little: by strength, by noise and by differences between
skins. A second touch leads out of that spread, but not out of the range of all single touches. A
sweep that no press can cause, such as a failed reading, leads out of the principal components.
"""

from __future__ import annotations

import warnings
from contextlib import redirect_stderr
from dataclasses import dataclass, replace
from functools import cache, reduce
from io import StringIO
from typing import Annotated, Any

import numpy as np
from joblib import cpu_count
from numpy.typing import ArrayLike, NDArray

from ...simulator.arrays import Mask, Real
from ..inputs.features import press_features
from ..inputs.samples import Samples
from ..parts.parts import Components
from ..parts.plain import Plain, Sizes, require
from .answers import NOTHING_PRESSED
from .folds import Splits, by_session


@cache
def physical_cpu_count() -> int:
    """Number of physical cores, or of logical ones if the physical number is unknown.

    joblib prints a warning and a traceback if it is the first to find that `lscpu` is missing, and
    caches the number. scikit-learn then uses the cached number.
    """
    with warnings.catch_warnings(), redirect_stderr(StringIO()):
        warnings.simplefilter("ignore", UserWarning)
        return cpu_count(only_physical_cores=True)


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
MAX_LIMIT = 1e100
"""Maximum limit; kinds with one sweep each, which have no spread, give an infinite one."""
TAILS = 0.01
"""Share of the training at either end of a feature that may be outliers."""


@dataclass(frozen=True, eq=False)
class KindGuard(Plain):
    """Guard by the Mahalanobis distance to the nearest kind of press.

    u is the row of the features in `columns` over `scale`, p its components. The distance is the
    larger of min over kinds k of |(p - mean_k) W_k| and |u - back from p| outside: beyond the limit
    a sweep is novel. Each kind is a normal distribution: P. C. Mahalanobis, Proc. Natl. Inst. Sci.
    India 2 (1936) 49-55.

    features: number of features of a sweep. columns: indices of those used, shape (T,). means:
    shape (kind, component). whitening: W, shape (kind, component, component). outside: factor that
    brings distances outside the components to the same limit. limit: the largest distance that is
    no novelty.
    """

    features: Annotated[int, ">0"]
    columns: Annotated[NDArray[np.intp], "T <features"]
    scale: Annotated[Real, "T >0"]
    components: Components
    means: Annotated[Real, "kinds c"]
    whitening: Annotated[Real, "kinds c c"]
    outside: Annotated[float, ">=0"] = 0.0
    limit: Annotated[float, ">0"] = 1.0

    def _check(self, sizes: Sizes) -> None:
        own = self.components
        require(own.sizes == (sizes["T"], sizes["c"]), "components", "must fit columns and means")
        require(own.scale == 1, "components.scale", "must be 1")
        require(sizes["kinds"], "means", "must be of one kind or more")

    def distances(self, X: Real) -> Real:
        """Distance divided by the limit: above 1 is novel. X: shape (n, feature). Shape (n,)."""
        within, outside = self.both(X)
        return np.maximum(within, self.outside * outside) / self.limit

    def novel(self, X: Real) -> Mask:
        """True for sweeps unlike those of the training, shape (n,)."""
        return self.distances(X) > 1

    def both(self, X: Real) -> Real:
        """Distance to the nearest kind within the components, and outside them, shape (2, n)."""
        shown = X[:, self.columns] / self.scale
        components = self.components(shown)
        squares = (
            np.square((components - mean) @ turn).sum(axis=1)
            for mean, turn in zip(self.means, self.whitening, strict=True)
        )
        back = components @ self.components.directions + self.components.mean
        return np.array(
            [np.sqrt(reduce(np.minimum, squares)), np.linalg.norm(shown - back, axis=1)]
        )


def fitted_kind_guard(
    X: Real,
    kinds: ArrayLike,
    *,
    splits: Splits,
    columns: NDArray[np.intp] | None = None,
    equal_errors: bool = True,
    share: float = 0.98,
    reach: float = LIMIT_MARGIN,
) -> KindGuard:
    """Fit the spread of each kind, and the limit to the distances of held-out sweeps.

    The unpressed skin, whose own spread is noise alone, takes the pooled spread of all kinds, so
    that it stays known while it drifts. A few bad training sweeps do not widen the guard: features
    are clipped beyond TAILS, and the limit is a quantile.

    X: shape (n, feature). kinds: a name for each sweep, shape (n,). columns: indices of the
    features to use; None uses all. equal_errors: True if these have equal errors; else each is
    scaled to unit variance. share: share of the held-out sweeps that are to be of a known kind.
    reach: factor of the limit over the distance of that share.
    """
    kinds = np.asarray(kinds).astype(str)
    columns = np.arange(X.shape[1]) if columns is None else columns
    held_out = [_spread_of(X[a], kinds[a], columns, equal_errors).both(X[b]) for a, b in splits]
    guard = _spread_of(X, kinds, columns, equal_errors)
    within, outside = np.concatenate(held_out, axis=1)
    limit = min(reach * float(np.quantile(within, share, method="higher")) or 1.0, MAX_LIMIT)
    farthest = float(np.quantile(outside, OUTSIDE_QUANTILE, method="higher"))
    least = MIN_OUTSIDE_DISTANCE * float(np.sqrt(columns.size))
    return replace(guard, limit=limit, outside=limit / (OUTSIDE_MARGIN * max(farthest, least)))


def _spread_of(
    X: Real, kinds: NDArray[np.str_], columns: NDArray[np.intp], equal_errors: bool
) -> KindGuard:
    """The guard before its limit is known."""
    from sklearn.decomposition import PCA

    features, X = X.shape[1], _without_outliers(X[:, columns])
    names, index = np.unique(kinds, return_inverse=True)
    spread = np.full(X.shape[1], X.std()) if equal_errors else X.std(axis=0)
    scale = np.where(spread > 0, spread, 1.0)
    enough = max(1, (len(X) - names.size) // SWEEPS_FOR_EACH)
    pca: Any = PCA(min(COMPONENTS, enough, *X.shape), svd_solver="full").fit(X / scale)
    leading = Components(pca.mean_, pca.components_, 1.0)
    components = leading(X / scale)
    means = np.array([components[index == k].mean(axis=0) for k in range(names.size)])
    whitening = _whitenings(components - means[index], index, names)
    return KindGuard(features, columns, scale, leading, means, whitening)


def kind_guard(samples: Samples, splits: Splits) -> KindGuard:
    """Guard for the classes of a target, or for places. splits: sweeps to train and hold out."""
    problem = samples.problem
    columns, equal_errors = press_features(problem.quantities, problem.features)
    kinds = _places(samples.y) if problem.continuous else samples.y
    reach = LIMIT_MARGIN if by_session(samples.sessions) else LIMIT_MARGIN_OF_ONE_SESSION
    return fitted_kind_guard(
        samples.X, kinds, splits=splits, columns=columns, equal_errors=equal_errors, reach=reach
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

    physical_cpu_count()
    count = int(np.clip(len(positions) // SWEEPS_OF_PLACE, 1, MAX_CLUSTERS))
    places = positions[:, :2]
    count = min(count, len(np.unique(places, axis=0)))
    return KMeans(count, random_state=0).fit_predict(places)
