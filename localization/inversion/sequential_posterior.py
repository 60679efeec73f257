"""Readings one at a time: how likely each entry of a mixture is after them, and what it expects."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, norm, qmc

from .mixture import Mixture

DRAWS = 64
"""Readings that gains are reckoned by."""


class Readings:
    """What the readings so far tell of each entry; numbers of a reading are ln |Z| and phase.

    noise: deviation of each number, (number,). doubt: as of `ModelBased`. middle, left: mean and
    covariance of what is unknown in each entry, (entry, rank) and (entry, rank, rank). fit: ln
    likelihood of each entry but for a constant, (entry,). distance: squared, (entry,). told:
    readings so far, by number.
    """

    def __init__(self, mixture: Mixture, noise: NDArray[np.float64], doubt: float) -> None:
        self._mean, self._spread, self._noise, self._doubt = (
            mixture.mean,
            mixture.spread,
            noise,
            doubt,
        )
        entries, rank = len(self._mean), self._spread.shape[2]
        self.middle, self.left = np.zeros((entries, rank)), np.tile(np.eye(rank), (entries, 1, 1))
        self.fit, self.distance = np.zeros(entries), np.zeros(entries)
        self.told: list[int] = []

    def tell(self, reading: int, change: NDArray[np.float64]) -> None:
        """A reading: its number among those of a sweep; the changes of ln |Z| and phase it gave.

        What is unknown of strength and skin is known better after it, by R. E. Kalman, J. Basic
        Eng. 82 (1960) 35-45, equations 21 to 25.
        """
        numbers = self._numbers(reading)
        B, V = self._spread[:, numbers], self.left
        off = change / self._noise[numbers] - self._mean[:, numbers]
        off -= np.einsum("enr,er->en", B, self.middle)
        BV = B @ V
        covariance = BV @ np.swapaxes(B, 1, 2) + np.eye(2)
        weighed = np.linalg.solve(covariance, np.concatenate([BV, off[..., None]], axis=2))
        self.middle = self.middle + np.einsum("enr,en->er", BV, weighed[..., -1])
        self.left = V - np.swapaxes(BV, 1, 2) @ weighed[..., :-1]
        squares = np.einsum("en,en->e", off, weighed[..., -1])
        self.distance = self.distance + squares
        self.fit = self.fit - (squares + np.linalg.slogdet(covariance)[1]) / 2
        self.told.append(reading)

    @property
    def edge(self) -> float:
        """Squared distance beyond which the readings so far are novel."""
        return float(chi2.isf(self._doubt, 2 * max(1, len(self.told))))

    @property
    def just_novel(self) -> float:
        """ln likelihood of readings that are just novel to the entry that knows most."""
        return float((self.fit + self.distance / 2).max() - self.edge / 2)

    @property
    def novel(self) -> bool:
        """Whether the best fit to the readings so far is beyond what noise and skin allow."""
        return bool(self.distance.min() > self.edge)

    def ahead(self, entry: NDArray[np.intp], readings: NDArray[np.intp]) -> tuple[NDArray, NDArray]:
        """What entries expect of further readings: B and means; their covariance is B left B' + 1.

        Shapes (reading, entry, 2, rank) and (reading, entry, 2).
        """
        numbers = np.stack([self._numbers(each) for each in readings])
        B = np.moveaxis(self._spread[entry][:, numbers], 1, 0)
        mean = np.moveaxis(self._mean[entry][:, numbers], 1, 0)
        return B, mean + np.einsum("fenr,er->fen", B, self.middle[entry])

    def told_apart(
        self,
        entry: NDArray[np.intp],
        share: NDArray[np.float64],
        kind: NDArray[np.intp],
        readings: NDArray[np.intp],
    ) -> NDArray[np.float64]:
        """Information on the kind of entry that each further reading is expected to give, nat.

        The mutual information of kind and reading, by DRAWS of it from these entries. share: of
        each entry, kind: of each, shape (entry,). Shape (reading,).
        """
        B, mean = self.ahead(entry, readings)
        root = np.linalg.cholesky(B @ self.left[entry] @ np.swapaxes(B, 2, 3) + np.eye(2))
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
def _normals(count: int) -> NDArray[np.float64]:
    """Evenly spread draws of two normal numbers, the same at every call, shape (count, 2)."""
    return norm.ppf(qmc.Sobol(2, scramble=True, rng=0).random(count))


def _density(off: NDArray, root: NDArray) -> NDArray[np.float64]:
    """Of two normal numbers with a covariance of this lower root, shape (...)."""
    a, b, c = root[..., 0, 0], root[..., 1, 0], root[..., 1, 1]
    first = off[..., 0] / a
    second = (off[..., 1] - b * first) / c
    return np.exp(-(first**2 + second**2) / 2) / (2 * math.pi * a * c)
