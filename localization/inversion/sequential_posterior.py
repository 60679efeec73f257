"""Posteriors of the class and of the place of a touch, updated reading by reading.

A posterior is a mixture; the readings that it expects tell the information of the next one.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp, ndtri, softmax

from ...simulator.arrays import Real
from .classifier import ModelBased, novelty_limit
from .hypotheses import Mixture
from .position import CELLS, GRID, ModelBasedPosition, Posterior
from .region import PlaceDistribution

DRAWS = 64
"""Number of samples that estimate gains."""


class SequentialPosterior:
    """Likelihood of each entry after the readings so far, each of ln |Z| and phase.

    noise: standard deviation of each number, (number,). significance: as `doubt` of `ModelBased`.
    latent_mean, latent_covariance: those of the unknowns in each entry, (entry, rank) and (entry,
    rank, rank). fit: ln likelihood of each entry up to a constant, (entry,). distance: squared
    distance from each entry, (entry,). used_readings: numbers of the readings so far.
    """

    def __init__(self, mixture: Mixture, noise: Real, significance: float) -> None:
        self._mean, self._spread, self._noise, self._significance = (
            mixture.mean,
            mixture.spread,
            noise,
            significance,
        )
        entries, rank = len(self._mean), self._spread.shape[2]
        self.latent_mean, self.latent_covariance = (
            np.zeros((entries, rank)),
            np.tile(np.eye(rank), (entries, 1, 1)),
        )
        self.fit, self.distance = np.zeros(entries), np.zeros(entries)
        self.used_readings: list[int] = []

    def update(self, reading: int, change: Real) -> None:
        """Update with a reading.

        reading: its number in the sweep. change: change of ln |Z| and phase from the baseline. The
        latent variables are updated by R. E. Kalman, J. Basic Eng. 82 (1960) 35-45, equations 21 to
        25.
        """
        numbers = self._numbers(reading)
        B, V = self._spread[:, numbers], self.latent_covariance
        off = change / self._noise[numbers] - self._mean[:, numbers]
        off -= np.einsum("enr,er->en", B, self.latent_mean)
        BV = B @ V
        covariance = BV @ np.swapaxes(B, 1, 2) + np.eye(2)
        weighed = np.linalg.solve(covariance, np.concatenate([BV, off[..., None]], axis=2))
        self.latent_mean = self.latent_mean + np.einsum("enr,en->er", BV, weighed[..., -1])
        self.latent_covariance = V - np.swapaxes(BV, 1, 2) @ weighed[..., :-1]
        squares = np.einsum("en,en->e", off, weighed[..., -1])
        self.distance = self.distance + squares
        self.fit = self.fit - (squares + np.linalg.slogdet(covariance)[1]) / 2
        self.used_readings.append(reading)

    @property
    def novelty_limit(self) -> float:
        """Squared distance beyond which the readings so far are novel."""
        return novelty_limit(self._significance, 2 * max(1, len(self.used_readings)))

    @property
    def just_novel(self) -> float:
        """ln likelihood of readings that are just novel to the best entry."""
        return float((self.fit + self.distance / 2).max() - self.novelty_limit / 2)

    @property
    def novel(self) -> bool:
        """True if the best fit to the readings so far exceeds what noise and skin allow."""
        return bool(self.distance.min() > self.novelty_limit)

    def predictive(
        self, entry: NDArray[np.intp], readings: NDArray[np.intp]
    ) -> tuple[NDArray, NDArray]:
        """Predictive distribution of further readings by entry: B and mean; covariance B V B' + 1.

        V is `latent_covariance`. Shapes (reading, entry, 2, rank) and (reading, entry, 2).
        """
        numbers = np.stack([self._numbers(each) for each in readings])
        B = np.moveaxis(self._spread[entry][:, numbers], 1, 0)
        mean = np.moveaxis(self._mean[entry][:, numbers], 1, 0)
        return B, mean + np.einsum("fenr,er->fen", B, self.latent_mean[entry])

    def expected_information(
        self,
        entry: NDArray[np.intp],
        share: Real,
        kind: NDArray[np.intp],
        readings: NDArray[np.intp],
    ) -> Real:
        """Information on the kind of entry that each further reading is expected to give, nat.

        It is the mutual information of kind and reading, estimated by DRAWS samples from these
        entries. share, kind: those of each entry, shape (entry,). The result has shape (reading,).
        """
        B, mean = self.predictive(entry, readings)
        root = np.linalg.cholesky(
            B @ self.latent_covariance[entry] @ np.swapaxes(B, 2, 3) + np.eye(2)
        )
        drawn = np.searchsorted(np.cumsum(share), (np.arange(DRAWS) + 0.5) / DRAWS)
        drawn = np.minimum(drawn, entry.size - 1)
        x = mean[:, drawn] + np.einsum("fdmn,dn->fdm", root[:, drawn], _normals(DRAWS))
        density = share * _density(x[:, :, None] - mean[:, None], root[:, None])
        same = kind[drawn][:, None] == kind
        own, chance = (density * same).sum(axis=2), (share * same).sum(axis=1)
        return np.log(own / (chance * density.sum(axis=2))).mean(axis=1)

    def _numbers(self, reading: int) -> NDArray[np.intp]:
        return np.array([reading, reading + self._mean.shape[1] // 2])


@cache
def _normals(count: int) -> Real:
    """Quasi-random draws of two normal numbers, the same at every call, shape (count, 2)."""
    from scipy.stats import qmc

    return ndtri(qmc.Sobol(2, scramble=True, rng=0).random(count))


def _density(off: NDArray, root: NDArray) -> Real:
    """Density of two normal numbers; root: lower Cholesky factor of the covariance. Shape (...)."""
    a, b, c = root[..., 0, 0], root[..., 1, 0], root[..., 1, 1]
    first = off[..., 0] / a
    second = (off[..., 1] - b * first) / c
    return np.exp(-(first**2 + second**2) / 2) / (2 * math.pi * a * c)


LIKELIEST = 64
"""Number of most likely entries that estimate gains."""


class ClassPosterior(SequentialPosterior):
    """Posterior of the class of one touch, from the tables of a localizer of classes.

    Noise and skin are as in its mixture. log_prior: ln of the prior of each class; by default the
    tables' own. sharpness: factor of the decisions.
    """

    def __init__(
        self, localizer: ModelBased, log_prior: Real | None = None, sharpness: float = 1.0
    ) -> None:
        mixture, chances = localizer.part(None)
        super().__init__(mixture, localizer.noise, localizer.doubt)
        self._answer, self._sharpness = localizer.answer, sharpness
        self._of_class = mixture.log_chance - chances[localizer.answer]
        self._log_prior = chances if log_prior is None else log_prior

    @property
    def log_densities(self) -> Real:
        """`ModelBased.log_densities` of the readings so far, (class + 1,)."""
        joint, count = self._of_class + self.fit, self._log_prior.size
        of_class = [float(np.logaddexp.reduce(joint[self._answer == k])) for k in range(count)]
        return np.append(of_class, self.just_novel)

    @property
    def probabilities(self) -> Real:
        """Probability of each class by the readings so far, shape (class,)."""
        joint = self._sharpness * self.log_densities[:-1] + self._log_prior
        return np.asarray(softmax(joint))

    def gains(self, readings: NDArray[np.intp]) -> Real:
        """Information on the class that each further reading is expected to give, nat, (reading,).

        It is estimated by the LIKELIEST entries, see `SequentialPosterior.expected_information`.
        """
        joint = self._of_class + self.fit + self._log_prior[self._answer]
        entry = np.sort(np.argsort(-joint, kind="stable")[:LIKELIEST])
        return self.expected_information(
            entry, softmax(joint[entry]), self._answer[entry], readings
        )


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
