"""Normal densities, one a class, told by the curve at rest how a touch moves the skin at hand.

Of each class the change is x = t m + (t - 1)² b + noise. m, what a touch does to this skin, and b,
how strength bends that, are functions of the curve at rest, quadratic and linear; t, how strong the
touch is, is normal about 1. What is left is normal too: a few directions of most spread, where
hands and skins differ, and the same variance in all others, which keeps so many numbers from
learning the noise. A simulator has sweeps enough for all of these.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import softmax
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import check_is_fitted, validate_data

COMPONENTS, OF_CURVE, SQUARED, SPREAD = 16, 12, 3, 4
"""Of changes and of curves at rest that are looked at, those of curves whose products count, and
directions of a class's own spread."""
BENDING = 6
"""Components of the curve that tell how strength bends."""
DRIFT = 0.01
"""Of how far curves differ: what a skin may drift by between a touch and the rest before it."""
ROUNDS = 3
"""Of finding strengths and what they multiply, in turn."""
RIDGE = 1.0
"""Sweeps that show no dependence on the curve, added to each class."""
SHRUNK = 10.0
"""Sweeps of a class that the noise of all classes stands for."""
TINY = 1e-9

Array = NDArray[np.float64]


class Normal(NamedTuple):
    """Of one class. by_curve, bend: what gives m and b of a curve. strength: variance of t. axes,
    own: directions of spread, shape (component, k), and variances; floor: of all others. prior: ln
    of the share of all sweeps."""

    by_curve: Array
    bend: Array
    strength: float
    axes: Array
    own: Array
    floor: float
    prior: float


class GaussianClassifier(ClassifierMixin, BaseEstimator):
    """Probabilities by normal densities of changes, given the curve at rest.

    Parameters
    ----------
    curve: indices of the features that show the skin at rest; the others err alike, and tell of
    the press. components, of_curve, squared, spread: as COMPONENTS and so on, at most. drift: as
    DRIFT, where the curve has as many features as the change, in the same order.

    Attributes
    ----------
    classes_: ascending, shape (K,). normals_: of each, as `Normal` has it.
    """

    def __init__(
        self,
        curve=(),
        components=COMPONENTS,
        of_curve=OF_CURVE,
        squared=SQUARED,
        spread=SPREAD,
        drift=DRIFT,
    ):
        self.curve = curve
        self.components = components
        self.of_curve = of_curve
        self.squared = squared
        self.spread = spread
        self.drift = drift

    def fit(self, X, y):
        """X: shape (sweep, feature), y: classes, shape (sweep,). Returns self."""
        X, y = validate_data(self, X, y, dtype=np.float64, ensure_min_samples=2)
        X = np.asarray(X, np.float64)
        check_classification_targets(y)
        self.classes_, index = np.unique(y, return_inverse=True)
        X, curve = self.drifted(X), np.isin(np.arange(X.shape[1]), self.curve)
        self._of_change = _axes(X[:, ~curve], self.components)
        self._of_curve = _axes(X[:, curve], self.of_curve, alike=True)
        change, known = self._seen(X)
        fits = [
            _fitted(change[index == k], known[index == k], self.spread)
            for k in range(len(self.classes_))
        ]
        pooled = float(np.average([fit.floor for fit in fits], weights=np.bincount(index)))
        least = TINY * float(np.square(change).mean()) + float(np.finfo(float).tiny)
        counts = np.bincount(index)
        self.normals_ = [
            tuple(
                fit._replace(
                    floor=(n * fit.floor + SHRUNK * pooled) / (n + SHRUNK) + least,
                    own=fit.own + least,
                    prior=float(np.log(n / len(X))),
                )
            )
            for fit, n in zip(fits, counts.tolist(), strict=True)
        ]
        return self

    def drifted(self, X: Array) -> Array:
        """The same sweeps, of skins that have drifted since the rest before, see `drift`."""
        curve = np.isin(np.arange(X.shape[1]), self.curve)
        if 2 * curve.sum() != len(curve):
            return X
        X = X.copy()
        X[:, ~curve] += self.drift * _apart(X[:, curve])
        return X

    def decision_function(self, X):
        """ln of the density of each class with its share, shape (sweep, K); (sweep,) of two."""
        check_is_fitted(self)
        X = validate_data(self, X, reset=False, dtype=np.float64)
        change, known = self._seen(np.asarray(X, np.float64))
        normals = [Normal._make(each) for each in self.normals_]
        told = np.stack([_log_density(each, change, known) for each in normals], axis=1)
        return told[:, 1] - told[:, 0] if len(self.classes_) == 2 else told

    def predict_proba(self, X):
        """Of each class, shape (sweep, K)."""
        told = self.decision_function(X)
        both = np.stack([np.zeros_like(told), told], axis=1) if told.ndim == 1 else told
        return np.asarray(softmax(both, axis=1))

    def predict(self, X):
        """The likeliest class, shape (sweep,)."""
        check_is_fitted(self)
        return self.classes_[self.predict_proba(X).argmax(axis=1)]

    def _seen(self, X: Array) -> tuple[Array, Array]:
        """Components of the change; 1, components of the curve and some of their products."""
        curve = np.isin(np.arange(X.shape[1]), self.curve)
        (_, turn), (at_rest, axes) = self._of_change, self._of_curve
        z = (X[:, curve] - at_rest) @ axes
        known = np.hstack([np.ones((len(X), 1)), z, _products(z[:, : self.squared])])
        return X[:, ~curve] @ turn, known


