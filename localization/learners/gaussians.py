"""Normal densities of each class; their parameters depend on the baseline curve of the skin.

The touches of a class are split by their strength into parts with a normal density each: a press
that raises the capacitance to 4.5 times changes other readings than one to 1.3 times. The change
of each part is x = t m + (t - 1)² b + noise. m is the response of this skin to a touch,
a quadratic function of the baseline curve. b is the curvature of the response in strength, a linear
function of the baseline curve. t is the strength of the touch, normal about 1. The residual is
normal too: it has a few directions of most spread, where presses and skins differ, and one variance
in all other directions, which prevents overfitting. The parts share patterns, see `shared`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import softmax
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import check_is_fitted, validate_data

from ...simulator.arrays import Real
from .drift import DRIFT, add_drift
from .drift_directions import FOLLOWED, DriftDirections
from .shrinkage import shared

COMPONENTS, OF_CURVE, SQUARED, SPREAD = 16, 12, 3, 4
"""Numbers of components and directions.

They count components of changes, components of baseline curves, those of curves that form products,
and directions of a class's own spread.
"""
CURVATURE_COMPONENTS = 6
"""Number of components of the curve that the curvature in strength depends on."""
STRENGTHS, SWEEPS_OF_STRENGTH = 3, 40
"""Maximum number of parts of a class, and minimum number of sweeps in each.

Factors uniform from 1.3 to 4.5, 5x5, other skins: three parts find 96 % of the weakest presses in
columns where one finds 81 %, and 77 % of pixels by two interfaces where one finds 62 %; a fourth
part adds nothing.
"""
MAX_RESIDUAL = 0.05
"""Power of what strengths leave of the changes of a class, over theirs, up to which it is split.

