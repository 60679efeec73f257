"""Smallest region that contains a touch with a given probability.

On a skin that is not a rectangle a mask tells the places that an answer may have.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Mask, Real
from ..parts.plain import Plain, Sizes, require


@dataclass(frozen=True, eq=False)
class SkinMask(Plain):
    """Uniform cells over a rectangle from (0, 0), and a mask of those that are skin.

    inside: shape (y, x). sides: lengths of the rectangle along x and y, mm.
    """

    inside: Annotated[Mask, "rows columns bool"]
    sides: Annotated[Real, "2 >0"]

    def _check(self, sizes: Sizes) -> None:
        require(self.inside.any(), "inside", "must have skin")

    def contains(self, x: Real, y: Real) -> Mask:
        """True for places in mm that are on the skin, x and y of the same shape."""
        column, row = (
            np.clip((at / side * count).astype(np.int64), 0, count - 1)
            for at, side, count in zip((x, y), self.sides, self.inside.shape[::-1], strict=True)
        )
        return self.inside[row, column]

    def nearest(self, place: Real) -> Real:
        """The place itself if it is on the skin, else the nearest cell centre; mm, shape (2,)."""
        if self.contains(*place[:, None])[0]:
            return place
        row, column = np.nonzero(self.inside)
        counts = np.array(self.inside.shape[::-1])
        middles = (np.stack([column, row], axis=1) + 0.5) * self.sides / counts
        return middles[((middles - place) ** 2).sum(axis=1).argmin()]


def skin_mask_of(tables: Mapping[str, NDArray]) -> SkinMask | None:
    """Mask from the tables of `simulator.inversion` for positions; None for a rectangle."""
    if "on_skin" not in tables:
        return None
    return SkinMask(np.asarray(tables["on_skin"], dtype=bool), 1e3 * tables["sides"])


LINES = 41
NEGLIGIBLE = 1e-4
MAX_DEVIATIONS = 4.0
"""Number of standard deviations beyond which an entry is neglected."""
DISC_STEP = 1.0
"""Distance between the centres of discs, mm."""
STARTS, STEPS = 200, 50
PEAK_TOLERANCE = 1e-6
"""Step below which the search for the peak ends, mm."""


def rms_distance(weight: Real, mean: Real, covariance: Real, at: Real) -> Real:
    """Root-mean-square distances along each axis of weighted normal distributions from a point."""
    return np.sqrt(weight @ ((mean - at) ** 2 + np.einsum("eii->ei", covariance)))


@dataclass(frozen=True, eq=False)
class PlaceDistribution:
    """Posterior of a sweep's place: normal distributions within the skin, x and y in mm.

    weight: shape (entry,). mean: (entry, 2). covariance: (entry, 2, 2), mm². bounds: (2, 2).
    mask: mask of the skin within the bounds, None if all is skin.
    """

    weight: Real
    mean: Real
    covariance: Real
    bounds: Real
    mask: SkinMask | None = None

    def density(self, x: Real, y: Real) -> Real:
        """Density in 1/mm² at x and y, of their shape."""
        kept = self.weight > NEGLIGIBLE * self.weight.max()
        inverse = np.linalg.inv(self.covariance[kept])
        peak = self.weight[kept] * np.sqrt(np.linalg.det(inverse)) / (2 * np.pi)
        away = np.stack([x, y], axis=-1)[..., None, :] - self.mean[kept]
        density = np.exp(-_squared_distance(inverse, away) / 2) @ peak
        return density if self.mask is None else density * self.mask.contains(x, y)

    def peak_and_deviation(self, blur: float) -> tuple[Real, Real]:
        """The peak, see `peak`, and the root-mean-square distances along x and y from it."""
        best = self.peak(blur)
        return best, rms_distance(self.weight, self.mean, self.covariance, best)

    def peak(self, blur: float) -> Real:
        """Peak of the blurred posterior, shape (2,).

        blur: standard deviation of the normal blur, mm. The search starts from the best of the
        entries' means. Each step goes to the weighted mean of the entries there (mean shift), which
        never lowers the density.
        """
        inverse = np.linalg.inv(self.covariance + blur**2 * np.eye(2))
        height = self.weight * np.sqrt(np.linalg.det(inverse))
        towards = (inverse @ self.mean[:, :, None])[..., 0]

        def pull(places: Real) -> Real:
            return height * np.exp(-_squared_distance(inverse, places[:, None] - self.mean) / 2)

        likeliest = self.mean[np.argsort(-self.weight)[:STARTS]]
        place = likeliest[pull(likeliest).sum(axis=1).argmax()]
        for _ in range(STEPS):
            pulls = pull(place[None])[0]
            moved = np.linalg.solve(np.tensordot(pulls, inverse, 1), pulls @ towards)
            done = np.abs(moved - place).max() < PEAK_TOLERANCE
            place = moved
            if done:
                break
        within = np.clip(place, *self.bounds.T)
        return within if self.mask is None else self.mask.nearest(within)

    def content(self, x: float, y: float) -> float:
        """Content of the smallest region that reaches a place: 0 at the peak, up to 1 far away."""
        density = self.density(*np.meshgrid(*self.grid()))
        there = self.density(np.array(x), np.array(y))
        return float(density[density > there].sum() / density.sum())

    def grid(self) -> tuple[Real, Real]:
        """Cell centres, x and y in mm, over the part of the skin that the posterior reaches."""
        kept = self.weight > NEGLIGIBLE * self.weight.max()
        reach = MAX_DEVIATIONS * np.sqrt(np.einsum("eii->ei", self.covariance[kept]))
        low = np.maximum((self.mean[kept] - reach).min(axis=0), self.bounds[:, 0])
        high = np.minimum((self.mean[kept] + reach).max(axis=0), self.bounds[:, 1])
        sides = np.where((high > low)[:, None], np.stack([low, high], axis=1), self.bounds)
        return _middles(*sides[0]), _middles(*sides[1])

    def share_within(self, radius: float) -> float:
        """The largest share of the posterior in any disc of this radius, in mm.

        No answer lies within that distance of the touch with a higher probability.
        """
        from scipy.signal import fftconvolve

        x, y = (np.arange(low, high + DISC_STEP, DISC_STEP) for low, high in self.bounds)
        density = self.density(*np.meshgrid(x, y))
        aside = np.arange(-radius // DISC_STEP, radius // DISC_STEP + 2) * DISC_STEP
        disc = np.hypot(*np.meshgrid(aside, aside)) <= radius
        return float(fftconvolve(density, disc, mode="same").max() / density.sum())


@dataclass(frozen=True, eq=False)
class Region:
    """Region on a grid of cells.

    x, y: cell centres, mm. inside: True for cells of the region, shape (y, x). level: the density
    on its border. places: the whole posterior.
    """

    x: Real
    y: Real
    inside: Mask
    level: float
    places: PlaceDistribution

    @property
    def area(self) -> float:
        """Area of the region, mm²."""
        return float(self.inside.sum() * (self.x[1] - self.x[0]) * (self.y[1] - self.y[0]))

    def shade(self, x: Real, y: Real) -> Real:
        """Density relative to the maximum on the grid, at most 1, and 0 outside of the region."""
        there = self.places.density(x, y)
        peak = self.places.density(*np.meshgrid(self.x, self.y)).max()
        return np.where(there >= self.level, np.minimum(there / peak, 1.0), 0.0)

    def covers(self, x: float, y: float) -> bool:
        """True if the place lies within the region."""
        return bool(self.places.density(np.array(x), np.array(y)) >= self.level)


def region_of(places: PlaceDistribution, probability: float) -> Region:
    """The cells of highest density that together contain the probability."""
    x, y = places.grid()
    density = places.density(*np.meshgrid(x, y))
    ordered = np.sort(density, axis=None)[::-1]
    content = np.cumsum(ordered) / ordered.sum()
    level = float(ordered[np.searchsorted(content, probability)])
    return Region(x, y, density >= level, level, places)


def _squared_distance(inverse: NDArray[Any], away: Real) -> Real:
    """Squared Mahalanobis distance from the mean of each entry, shape (..., entry).

    inverse: inverse covariance, shape (entry, 2, 2). away: difference, shape (..., entry, 2).
    """
    u, v = away[..., 0], away[..., 1]
    return inverse[:, 0, 0] * u**2 + inverse[:, 1, 1] * v**2 + 2 * inverse[:, 0, 1] * u * v


def _middles(low: float, high: float) -> Real:
    return low + (high - low) * (np.arange(LINES) + 0.5) / LINES