def _apart(curves: Array) -> Array:
    """How other skins differ from the mean, one at random for each sweep."""
    order = np.random.default_rng(0).permutation(len(curves))
    return curves[order] - curves.mean(axis=0)


def _axes(X: Array, count: int, alike: bool = False) -> tuple[Array, Array]:
    """Mean and leading directions; alike: of unit variance in each."""
    mean = X.mean(axis=0)
    power, axes = np.linalg.eigh((X - mean).T @ (X - mean) / len(X))
    kept = np.flatnonzero(power > TINY * power.max(initial=0.0))[::-1][:count]
    return mean, np.asarray(axes[:, kept] / (np.sqrt(power[kept]) if alike else 1.0), np.float64)


def _products(z: Array) -> Array:
    one, other = np.triu_indices(z.shape[1])
    return z[:, one] * z[:, other]


def _fitted(change: Array, known: Array, spread: int) -> Normal:
    """Without shares, and before what all classes tell of noise."""
    by_curve = _regressed(known, change, free=1)
    bend = np.zeros((known[:, : BENDING + 1].shape[1], change.shape[1]))
    for _ in range(ROUNDS):
        t = _strength(change, known @ by_curve)[:, None]
        found = _regressed(np.hstack([t * known, _bending(t, known)]), change, free=1)
        by_curve, bend = found[: known.shape[1]], found[known.shape[1] :]
    touch = known @ by_curve
    t = _strength(change, touch)
    left = change - t[:, None] * touch - _bending(t[:, None], known) @ bend
    power, axes = np.linalg.eigh(left.T @ left / len(left))
    power, axes = np.maximum(power[::-1], 0.0), axes[:, ::-1]
    k = min(spread, max(len(power) - 2, 0))
    floor = float(power[k:-1].mean()) if len(power) - k > 1 else float(power.mean())
    noise = floor / max(float(np.square(touch).sum(axis=1).mean()), np.finfo(float).tiny)
    strength = max(float(t.var()) - noise, 0.0)
    own, axes = np.asarray(power[:k], np.float64), np.asarray(axes[:, :k], np.float64)
    return Normal(by_curve, bend, strength, axes, own, floor, 0.0)


def _strength(change: Array, touch: Array) -> Array:
    """t of each sweep by least squares, (sweep,); 1 where a touch does nothing."""
    size = np.square(touch).sum(axis=1)
    along = (change * touch).sum(axis=1)
    return np.divide(along, size, out=np.ones(len(size)), where=size > 0)


def _bending(t: Array, known: Array) -> Array:
    return np.square(t - 1) * known[:, : BENDING + 1]


def _regressed(known: Array, change: Array, free: int) -> Array:
    """Least squares with a ridge on all but the first so many columns."""
    held = np.full(known.shape[1], RIDGE)
    held[:free] = TINY
    found = np.linalg.solve(known.T @ known + np.diag(held), known.T @ change)
    return np.asarray(found, np.float64)


def _log_density(normal: Normal, change: Array, known: Array) -> Array:
    """By the lemma of Sherman and Morrison, as t spreads along m."""
    touch = known @ normal.by_curve
    along, size = _inner(normal, change - touch, touch), _inner(normal, touch, touch)
    wider = 1 + normal.strength * size
    t = 1 + normal.strength * along / wider
    left = change - touch - _bending(t[:, None], known) @ normal.bend
    along = _inner(normal, left, touch)
    apart = _inner(normal, left, left) - normal.strength * along**2 / wider
    others = change.shape[1] - len(normal.own)
    spread = np.log(normal.own).sum() + others * np.log(normal.floor) + np.log(wider)
    return normal.prior - (apart + spread) / 2


def _inner(normal: Normal, one: Array, other: Array) -> Array:
    """Of each two rows, over the variances of what is left."""
    more = 1 / normal.own - 1 / normal.floor
    within = ((one @ normal.axes) * (other @ normal.axes)) @ more
    return (one * other).sum(axis=1) / normal.floor + within
