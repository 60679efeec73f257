"""Posterior of a mixture, updated reading by reading, and the readings that it expects."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from ...simulator.arrays import Real
from .classifier import novelty_limit
from .mixture import Mixture

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
