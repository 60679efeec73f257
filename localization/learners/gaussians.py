"""Normal densities of each class; their parameters depend on the baseline curve of the skin.

The touches of a class are split by their strength into parts with a normal density each: a press
that raises the capacitance to 4.5 times changes other readings than one to 1.3 times. The change
of each part is x = t m + (t - 1)² b + noise. m is the response of this skin to a touch,
a quadratic function of the baseline curve. b is the curvature of the response in strength, a linear
function of the baseline curve. t is the strength of the touch, normal about 1. The residual is
normal too: it has a few directions of most spread, where presses and skins differ, and one variance
in all other directions, which prevents overfitting. The parts share patterns, see `shared`.

Coefficients of all classes shrink towards the few patterns that they share.

Few baseline sweeps come shortly before a touch, and their noise is in its change. A skin drifts
along the few directions in which skins differ most: as a whole it gets stiffer, or conducts less.
Along these directions only the latest baseline sweeps count. Across them the opening sweeps, which
are more, count too, as long as the difference there is no larger than noise.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Real
from ..parts.normal_densities import BaselineCorrection, ClassDensities, NormalDensities, terms
from ..parts.parts import AffineMap
from .drift import DRIFT, add_drift

FOLLOWED = 2
"""Number of directions in which skins differ most and drift is followed: foam and sheets."""
NOISE_QUANTILE = 0.99
"""Share of the training sweeps, which do not drift, whose squared length is within `noise`."""


def fitted_correction(opening: Real, recent: Real, count: int = FOLLOWED) -> BaselineCorrection:
    """The correction of `normal_densities`, with the directions of skins that do not drift.

    opening, recent: means of the opening and of the latest baseline sweeps, each of shape
    (sweep, feature). count: maximum number of directions.
    """
    differences = opening - opening.mean(axis=0)
    power, axes = np.linalg.eigh(differences.T @ differences)
    ways = np.asarray(axes[:, np.argsort(power)[::-1][:count]], np.float64)
    across = BaselineCorrection(ways, 0.0).across(recent - opening)
    squares = np.square(across).sum(axis=1)
    return BaselineCorrection(ways, float(np.quantile(squares, NOISE_QUANTILE)))


def shared(coefficients: Real, errors: Real, noise: Real) -> Real:
    """Coefficients with less noise, by shrinking the singular values of all classes together.

    Neighbouring touches change a skin similarly: the matrix of all coefficients, a row for each
    class, has few large singular values, and noise has many small ones. Each value y becomes
    sqrt((y² - b - 1)² - 4 b)/y, 0 below 1 + sqrt(b), of a matrix of shape (b n, n) in units of the
    noise times sqrt(n): M. Gavish, D. L. Donoho, IEEE Trans. Inf. Theory 63 (2017) 2137-2152, for
    the least squared error.

    coefficients: shape (class, term, number). errors: variance of each term in units of the noise,
    equal for all classes, shape (term,), > 0. noise: covariance of numbers, shape (number, number).
    """
    unit = np.linalg.inv(np.linalg.cholesky(noise)).T
    scale = np.sqrt(errors)[:, None]
    whitened = coefficients @ unit / scale
    left, values, right = np.linalg.svd(whitened.reshape(len(whitened), -1), full_matrices=False)
    short, long = sorted((len(whitened), whitened[0].size))
    y, b = values / np.sqrt(long), short / long
    above = y > 1 + np.sqrt(b)
    squared = np.square(np.square(y) - b - 1) - 4 * b
    kept = np.sqrt(np.where(above, squared, 0.0)) / np.where(above, y, 1.0) * np.sqrt(long)
    found = ((left * kept) @ right).reshape(whitened.shape)
    return np.linalg.solve(unit.T, (found * scale).swapaxes(1, 2)).swapaxes(1, 2)


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
    """Density of one part of a class, see `ClassDensities`."""

    by_curve: Real
    curvature: Real
    strength: float
    axes: Real
    own: Real
    floor: float


def fitted(
    X: Real,
    index: NDArray[np.intp],
    curve: NDArray[np.intp],
    absolute: NDArray[np.intp],
    *,
    drift: float = DRIFT,
    spread: int = SPREAD,
    strengths: int = STRENGTHS,
    followed: int = FOLLOWED,
) -> NormalDensities:
    """Densities of classes from training sweeps, to which synthetic drift is added.

    X: shape (sweep, feature). index: number of the class of each sweep, (sweep,). curve: indices of
    the features of the baseline curve; the other features have equal noise and show the press.
    absolute: indices of the features of the sweep as it was read; with them changes are taken from
    all baseline sweeps, see above. Drift and `absolute` are used if each of the three
    kinds has as many features, in the same order. drift, spread, strengths, followed: as DRIFT,
    SPREAD, STRENGTHS, FOLLOWED.
    """
    X = np.asarray(X, np.float64)
    change = np.setdiff1d(np.arange(X.shape[1]), np.concatenate([curve, absolute]))
    correction = None
    if len(absolute) == len(curve) == len(change) > 0:
        recent = X[:, absolute] - X[:, change]
        correction = fitted_correction(X[:, curve], recent, followed)
    X = drifted(X, curve, absolute, drift)
    changes, curves = X[:, change], X[:, curve]
    if correction is not None:
        changes = changes + correction(X[:, absolute] - changes - curves)
    _, turn = _axes(changes, COMPONENTS)
    centre, axes = _axes(curves, OF_CURVE, whiten=True)
    known = AffineMap(centre, axes, np.zeros(axes.shape[1]))
    components = changes @ turn
    parts, first = _by_strength(components, index, strengths)
    densities = _densities(components, terms(known(curves), SQUARED), parts, first, spread)
    return NormalDensities(
        X.shape[1], change, curve, absolute, correction, turn, known, SQUARED, densities
    )


def drifted(
    X: Real, curve: NDArray[np.intp], absolute: NDArray[np.intp], drift: float = DRIFT
) -> Real:
    """The sweeps with synthetic drift since their baseline; arguments: see `fitted`."""
    change = np.setdiff1d(np.arange(X.shape[1]), np.concatenate([curve, absolute]))
    return add_drift(X, curve, [change], drift) if len(curve) == len(change) else X


def _densities(
    change: Real, known: Real, index: NDArray[np.intp], first: NDArray[np.intp], spread: int
) -> ClassDensities:
    """Densities with noise that is shared between parts. change: components, (sweep, c)."""
    fits, counts = _fitted(change, known, index, spread), np.bincount(index)
    own = {name: np.array([getattr(fit, name) for fit in fits]) for name in ClassDensity._fields}
    pooled = float(np.average(own["floor"], weights=counts))
    least = TINY * float(np.square(change).mean()) + float(np.finfo(float).tiny)
    floor = (counts * own["floor"] + NOISE_WEIGHT * pooled) / (counts + NOISE_WEIGHT) + least
    prior = np.log(counts / len(change))
    return ClassDensities(
        **own | {"floor": floor, "own": own["own"] + least, "prior": prior, "first": first}
    )


def _axes(X: Real, count: int, whiten: bool = False) -> tuple[Real, Real]:
    """Mean and leading directions. whiten: scales each direction to unit variance."""
    mean = X.mean(axis=0)
    power, axes = np.linalg.eigh((X - mean).T @ (X - mean) / len(X))
    kept = np.flatnonzero(power > TINY * power.max(initial=0.0))[::-1][:count]
    return mean, np.asarray(axes[:, kept] / (np.sqrt(power[kept]) if whiten else 1.0), np.float64)


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
    """Densities of each part, before noise is shared between parts."""
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
    return ClassDensity(turn @ by_curve, bent, strength, axes, own, floor)


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
