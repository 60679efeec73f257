"""Normal densities of the changes of each class, given the baseline curve of the skin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Real
from .parts import AffineMap, Part, centred
from .plain import Plain, Sizes, require, require_orthonormal

OPENING = 0.65
"""Weight of the opening sweeps in the baseline across the directions of drift."""
Index = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class BaselineCorrection(Plain):
    """Correction of changes for a skin that drifts, see `learners.drift_directions`.

    directions: orthonormal, shape (change, direction). noise: squared length of the noise across
    them.
    """

    directions: Annotated[Real, "F d"]
    noise: Annotated[float, ">=0"]

    def _check(self, sizes: Sizes) -> None:
        require_orthonormal(self.directions.T, "directions")

    def __call__(self, moved: Real) -> Real:
        """Correction to add to changes from the latest baseline, shape (sweep, feature).

        moved: latest baseline less the opening one. The correction is its part across the
        directions times OPENING. It is smaller the more that part exceeds the noise, by the
        shrinkage of W. James and C. Stein (1961).
        """
        across = self.across(moved)
        size = np.square(across).sum(axis=1, keepdims=True)
        believed = np.minimum(self.noise / np.maximum(size, np.finfo(float).tiny), 1.0)
        return OPENING * believed * across

    def across(self, moved: Real) -> Real:
        """The part of each row across the directions."""
        return moved - moved @ self.directions @ self.directions.T


@dataclass(frozen=True, eq=False)
class ClassDensities(Plain):
    """Densities of all parts P of K classes, in components of the change, c of them.

    by_curve, curvature: coefficients of the response m and of its curvature b as functions of the
    terms of the curve, shapes (P, terms, c) and (P, first terms, c). strength: variance of the
    strength t of a touch, (P,). axes, own: directions of spread, orthonormal, (P, c, k), and their
    variances, (P, k). floor: variance in all other directions, (P,). prior: ln of the share of all
    sweeps, (P,). first: number of the first part of each class, ascending, (K,).
    """

    by_curve: Annotated[Real, "P W c"]
    curvature: Annotated[Real, "P B c"]
    strength: Annotated[Real, "P >=0"]
    axes: Annotated[Real, "P c k"]
    own: Annotated[Real, "P k >0"]
    floor: Annotated[Real, "P >0"]
    prior: Annotated[Real, "P"]
    first: Annotated[Index, "K int"]

    def _check(self, sizes: Sizes) -> None:
        require(sizes["B"] <= sizes["W"], "curvature", "must have no more terms than `by_curve`")
        require_orthonormal(self.axes.swapaxes(1, 2), "axes")
        counts = np.diff(self.first, append=sizes["P"])
        whole = self.first[0] == 0 and (counts > 0).all()
        require(whole, "first", f"must rise from 0, below {sizes['P']}")

    def logarithms(self, change: Real, known: Real) -> Real:
        """ln of density times share of each class, shape (sweep, K).

        change: (sweep, c). known: (sweep, terms). That of each part is by the Sherman-Morrison
        formula, as the spread of t adds a rank-one term.
        """
        first = known[:, : self.curvature.shape[1]]
        found = [self._logarithm(k, change, known, first) for k in range(len(self.floor))]
        return np.logaddexp.reduceat(np.stack(found, axis=1), self.first, axis=1)

    def _logarithm(self, k: int, change: Real, known: Real, first: Real) -> Real:
        touch, strength = known @ self.by_curve[k], self.strength[k]
        along, size = self._inner(k, change - touch, touch), self._inner(k, touch, touch)
        wider = 1 + strength * size
        t = 1 + strength * along / wider
        left = change - touch - np.square(t - 1)[:, None] * first @ self.curvature[k]
        along = self._inner(k, left, touch)
        distance = self._inner(k, left, left) - strength * along**2 / wider
        others = change.shape[1] - self.own.shape[1]
        spread = np.log(self.own[k]).sum() + others * np.log(self.floor[k]) + np.log(wider)
        return self.prior[k] - (distance + spread) / 2

    def _inner(self, k: int, one: Real, other: Real) -> Real:
        """Inner product of each pair of rows, by the inverse covariance of the residual."""
        more = 1 / self.own[k] - 1 / self.floor[k]
        within = ((one @ self.axes[k]) * (other @ self.axes[k])) @ more
        return (one * other).sum(axis=1) / self.floor[k] + within


@dataclass(frozen=True, eq=False)
class NormalDensities(Part):
    """ln of density times share of each class, see `learners.gaussians`.

    change, curve, absolute: indices of features; absolute are those of the sweep as read, empty
    without correction. turn: axes of changes, shape (change, c). known: map from the curve to its
    components z. squared: number of components of z that form products; the terms are 1, z and
    these products.
    """

    features: Annotated[int, ">0"]
    change: Annotated[Index, "D <features"]
    curve: Annotated[Index, "R <features"]
    absolute: Annotated[Index, "A <features"]
    correction: BaselineCorrection | None
    turn: Annotated[Real, "D c"]
    known: AffineMap
    squared: Annotated[int, ">=0"]
    densities: ClassDensities

    def _check(self, sizes: Sizes) -> None:
        require(sizes["D"], "change", "must have a feature")
        known = self.known.sizes
        require(known[0] == sizes["R"], "known", "must take the features of the curve")
        _, width, c = self.densities.by_curve.shape
        squared = min(self.squared, known[1] or 0)
        terms = 1 + (known[1] or 0) + squared * (squared + 1) // 2
        require((width, c) == (terms, sizes["c"]), "densities", "must fit the terms")
        if self.correction is not None:
            fits = sizes["D"] == sizes["R"] == sizes["A"] == len(self.correction.directions)
            require(fits, "correction", "must be of as many changes as curve and sweep have")

    @property
    def sizes(self) -> tuple[int | None, int | None]:
        return self.features, len(self.densities.first)

    def __call__(self, x: Real) -> Real:
        found = self.densities.logarithms(*self.projected(x))
        return found if found.shape[1] > 2 else centred(found)

    def projected(self, x: Real) -> tuple[Real, Real]:
        """Components of the change, and terms of the curve."""
        change, curve = x[:, self.change], x[:, self.curve]
        if self.correction is not None:
            change = change + self.correction(x[:, self.absolute] - change - curve)
        return change @ self.turn, terms(self.known(curve), self.squared)


def terms(z: Real, squared: int) -> Real:
    """1, components z of the curve, and products of the first `squared`; shape (sweep, term)."""
    one, other = np.triu_indices(min(squared, z.shape[1]))
    return np.hstack([np.ones((len(z), 1)), z, z[:, one] * z[:, other]])
