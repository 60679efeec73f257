"""Place and strength of a touch anywhere on a skin, by inversion of a simulator's tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import NdBSpline, RegularGridInterpolator, make_interp_spline

from ...simulator.arrays import Mask, Real
from ..parts.plain import Sizes, require
from ..parts.predictor import Predictor
from .classifier import InversionPlan, novelty_limit
from .hypotheses import Mixture, mixture
from .region import PlaceDistribution, SkinMask, rms_distance, skin_mask_of

DEGREE = 3
SLOPES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


@dataclass(frozen=True, eq=False)
class ResponseSurface:
    """Numbers in units of noise over x [mm], y [mm] and strength.

    knots: knots of each axis. coefficients: shape (x, y, strength, number). nodes: x and y of the
    skin's table, mm. skin: effect of the unknowns of the skin, per rise of strength above 1, shape
    (x, y, number, unknown). bounds: lowest and highest x, y and strength, shape (3, 2).
    """

    knots: tuple[NDArray, NDArray, NDArray]
    coefficients: Real
    nodes: tuple[NDArray, NDArray]
    skin: Real
    bounds: Real

    def values(self, theta: Real) -> Real:
        """Values at theta, shape (place, 3), as an array of shape (place, number)."""
        return self._at(theta, (0, 0, 0))

    def slopes(self, theta: Real) -> Real:
        """Exact derivatives, shape (place, number, 3)."""
        return np.stack([self._at(theta, nu) for nu in SLOPES], axis=-1)

    def skin_effects(self, theta: Real) -> Real:
        """Effects of the unknowns of the skin, shape (place, number, unknown)."""
        between = RegularGridInterpolator(self.nodes, self.skin)
        return between(theta[:, :2]) * (theta[:, 2] - 1)[:, None, None]

    def _at(self, theta: Real, nu: tuple[int, ...]) -> Real:
        return NdBSpline(self.knots, self.coefficients, DEGREE)(theta, nu=nu)


def response_surface(tables: Mapping[str, NDArray], noise: Real) -> ResponseSurface:
    """Interpolate the tables of `simulator.inversion` for positions."""
    x, y, strength = 1e3 * tables["x"], 1e3 * tables["y"], tables["strength_nodes"]
    coefficients, knots = tables["values"] / noise, []
    for axis, nodes in enumerate((x, y, strength)):
        spline = make_interp_spline(nodes, coefficients, DEGREE, axis=axis)
        knots.append(spline.t)
        coefficients = np.moveaxis(spline.c, 0, axis)
    middle = strength[len(strength) // 2]
    return ResponseSurface(
        knots=(knots[0], knots[1], knots[2]),
        coefficients=np.ascontiguousarray(coefficients),
        nodes=(x, y),
        skin=tables["skin"] / noise[:, None] / (middle - 1),
        bounds=np.array([nodes[[0, -1]] for nodes in (x, y, strength)]),
    )


POSITION = "position"
GRID = (16, 16, 8)
"""Number of entries along x, y and strength."""
CELLS = GRID[0] * GRID[1]
OVERLAP = 0.5
"""Standard deviation within an entry, relative to the step to the next entry."""
MIN_SKIN_SHARE = 1e-12
"""Minimum share of skin of an entry: the value for entries outside the skin."""
POINTS_PER_CELL_SIDE = 6
"""Number of points along each side of a cell that are tested for skin."""
BLUR = 3.0
"""Blur of a posterior before its peak is taken, mm."""


class Posterior(NamedTuple):
    """Posterior of one sweep.

    entry: indices of the relevant entries. share: probability of each. mean, covariance: those of
    x, y [mm] and strength in each.
    """

    entry: NDArray[np.intp]
    share: Real
    mean: Real
    covariance: Real


@dataclass(frozen=True, eq=False)
class ModelBasedPosition(Predictor):
    """Peak of the blurred posterior of x [mm] and y [mm], mean strength, and their deviations.

    The model assumes one touch. The blur makes a broad peak with more probability win over a
    narrow, high one.

    noise: standard deviation of each feature, shape (feature,). bounds: see `ResponseSurface`.
    theta: x, y and strength of each entry, (entry, 3). scale: standard deviations within an entry,
    (3,). slopes: change of the features for one such deviation, (entry, feature, 3). mask: that of
    the skin, None for a rectangle. outside: True for entries completely outside the skin, (entry,).
    doubt: see `InversionPlan`.
    """

    noise: Annotated[Real, "F >0"]
    bounds: Annotated[Real, "3 2"]
    theta: Annotated[Real, "E 3"]
    scale: Annotated[Real, "3 >0"]
    slopes: Annotated[Real, "E F 3"]
    mixture: Mixture
    mask: SkinMask | None
    outside: Annotated[Mask, "E bool"]
    doubt: Annotated[float, ">0"]
    classes = None
    detects_novelty = True

    @classmethod
    def fitted(cls, plan: InversionPlan, baseline: Real | None = None) -> ModelBasedPosition:
        """Take the simulator's tables; baseline: see `InversionPlan.tables`."""
        tables = plan.tables(baseline)
        noise = plan.noise(tables)
        curve = response_surface(tables, noise)
        strengths, weights = tables["strengths"], tables["weights"]
        fine = np.interp(np.arange(GRID[2]), [0, GRID[2] - 1], [strengths[0], strengths[-1]])
        chance = np.interp(fine, strengths, weights)
        x, y = (_middles(low, high, GRID[k]) for k, (low, high) in enumerate(curve.bounds[:2]))
        theta = np.stack(np.meshgrid(x, y, fine, indexing="ij"), axis=-1).reshape(-1, 3)
        steps = np.array([x[1] - x[0], y[1] - y[0], fine[1] - fine[0]])
        scale = OVERLAP * np.where(steps > 0, steps, 1e-6)
        slopes = curve.slopes(theta) * scale
        spread = np.concatenate([slopes, curve.skin_effects(theta)], axis=2)
        entries = np.tile(chance / chance.sum(), len(x) * len(y)) / (len(x) * len(y))
        outside, mask = np.zeros(entries.size, dtype=bool), skin_mask_of(tables)
        if mask is not None:
            shares = np.repeat(_shares(mask, curve.bounds), GRID[2])
            outside, entries = shares == 0, entries * np.maximum(shares, MIN_SKIN_SHARE)
            entries /= entries.sum()
        found = mixture(curve.values(theta), spread, entries)
        return cls(noise, curve.bounds, theta, scale, slopes, found, mask, outside, plan.doubt)

    def _check(self, sizes: Sizes) -> None:
        fits = self.mixture.mean.shape == (sizes["E"], sizes["F"])
        require(fits, "mixture", "must be of as many entries and features")
        require(sizes["E"] == CELLS * GRID[2], "theta", f"must be of {CELLS * GRID[2]} entries")
        require((self.bounds[:, 0] <= self.bounds[:, 1]).all(), "bounds", "must be ascending")
        require(not self.outside.all(), "outside", "must leave a part of the skin")
        require(self.doubt < 1, "doubt", "must be below 1")

    @property
    def features(self) -> int:
        return self.noise.size

    def positions(self, X: Real) -> tuple[Real, Real]:
        """x [mm], y [mm] and strength, and their deviations, shape (sweep, 3) each.

        A deviation is the root-mean-square distance of the whole posterior. If a touch elsewhere is
        equally probable, it is of the order of the distance to that place.
        """
        posteriors = [self._posterior(each) for each in X / self.noise]
        best = np.array([self._best_estimate(each) for each in posteriors]).reshape(-1, 3)
        pairs = zip(posteriors, best, strict=True)
        return best, np.array([rms_distance(*own[1:], at) for own, at in pairs]).reshape(-1, 3)

    def places(self, X: Real) -> list[PlaceDistribution]:
        """The posterior of the place of each sweep."""
        return [self.places_of(self._posterior(each)) for each in X / self.noise]

    def share_within(self, X: Real, radius: float) -> Real:
        """Upper bound of the probability that any answer is within `radius` mm of the touch.

        Shape (sweep,).
        """
        return np.array([each.share_within(radius) for each in self.places(X)])

    def cells(self, X: Real) -> Real:
        """Probability of each cell of GRID, with mean and covariance of x and y [mm] in it.

        Shape (sweep, cell, 7): probability, 2 means, 4 entries of the covariance; zeros without
        probability. y varies fastest.
        """
        return np.array([cells_of(self._posterior(each)) for each in X / self.noise])

    def novel(self, X: Real) -> Mask:
        distances = self.mixture.distances(X / self.noise)
        distances[:, self.outside] = np.inf
        return distances.min(axis=1) > novelty_limit(self.doubt, self.noise.size)

    def _posterior(self, x: Real) -> Posterior:
        """Posterior of one sweep; the response is linear within each relevant entry."""
        found = self.mixture
        share = found.responsibilities(found.distances(x[None]))[0]
        kept = np.flatnonzero(share > 1e-4 * share.max())
        slopes, G, off = self.slopes[kept], found.directions[kept], x - found.mean[kept]
        weighed = slopes - np.einsum("ern,erk->enk", G, np.einsum("ern,enk->erk", G, slopes))
        moved = np.einsum("enk,en->ek", weighed, off) * self.scale
        left = np.eye(3) - np.einsum("enj,enk->ejk", slopes, weighed)
        covariance = left * self.scale[:, None] * self.scale
        return Posterior(
            kept, share[kept] / share[kept].sum(), self.theta[kept] + moved, covariance
        )

    def places_of(self, posterior: Posterior) -> PlaceDistribution:
        """Marginal posterior of the place."""
        covariance = posterior.covariance[:, :2, :2]
        mean = posterior.mean[:, :2]
        return PlaceDistribution(posterior.share, mean, covariance, self.bounds[:2], self.mask)

    def _best_estimate(self, posterior: Posterior) -> Real:
        strength = posterior.share @ posterior.mean[:, 2]
        return np.append(self.places_of(posterior).peak(BLUR), np.clip(strength, *self.bounds[2]))