It is 0.001 to 0.01 for touches, and 15 for the unpressed skin, whose strengths are noise.
"""
ROUNDS = 3
"""Number of alternations between the fit of strengths and the fit of their coefficients."""
RIDGE = 1.0
"""Ridge penalty of each class: weight of no dependence on the curve, as a number of sweeps."""
NOISE_WEIGHT = 10.0
"""Weight of the noise of all classes in that of each class, as a number of sweeps."""
TINY = 1e-9


class ClassDensity(NamedTuple):
    """Density of one part of a class.

    by_curve, curvature: coefficients of m and b as functions of the curve. strength: variance of t.
    axes, own: directions of spread, shape (component, k), and variances; floor: variance of all
    other directions. prior: ln of the share of all sweeps.
    """

    by_curve: Real
    curvature: Real
    strength: float
    axes: Real
    own: Real
    floor: float
    prior: float


class GaussianClassifier(ClassifierMixin, BaseEstimator):
    """Probabilities by normal densities of changes, given the baseline curve.

    Parameters
    ----------
    curve: indices of the features of the baseline curve; the other features have equal noise and
    show the press. absolute: indices of the features of the sweep as it was read; with them changes
    are taken from all baseline sweeps, see `DriftDirections`. components, of_curve, squared,
    spread, strengths: maximum numbers, as the constants of these names. drift: as DRIFT. followed:
    as FOLLOWED. absolute and drift are used if each of the three kinds has as many features, in
    the same order.

    Attributes
    ----------
    classes_: ascending, shape (K,). normals_: fields of `ClassDensity` for each part, class by
    class. first_: number of the first part of each class, shape (K,).
    moved_: fields of `DriftDirections`, None without `absolute`.
    """

    def __init__(
        self,
        curve=(),
        absolute=(),
        components=COMPONENTS,
        of_curve=OF_CURVE,
        squared=SQUARED,
        spread=SPREAD,
        strengths=STRENGTHS,
        drift=DRIFT,
        followed=FOLLOWED,
    ):
        self.curve = curve
        self.absolute = absolute
        self.components = components
        self.of_curve = of_curve
        self.squared = squared
        self.spread = spread
        self.strengths = strengths
        self.drift = drift
        self.followed = followed

    def fit(self, X, y):
        """X: shape (sweep, feature), y: classes, shape (sweep,). Returns self."""
        X, y = validate_data(self, X, y, dtype=np.float64, ensure_min_samples=2)
        X = np.asarray(X, np.float64)
        check_classification_targets(y)
        self.classes_, index = np.unique(y, return_inverse=True)
        moved = self._moved(X)
        self.moved_ = None if moved is None else tuple(moved)
        X = self.drifted(X)
        change, curve = self._parts(X)
        self._of_change = _axes(change, self.components)
        self._of_curve = _axes(curve, self.of_curve, whiten=True)
        change, known = self._projected(X)
        index, self.first_ = _by_strength(change, index, self.strengths)
        fits = _fitted(change, known, index, self.spread)
        counts = np.bincount(index)
        pooled = float(np.average([fit.floor for fit in fits], weights=counts))
        least = TINY * float(np.square(change).mean()) + float(np.finfo(float).tiny)
        self.normals_ = [
            tuple(
                fit._replace(
                    floor=(n * fit.floor + NOISE_WEIGHT * pooled) / (n + NOISE_WEIGHT) + least,
                    own=fit.own + least,
                    prior=float(np.log(n / len(X))),
                )
            )
            for fit, n in zip(fits, counts.tolist(), strict=True)
        ]
        return self

    def drifted(self, X: Real) -> Real:
        """The sweeps with synthetic drift since their baseline, see `drift`."""
        curve, change = self._columns(X.shape[1])
        if len(curve) != len(change):
            return X
        return add_drift(X, curve, [change], self.drift)

    def decision_function(self, X):
        """ln of density times share of each class, shape (sweep, K).

        For two classes, the value of the second less that of the first, shape (sweep,).
        """
        check_is_fitted(self)
        X = validate_data(self, X, reset=False, dtype=np.float64)
        change, known = self._projected(np.asarray(X, np.float64))
        normals = [ClassDensity._make(each) for each in self.normals_]
        parts = np.stack([_log_density(each, change, known) for each in normals], axis=1)
        joint = np.logaddexp.reduceat(parts, self.first_, axis=1)
        return joint[:, 1] - joint[:, 0] if len(self.classes_) == 2 else joint

    def predict_proba(self, X):
        """Probability of each class, shape (sweep, K)."""
        joint = self.decision_function(X)
        both = np.stack([np.zeros_like(joint), joint], axis=1) if joint.ndim == 1 else joint
        return np.asarray(softmax(both, axis=1))

    def predict(self, X):
        """The most probable class, shape (sweep,)."""
        check_is_fitted(self)
        return self.classes_[self.predict_proba(X).argmax(axis=1)]

    def _columns(self, width: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Indices of the curve, in the given order, and of the change."""
        curve = np.array(self.curve, dtype=np.intp)
        others = np.concatenate([curve, np.array(self.absolute, dtype=np.intp)])
        return curve, np.setdiff1d(np.arange(width), others)

    def _moved(self, X: Real) -> DriftDirections | None:
        curve, change = self._columns(X.shape[1])
        if not len(self.absolute) == len(curve) == len(change) > 0:
            return None
        recent = X[:, self.absolute] - X[:, change]
        return DriftDirections.fitted(X[:, curve], recent, self.followed)

    def _parts(self, X: Real) -> tuple[Real, Real]:
        """The change, and the baseline curve."""
        curve, columns = self._columns(X.shape[1])
        change = X[:, columns]
        if self.moved_ is not None:
            moved = DriftDirections._make(self.moved_)
            change = change + moved.correction(X[:, self.absolute] - change - X[:, curve])
        return change, X[:, curve]

    def _projected(self, X: Real) -> tuple[Real, Real]:
        """Components of the change, and terms: 1, components of the curve, some products."""
        change, curve = self._parts(X)
        (_, turn), (centre, axes) = self._of_change, self._of_curve
        z = (curve - centre) @ axes
        known = np.hstack([np.ones((len(X), 1)), z, _products(z[:, : self.squared])])
        return change @ turn, known


def _axes(X: Real, count: int, whiten: bool = False) -> tuple[Real, Real]:
    """Mean and leading directions. whiten: scales each direction to unit variance."""
    mean = X.mean(axis=0)
    power, axes = np.linalg.eigh((X - mean).T @ (X - mean) / len(X))
    kept = np.flatnonzero(power > TINY * power.max(initial=0.0))[::-1][:count]
    return mean, np.asarray(axes[:, kept] / (np.sqrt(power[kept]) if whiten else 1.0), np.float64)


def _products(z: Real) -> Real:
    one, other = np.triu_indices(z.shape[1])
    return z[:, one] * z[:, other]


