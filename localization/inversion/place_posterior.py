"""Posterior of a touch's place, updated reading by reading."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp, softmax

from ...simulator.arrays import Real
from .mixture import Mixture
from .position import CELLS, GRID, ModelBasedPosition, Posterior
from .region import PlaceDistribution
from .sequential_posterior import SequentialPosterior

SAMPLED = 64
"""Number of entries drawn from the posterior to estimate gains."""
NO_PLACE = -1
MIN_POSTERIOR_SHARE = 1e-4
"""Share relative to the most probable entry below which an entry is ignored."""


class PlacePosterior(SequentialPosterior):
    """Posterior of one touch or none from a position localizer's tables.

    The last entry is the unpressed skin.

    log_prior: ln of the prior of the unpressed skin, then of a touch in each cell of GRID (y varies
    fastest), (1 + cell,); -inf for what is impossible.
    """

    def __init__(self, localizer: ModelBasedPosition, log_prior: Real) -> None:
        touched = localizer.mixture
        super().__init__(_with_unpressed(touched), localizer.noise, localizer.doubt)
        self._localizer = localizer
        cell = np.arange(len(touched.mean)) // GRID[2]
        chance = touched.log_chance
        self._cell = np.append(cell, NO_PLACE)
        self._of_cell = np.append(chance - _by_cell(chance)[cell], 0.0)
        self._log_prior = log_prior[self._cell + 1]
        outside = localizer.outside
        self._possible = np.append(~outside, np.isfinite(log_prior[0]))
        self._along = _along(touched.spread, localizer.slopes)

    @property
    def log_densities(self) -> Real:
        """ln likelihood: unpressed skin, a touch in each cell, then a sweep that is just novel."""
        joint = self._of_cell + self.fit
        return np.concatenate([joint[-1:], _by_cell(joint[:-1]), [self.just_novel]])

    @property
    def novel(self) -> bool:
        """True if no possible entry explains the readings so far."""
        return bool(self.distance[self._possible].min() > self.novelty_limit)

    @property
    def unpressed(self) -> float:
        """Probability that nothing is pressed."""
        return float(self._share[-1])

    @property
    def posterior(self) -> Posterior:
        """Posterior of place and strength, given that there is a touch."""
        share, of = self._share[:-1], self._localizer
        kept = np.flatnonzero(share > MIN_POSTERIOR_SHARE * share.max())
        T, scale = self._along[kept], of.scale
        moved = np.einsum("erk,er->ek", T, self.latent_mean[kept]) * scale
        known = np.eye(T.shape[1]) - self.latent_covariance[kept]
        left = np.eye(3) - np.einsum("erj,ers,esk->ejk", T, known, T)
        covariance = left * scale[:, None] * scale
        return Posterior(kept, share[kept] / share[kept].sum(), of.theta[kept] + moved, covariance)

    @property
    def places(self) -> PlaceDistribution:
        """Posterior of the place, given that there is a touch."""
        return self._localizer.places_of(self.posterior)

    def gains(self, readings: NDArray[np.intp]) -> Real:
        """Information on the place that each further reading is expected to give, nat, (reading,).

        It is the sum of the information on the cell or "unpressed", see
        `SequentialPosterior.expected_information`, and of that within a cell, where the response is
        linear.
        """
        share = self._share
        drawn = np.searchsorted(np.cumsum(share), (np.arange(SAMPLED) + 0.5) / SAMPLED)
        entry, count = np.unique(np.minimum(drawn, share.size - 1), return_counts=True)
        chance = count / SAMPLED
        between = self.expected_information(entry, chance, self._cell[entry], readings)
        touched = entry < share.size - 1
        return between + self._within(entry[touched], readings) @ chance[touched]

    @property
    def _share(self) -> Real:
        return np.asarray(softmax(self._of_cell + self.fit + self._log_prior))

    def _within(self, entry: NDArray[np.intp], readings: NDArray[np.intp]) -> Real:
        """Half the decrease of ln det of the covariance of x and y, nat, (reading, entry)."""
        B, _ = self.predictive(entry, readings)
        T, V = self._along[entry][..., :2], self.latent_covariance[entry]
        before = np.eye(2) - np.einsum("erj,ers,esk->ejk", T, np.eye(T.shape[1]) - V, T)
        both = B @ V
        shared = both @ T
        read = both @ np.swapaxes(B, 2, 3) + np.eye(2)
        after = before - np.swapaxes(shared, 2, 3) @ np.linalg.solve(read, shared)
        return (np.linalg.slogdet(before)[1] - np.linalg.slogdet(after)[1]) / 2


def log_prior_of(localizer: ModelBasedPosition, unpressed: float) -> Real:
    """ln prior of the unpressed skin and of each cell of GRID, shape (1 + cell,).

    unpressed: prior of the unpressed skin.
    """
    by_cell = _by_cell(localizer.mixture.log_chance)
    with np.errstate(divide="ignore"):
        return np.append(np.log(unpressed), np.log1p(-unpressed) + by_cell)


def _with_unpressed(touched: Mixture) -> Mixture:
    """The mixture with an additional entry: the unpressed skin, which changes nothing."""

    def more(values: Real) -> Real:
        return np.concatenate([values, np.zeros((1, *values.shape[1:]))])

    return Mixture(
        *map(more, (touched.mean, touched.directions, touched.along, touched.log_weight))
    )


def _by_cell(of_entry: Real) -> Real:
    """ln of the sum over the strengths in each cell, (cell,)."""
    return np.asarray(logsumexp(of_entry.reshape(CELLS, GRID[2]), axis=1))


def _along(spread: Real, slopes: Real) -> Real:
    """Place and strength as functions of the latent variables, (entry, rank, 3).

    It solves slopes = B T, where the columns of B are orthogonal.
    """
    power = (spread**2).sum(axis=1)
    found = np.einsum("enr,enk->erk", spread, slopes) / np.maximum(power, 1e-12)[..., None]
    return np.where(power[..., None] > 1e-9, found, 0.0)
