"""Grid of cells on a skin, and a position model's answer in each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr
from scipy.stats import norm

from ...simulator.arrays import Real
from ..inversion.position import BLUR, GRID
from ..inversion.region import PlaceDistribution, SkinMask
from ..inversion.regions import INVERTING_POSITIONS, sides_of
from ..model.localizer_model import Model
from ..trust.fitted import Regressor

NEGLIGIBLE = 1e-12


@dataclass(frozen=True, eq=False)
class CellGrid:
    """GRID cells of a skin; y varies fastest.

    bounds: lowest and highest x and y [mm], (2, 2). mask: mask of the skin within them, None if all
    is skin.
    """

    learned: Regressor
    bounds: Real
    mask: SkinMask | None = None

    @property
    def cell(self) -> tuple[float, float]:
        """Width and height of a cell, mm."""
        width, height = np.ptp(self.bounds, axis=1) / GRID[:2]
        return float(width), float(height)

    @property
    def _edges(self) -> list[Real]:
        return [np.linspace(a, b, n + 1) for (a, b), n in zip(self.bounds, GRID[:2], strict=True)]

    def cell_moments(self, X: Real) -> Real:
        """Probability of each cell, mean x and y [mm] in it, covariance, (sweep, cell, 7)."""
        step = self.learned.predictor
        if isinstance(step, INVERTING_POSITIONS):
            return self.with_calibrated_deviations(step.cells(X))
        place, deviation = self.learned.positions(X)
        x, y = (
            _interval_moments(place[:, k], deviation[:, k], edges)
            for k, edges in enumerate(self._edges)
        )
        found = np.zeros((len(X), GRID[0], GRID[1], 7))
        found[..., 0] = x[0][:, :, None] * y[0][:, None, :]
        found[..., 1], found[..., 3] = x[1][:, :, None], x[2][:, :, None]
        found[..., 2], found[..., 6] = y[1][:, None, :], y[2][:, None, :]
        return found.reshape(len(X), -1, 7)

    def with_calibrated_deviations(self, cells: Real) -> Real:
        """Moments from `ModelBasedPosition.cells`, with calibrated deviations."""
        factor = np.outer(self.learned.factor[:2], self.learned.factor[:2]).ravel()
        return cells * np.concatenate([np.ones(3), factor])

    def peak_and_deviation(self, belief: Real, moments: Real) -> tuple[Real, Real]:
        """Peak x and y of the blurred belief in cells, and its deviations from there, mm.

        moments: those of the latest sweep, see `cell_moments`, shape (cell, 7). A cell of
        negligible probability in that sweep counts as uniform over the cell.
        """
        mean, covariance = moments[:, 1:3].copy(), moments[:, 3:].reshape(-1, 2, 2).copy()
        silent = moments[:, 0] <= NEGLIGIBLE
        middles = [(edges[1:] + edges[:-1]) / 2 for edges in self._edges]
        mean[silent] = np.stack(np.meshgrid(*middles, indexing="ij"), -1).reshape(-1, 2)[silent]
        covariance[silent] = np.diag(np.square(self.cell) / 12)
        kept = belief > NEGLIGIBLE * belief.max()
        share = belief[kept] / belief[kept].sum()
        places = PlaceDistribution(share, mean[kept], covariance[kept], self.bounds, self.mask)
        return places.peak_and_deviation(BLUR)


def cell_grid_of(model: Model) -> CellGrid:
    """Grid of a model of positions. Raises InputError as `Model.known_scene`."""
    assert isinstance(model.learned, Regressor)
    step = model.predictor
    if isinstance(step, INVERTING_POSITIONS):
        return CellGrid(model.learned, step.bounds[:2], step.mask)
    return CellGrid(model.learned, sides_of(model.known_scene.parts.skin))


def _interval_moments(mean: Real, deviation: Real, edges: Real) -> tuple[Real, Real, Real]:
    """Shares of a normal distribution between edges, and its mean and variance there.

    Each has shape (sweep, part). Source: N. L. Johnson, S. Kotz, N. Balakrishnan, Continuous
    Univariate Distributions 1 (1994), 10.1.
    """
    deviation = np.maximum(deviation, 1e-3)[:, None]
    at = (edges - mean[:, None]) / deviation
    a, b = at[:, :-1], at[:, 1:]
    share = np.maximum(ndtr(b) - ndtr(a), NEGLIGIBLE)
    off = (norm.pdf(a) - norm.pdf(b)) / share
    inner = np.clip(mean[:, None] + deviation * off, edges[:-1], edges[1:])
    narrow = 1 + (a * norm.pdf(a) - b * norm.pdf(b)) / share - off**2
    variance = np.clip(deviation**2 * narrow, 1e-6, np.diff(edges) ** 2)
    return share / share.sum(axis=1, keepdims=True), inner, variance
