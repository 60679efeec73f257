"""Place and strength of a touch anywhere on a skin, by inversion of a simulator's tables."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.utils.validation import check_is_fitted, validate_data

from ...simulator.arrays import Real
from .classifier import Builder, simulated
from .mixture import Mixture, mixture
from .region import PlaceDistribution, Region, region_of
from .response_surface import ResponseSurface, response_surface
from .skin_mask import SkinMask, skin_mask_of

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


class ModelBasedPosition(RegressorMixin, BaseEstimator):
    """Peak of the blurred posterior of x [mm] and y [mm], mean strength, and their deviations.

    Parameters: see `ModelBased`; the model assumes one touch. The blur makes a broad peak with
    more probability win over a narrow, high one.

    Attributes
    ----------
    noise_: standard deviation of each feature, shape (feature,). bounds_: see `ResponseSurface`.
    theta_: x, y and strength of each entry, (entry, 3). scale_: standard deviations within an
    entry, (3,). slopes_: change of the features for one such deviation, (entry, feature, 3). mean_,
    directions_, along_, log_weight_: arrays of the `Mixture`. edge_: squared distance beyond which
    a sweep is novel. on_skin_, sides_: the `SkinMask`, if the skin is no rectangle. beside_: True
    for entries completely outside such a skin, (entry,).
    """

    def __init__(
        self,
        scene="",
        builder: Builder | None = None,
        *,
        presses="dataset",
        rest_sweeps=20,
        doubt=1e-3,
    ):
        self.scene = scene
        self.builder = builder
        self.presses = presses
        self.rest_sweeps = rest_sweeps
        self.doubt = doubt

    def fit(self, X=None, y=None):
        """Take the simulator's tables; X, y are only checked."""
        tables = self._tables()
        self.noise_ = tables["deviation"] * np.sqrt(1 + 1 / self.rest_sweeps)
        self.n_features_in_ = self.noise_.size
        if X is not None:
            validate_data(self, X, reset=False)
        self.edge_ = float(chi2.isf(self.doubt, self.noise_.size))
        self._keep(response_surface(tables, self.noise_), tables)
        return self

    def predict(self, X, return_std=False):
        """x [mm], y [mm] and strength, shape (sweep, 3).

        return_std: also returns the root-mean-square distance of the whole posterior from them, of
        the same shape. If a touch elsewhere is equally probable, it is of the order of the distance
        to that place.
        """
        posteriors = [self._posterior(each) for each in self._scaled(X)]
        best = np.array([self._best_estimate(each) for each in posteriors]).reshape(-1, 3)
        if not return_std:
            return best
        pairs = zip(posteriors, best, strict=True)
        return best, np.array([_distance(posterior, theta) for posterior, theta in pairs])

    def regions(self, X, probability=0.95) -> list[Region]:
        """The smallest region of places that contains the probability, for each sweep."""
        return [region_of(each, probability) for each in self.places(X)]

    def places(self, X) -> list[PlaceDistribution]:
        """The posterior of the place of each sweep."""
        return [self.places_of(self._posterior(each)) for each in self._scaled(X)]

    def share_within(self, X, radius):
        """Upper bound of the probability that any answer is within `radius` mm of the touch.

        Shape (sweep,).
        """
        return np.array([each.share_within(radius) for each in self.places(X)])

    def cells(self, X):
        """Probability of each cell of GRID, with mean and covariance of x and y [mm] in it.

        Shape (sweep, cell, 7): probability, 2 means, 4 entries of the covariance; zeros without
        probability. y varies fastest.
        """
        return np.array([cells_of(self._posterior(each)) for each in self._scaled(X)])

    def novel(self, X):
        """True if even the best fit exceeds what noise and skin allow, shape (sweep,)."""
        distances = self.mixture().distances(self._scaled(X))
        if self.mask is not None:
            distances[:, self.beside_] = np.inf
        return distances.min(axis=1) > self.edge_

    @property
    def mask(self) -> SkinMask | None:
        """Mask of the skin; None for a rectangle."""
        if not hasattr(self, "on_skin_"):
            return None
        return SkinMask(self.on_skin_, self.sides_)

    def _tables(self) -> Mapping[str, NDArray]:
        return (self.builder or simulated)(self.scene, POSITION, self.presses)

    def _scaled(self, X) -> Real:
        check_is_fitted(self)
        return validate_data(self, X, reset=False) / self.noise_

    def _keep(self, curve: ResponseSurface, tables) -> None:
        self.bounds_ = curve.bounds
        strengths, weights = tables["strengths"], tables["weights"]
        fine = np.interp(np.arange(GRID[2]), [0, GRID[2] - 1], [strengths[0], strengths[-1]])
        chance = np.interp(fine, strengths, weights)
        x, y = (_middles(low, high, GRID[k]) for k, (low, high) in enumerate(curve.bounds[:2]))
        self.theta_ = np.stack(np.meshgrid(x, y, fine, indexing="ij"), axis=-1).reshape(-1, 3)
        steps = np.array([x[1] - x[0], y[1] - y[0], fine[1] - fine[0]])
        self.scale_ = OVERLAP * np.where(steps > 0, steps, 1e-6)
        self.slopes_ = curve.slopes(self.theta_) * self.scale_
        spread = np.concatenate([self.slopes_, curve.skin_effects(self.theta_)], axis=2)
        entries = np.tile(chance / chance.sum(), len(x) * len(y)) / (len(x) * len(y))
        mask = skin_mask_of(tables)
        if mask is not None:
            self.on_skin_, self.sides_ = mask.inside, mask.sides
            shares = np.repeat(_shares(mask, curve.bounds), GRID[2])
            self.beside_, entries = shares == 0, entries * np.maximum(shares, MIN_SKIN_SHARE)
            entries /= entries.sum()
        found = mixture(curve.values(self.theta_), spread, entries)
        self.mean_, self.directions_, self.along_ = found.mean, found.directions, found.along
        self.log_weight_ = found.log_weight

    def mixture(self) -> Mixture:
        """All entries as normal distributions of numbers in units of the noise."""
        check_is_fitted(self)
        return Mixture(self.mean_, self.directions_, self.along_, self.log_weight_)

    def _posterior(self, x: Real) -> Posterior:
        """Posterior of one sweep; the response is linear within each relevant entry."""
        found = self.mixture()
        share = found.responsibilities(found.distances(x[None]))[0]
        kept = np.flatnonzero(share > 1e-4 * share.max())
        slopes, G, off = self.slopes_[kept], self.directions_[kept], x - self.mean_[kept]
        weighed = slopes - np.einsum("ern,erk->enk", G, np.einsum("ern,enk->erk", G, slopes))
        moved = np.einsum("enk,en->ek", weighed, off) * self.scale_
        left = np.eye(3) - np.einsum("enj,enk->ejk", slopes, weighed)
        covariance = left * self.scale_[:, None] * self.scale_
        return Posterior(
            kept, share[kept] / share[kept].sum(), self.theta_[kept] + moved, covariance
        )

    def places_of(self, posterior: Posterior) -> PlaceDistribution:
        """Marginal posterior of the place."""
        covariance = posterior.covariance[:, :2, :2]
        mean = posterior.mean[:, :2]
        return PlaceDistribution(posterior.share, mean, covariance, self.bounds_[:2], self.mask)

    def _best_estimate(self, posterior: Posterior) -> Real:
        strength = posterior.share @ posterior.mean[:, 2]
        return np.append(self.places_of(posterior).peak(BLUR), np.clip(strength, *self.bounds_[2]))


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


def _distance(posterior: Posterior, theta: Real) -> Real:
    squares = (posterior.mean - theta) ** 2 + np.einsum("eii->ei", posterior.covariance)
    return np.sqrt(posterior.share @ squares)


def _middles(low: float, high: float, count: int) -> Real:
    return low + (high - low) * (np.arange(count) + 0.5) / count