def cells_of(posterior: Posterior) -> Real:
    """Moments of the place over all entries of each cell, see `cells`, shape (cell, 7)."""
    cell, share, mean = posterior.entry // GRID[2], posterior.share, posterior.mean[:, :2]
    square = posterior.covariance[:, :2, :2] + mean[:, :, None] * mean[:, None, :]
    moments = np.column_stack([np.ones_like(share), mean, square.reshape(-1, 4)]) * share[:, None]
    found = np.zeros((GRID[0] * GRID[1], 7))
    np.add.at(found, cell, moments)
    there = found[:, 0] > 0
    found[there, 1:] /= found[there, :1]
    middle = found[:, 1:3]
    found[:, 3:] -= (middle[:, :, None] * middle[:, None, :]).reshape(-1, 4)
    return found


def _shares(mask: SkinMask, bounds: Real) -> Real:
    """Share of each cell of GRID (y varies fastest) that is skin, shape (cell,)."""
    x, y = (
        _middles(low, high, POINTS_PER_CELL_SIDE * GRID[k])
        for k, (low, high) in enumerate(bounds[:2])
    )
    there = mask.contains(*np.meshgrid(x, y, indexing="ij"))
    return (
        there.reshape(GRID[0], POINTS_PER_CELL_SIDE, GRID[1], POINTS_PER_CELL_SIDE)
        .mean(axis=(1, 3))
        .ravel()
    )


def _middles(low: float, high: float, count: int) -> Real:
    return low + (high - low) * (np.arange(count) + 0.5) / count
