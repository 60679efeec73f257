"""Frequencies one at a time: what the readings so far tell, and which would tell most next."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import softmax
from scipy.stats import chi2, norm, qmc

from .classifier import ModelBased

LIKELIEST, DRAWS = 64, 64
"""Entries, and readings drawn of them, by which gains are reckoned."""


class Inquiry:
    """Of one touch, by the tables of a localizer of classes. Noise and skin are as in its mixture.

    log_prior: ln of the chance of each class; the tables' own without. sharpness: of decisions.
    """

    def __init__(
        self,
        localizer: ModelBased,
        log_prior: NDArray[np.float64] | None = None,
        sharpness: float = 1.0,
    ) -> None:
        mixture, chances = localizer.part(None)
        self._localizer, self._sharpness = localizer, sharpness
        self._mean, self._spread = mixture.mean, mixture.spread
        self._of_class = mixture.log_chance - chances[localizer.answer_]
        self._log_prior = chances if log_prior is None else log_prior
        entries, rank = len(self._mean), self._spread.shape[2]
        self._middle, self._left = np.zeros((entries, rank)), np.tile(np.eye(rank), (entries, 1, 1))
        self._fit, self._distance = np.zeros(entries), np.zeros(entries)
        self.told: list[int] = []

    def tell(self, reading: int, change: NDArray[np.float64]) -> None:
        """A reading: its number among those of a sweep; the changes of ln |Z| and phase it gave.

        What is unknown of strength and skin is known better after it, by R. E. Kalman, J. Basic
        Eng. 82 (1960) 35-45, equations 21 to 25.
        """
        numbers = self._numbers(reading)
        B, V = self._spread[:, numbers], self._left
        off = change / self._localizer.noise_[numbers] - self._mean[:, numbers]
        off -= np.einsum("enr,er->en", B, self._middle)
        BV = B @ V
        covariance = BV @ np.swapaxes(B, 1, 2) + np.eye(2)
        weighed = np.linalg.solve(covariance, np.concatenate([BV, off[..., None]], axis=2))
        self._middle = self._middle + np.einsum("enr,en->er", BV, weighed[..., -1])
        self._left = V - np.swapaxes(BV, 1, 2) @ weighed[..., :-1]
        squares = np.einsum("en,en->e", off, weighed[..., -1])
        self._distance = self._distance + squares
        self._fit = self._fit - (squares + np.linalg.slogdet(covariance)[1]) / 2
        self.told.append(reading)

    @property
    def log_densities(self) -> NDArray[np.float64]:
        """As of `ModelBased.log_densities` of the readings so far, (class + 1,)."""
        joint, count = self._of_class + self._fit, self._log_prior.size
        of_class = [
            float(np.logaddexp.reduce(joint[self._localizer.answer_ == k])) for k in range(count)
        ]
        return np.append(of_class, (self._fit + self._distance / 2).max() - self._edge / 2)

    @property
    def probabilities(self) -> NDArray[np.float64]:
        """Of each class, by the readings so far, shape (class,)."""
        joint = self._sharpness * self.log_densities[:-1] + self._log_prior
        return np.asarray(softmax(joint))

    @property
    def novel(self) -> bool:
        """Whether the best fit to the readings so far is beyond what noise and skin allow."""
        return bool(self._distance.min() > self._edge)

    def gains(self, readings: NDArray[np.intp]) -> NDArray[np.float64]:
        """Information on the class that each further reading is expected to give, nat, (reading,).

        The mutual information of class and reading, by DRAWS of it from the LIKELIEST entries.
        """
        entry, share = self._likeliest()
        numbers = np.stack([self._numbers(each) for each in readings])
        B = np.moveaxis(self._spread[entry][:, numbers], 1, 0)
        mean = np.moveaxis(self._mean[entry][:, numbers], 1, 0)
        mean = mean + np.einsum("fenr,er->fen", B, self._middle[entry])
        root = np.linalg.cholesky(B @ self._left[entry] @ np.swapaxes(B, 2, 3) + np.eye(2))
        drawn = np.searchsorted(np.cumsum(share), (np.arange(DRAWS) + 0.5) / DRAWS)
        drawn = np.minimum(drawn, entry.size - 1)
        x = mean[:, drawn] + np.einsum("fdmn,dn->fdm", root[:, drawn], _normals(DRAWS))
        density = share * _density(x[:, :, None] - mean[:, None], root[:, None])
        of_class = self._localizer.answer_[entry]
        same = of_class[drawn][:, None] == of_class
        own, chance = (density * same).sum(axis=2), (share * same).sum(axis=1)
        return np.log(own / (chance * density.sum(axis=2))).mean(axis=1)

    @property
    def _edge(self) -> float:
        return float(chi2.isf(self._localizer.doubt, 2 * max(1, len(self.told))))

    def _likeliest(self) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
        joint = self._of_class + self._fit + self._log_prior[self._localizer.answer_]
        entry = np.sort(np.argsort(-joint, kind="stable")[:LIKELIEST])
        return entry, np.asarray(softmax(joint[entry]))

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