def _by_strength(
    change: Real, index: NDArray[np.intp], count: int
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Number of the part of each sweep, and of the first part of each class, see STRENGTHS."""
    parts, first = np.empty_like(index), [0]
    for k in range(index.max() + 1):
        own = np.flatnonzero(index == k)
        touch = np.broadcast_to(change[own].mean(axis=0), (own.size, change.shape[1]))
        t = _strength(change[own], touch)
        known = t[:, None] * touch
        clear = np.square(change[own] - known).sum() < MAX_RESIDUAL * np.square(known).sum()
        most = int(np.clip(own.size // SWEEPS_OF_STRENGTH, 1, count)) if clear else 1
        limits = np.quantile(t, np.arange(1, most) / most)
        _, part = np.unique(np.searchsorted(limits, t), return_inverse=True)
        parts[own] = first[-1] + part
        first.append(first[-1] + int(part.max()) + 1)
    return parts, np.array(first[:-1])


def _fitted(change: Real, known: Real, index: NDArray[np.intp], spread: int) -> list[ClassDensity]:
    """Densities of each part, without priors, and before noise is shared between parts."""
    root = np.linalg.cholesky(known.T @ known / len(known) + TINY * np.eye(known.shape[1]))
    turn = np.asarray(np.linalg.inv(root).T, np.float64)
    parts = [np.flatnonzero(index == k) for k in range(index.max() + 1)]
    changes, curves = [change[part] for part in parts], [known[part] @ turn for part in parts]
    terms = curves
    found, width = _regressed(terms, changes), known.shape[1]
    for _ in range(ROUNDS):
        strengths = [
            _strength(x, z @ own[:width])[:, None]
            for x, z, own in zip(changes, curves, found, strict=True)
        ]
        terms = [
            np.hstack([t * z, _curvature(t, z)]) for t, z in zip(strengths, curves, strict=True)
        ]
        found = _regressed(terms, changes)
    return [
        _normal(x, z, own[:width], own[width:], spread, turn)
        for x, z, own in zip(changes, curves, found, strict=True)
    ]


def _normal(
    change: Real, known: Real, by_curve: Real, bend: Real, spread: int, turn: Real
) -> ClassDensity:
    """Density of one class. turn: matrix from the original terms of the curve to `known`."""
    touch = known @ by_curve
    t = _strength(change, touch)
    left = change - t[:, None] * touch - _curvature(t[:, None], known) @ bend
    power, axes = np.linalg.eigh(left.T @ left / len(left))
    power, axes = np.maximum(power[::-1], 0.0), axes[:, ::-1]
    k = min(spread, max(len(power) - 2, 0))
    floor = float(power[k:-1].mean()) if len(power) - k > 1 else float(power.mean())
    noise = floor / max(float(np.square(touch).sum(axis=1).mean()), np.finfo(float).tiny)
    strength = max(float(t.var()) - noise, 0.0)
    own, axes = np.asarray(power[:k], np.float64), np.asarray(axes[:, :k], np.float64)
    bent = turn[: len(bend), : len(bend)] @ bend
    return ClassDensity(turn @ by_curve, bent, strength, axes, own, floor, 0.0)


def _strength(change: Real, touch: Real) -> Real:
    """t of each sweep by least squares, (sweep,); 1 if the class differs no more than noise."""
    size = np.square(touch).sum(axis=1)
    if size.mean() <= np.square(change - touch).mean():
        return np.ones(len(size))
    along = (change * touch).sum(axis=1)
    return np.divide(along, size, out=np.ones(len(size)), where=size > 0)


def _curvature(t: Real, known: Real) -> Real:
    return np.square(t - 1) * known[:, : CURVATURE_COMPONENTS + 1]


def _regressed(terms: list[Real], changes: list[Real]) -> Real:
    """Coefficients of each class by least squares, shared; shape (class, term, component)."""
    ridge = np.full(terms[0].shape[1], RIDGE)
    ridge[0] = TINY
    squares = np.array([z.T @ z for z in terms]) + np.diag(ridge)
    moments = np.array([z.T @ x for z, x in zip(terms, changes, strict=True)])
    found = np.asarray(np.linalg.solve(squares, moments), np.float64)
    left = [x - z @ own for x, z, own in zip(changes, terms, found, strict=True)]
    together = np.concatenate(left)
    noise = together.T @ together / max(len(together) - found[..., 0].size, 1)
    least = TINY * float(np.mean([np.square(x).mean() for x in changes]))
    noise = noise + (least + float(np.finfo(float).tiny)) * np.eye(len(noise))
    precision = 1 / np.diagonal(np.linalg.inv(squares), axis1=1, axis2=2)
    return shared(found, 1 / precision.mean(axis=0), noise)


def _log_density(normal: ClassDensity, change: Real, known: Real) -> Real:
    """ln density by the Sherman-Morrison formula, as the spread of t adds a rank-one term."""
    touch = known @ normal.by_curve
    along, size = _inner(normal, change - touch, touch), _inner(normal, touch, touch)
    wider = 1 + normal.strength * size
    t = 1 + normal.strength * along / wider
    left = change - touch - _curvature(t[:, None], known) @ normal.curvature
    along = _inner(normal, left, touch)
    distance = _inner(normal, left, left) - normal.strength * along**2 / wider
    others = change.shape[1] - len(normal.own)
    spread = np.log(normal.own).sum() + others * np.log(normal.floor) + np.log(wider)
    return normal.prior - (distance + spread) / 2


def _inner(normal: ClassDensity, one: Real, other: Real) -> Real:
    """Inner product of each pair of rows, weighted by the inverse covariance of the residual."""
    more = 1 / normal.own - 1 / normal.floor
    within = ((one @ normal.axes) * (other @ normal.axes)) @ more
    return (one * other).sum(axis=1) / normal.floor + within
