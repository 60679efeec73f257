"""A mixture of normal distributions of low-rank spread: the prior of a model's readings.

Numbers are in units of the meter's noise, so that each entry is N(mean, 1 + B B'). The columns of B
are the effects of the unknowns: the exact strength or place within the entry, the skin, and the
model's own error.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from scipy.special import softmax

from ...simulator.arrays import Real
from ..parts.plain import Plain, Sizes, is_close, require

RANK = 8
"""Directions kept of each entry's spread."""
AT_ONCE = 2**22
"""Approximate count of numbers in memory at once."""


@dataclass(frozen=True, eq=False)
class Mixture(Plain):
    """Entries N(mean, (1 - G'G)^-1), each with its prior probability.

    mean: shape (entry, number). directions: G, shape (entry, rank, number). log_weight: logarithm
    of the probability times the normal distribution's constant without 2 pi, shape (entry,). along:
    G mean, shape (entry, rank).
    """

    mean: Annotated[Real, "E F"]
    directions: Annotated[Real, "E r F"]
    along: Annotated[Real, "E r"]
    log_weight: Annotated[Real, "E log"]

    def _check(self, sizes: Sizes) -> None:
        along = np.einsum("ern,en->er", self.directions, self.mean)
        require(is_close(self.along, along), "along", "must be of its `directions` and `mean`")

    @property
    def power(self) -> Real:
        """Variance in addition to the noise along each direction of spread, (entry, rank)."""
        shrunk = (self.directions**2).sum(axis=2)
        return shrunk / np.maximum(1 - shrunk, 1e-12)

    @property
    def spread(self) -> Real:
        """B, reduced to the stored rank, shape (entry, number, rank)."""
        return np.swapaxes(self.directions * np.sqrt(1 + self.power)[..., None], 1, 2)

    @property
    def log_chance(self) -> Real:
        """ln of the prior probability of each entry, shape (entry,)."""
        return self.log_weight + np.log1p(self.power).sum(axis=1) / 2

    def of(self, numbers: NDArray[np.intp]) -> Mixture:
        """The mixture restricted to some of the numbers."""
        return mixture(self.mean[:, numbers], self.spread[:, numbers], np.exp(self.log_chance))

    def distances(self, X: Real) -> Real:
        """Squared Mahalanobis distance of sweeps from entries, shape (sweep, entry)."""
        entries, rank, _ = self.directions.shape
        part = max(1, AT_ONCE // (entries * rank))
        flat = self.directions.reshape(entries * rank, -1)
        found = np.empty((len(X), entries))
        for start in range(0, len(X), part):
            x = X[start : start + part]
            off = (x**2).sum(axis=1)[:, None] - 2 * x @ self.mean.T + (self.mean**2).sum(axis=1)
            along = (x @ flat.T).reshape(len(x), entries, rank) - self.along
            found[start : start + part] = off - (along**2).sum(axis=2)
        return np.maximum(found, 0.0)

    def log_joint(self, distances: Real) -> Real:
        """ln of prior times density of sweeps at these distances, up to a constant."""
        return self.log_weight - distances / 2

    def responsibilities(self, distances: Real) -> Real:
        """Posterior probability of each entry, shape (sweep, entry)."""
        return softmax(self.log_joint(distances), axis=1)


def mixture(mean: Real, spread: Real, weight: Real) -> Mixture:
    """Entries N(mean, 1 + B B'). spread: B, shape (entry, number, column). weight: prior."""
    power, turn = np.linalg.eigh(np.swapaxes(spread, 1, 2) @ spread)
    power, turn = np.maximum(power[:, -RANK:], 0.0), turn[:, :, -RANK:]
    directions = np.swapaxes((spread @ turn) / np.sqrt(1 + power)[:, None], 1, 2)
    log_weight = np.log(weight) - np.log1p(power).sum(axis=1) / 2
    along = np.einsum("ern,en->er", directions, mean)
    return Mixture(mean, np.ascontiguousarray(directions), along, log_weight)


def joined(parts: list[Mixture]) -> Mixture:
    """The mixture of all entries of the parts, in order."""
    return Mixture(
        np.concatenate([part.mean for part in parts]),
        np.concatenate([part.directions for part in parts]),
        np.concatenate([part.along for part in parts]),
        np.concatenate([part.log_weight for part in parts]),
    )
