"""What information is worth: two merits, 1 at most, and concave in it.

Right: of two presses, the distance of their readings at the strengths that hide it best is the
least of sums of squares, so it is concave in the information: d² = min over strengths. Phi(-d/2) of
all pairs, summed, is at least the share of errors of the best classifier of known strengths; it is
convex in d², so that the share right is concave.

Near: of a touch somewhere, x and y err by no less than Cramér and Rao's bound. 1 / (the trace of
its part for x and y) is concave in the information, and the root of that trace convex: the root
mean square of the distance, over that of a guess, is what is left of the merit.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

TINY = 1e-12
FARTHEST_STRENGTH = 10.0
"""Deviation of how strong a touch is before it is read, of the capacitance at rest."""


Lower = Mapping[tuple[int, int], NDArray[np.float64]]
"""Entries of symmetric matrices, each of shape (...), by row and column, row >= column."""


class Told(NamedTuple):
    """value: of the merit, shape (...). ways: shape (..., case, k, p), and coefficients, shape
    (..., case, k): the derivative by the information is the sum of coefficient times way way'."""

    value: NDArray[np.float64]
    ways: NDArray[np.float64]
    coefficients: NDArray[np.float64]

    def slope(self) -> NDArray[np.float64]:
        """By the information of each case, shape (..., case, p, p)."""
        weighed = self.ways * self.coefficients[..., None]
        return np.einsum("...ka,...kb->...ab", weighed, self.ways)


class Merit(Protocol):
    """From information (..., case, p, p) and the weight of each case (case,)."""

    def value(self, found: Lower, weight: NDArray[np.float64], /) -> NDArray:
        """The merit alone, shape (...), in a fraction of the time. found: entries (..., case)."""
        ...

    def __call__(self, found: NDArray[np.float64], weight: NDArray[np.float64], /) -> Told:
        """The merit and how it changes."""
        ...


def lower(found: NDArray[np.float64]) -> Lower:
    """Of matrices, shape (..., p, p)."""
    return {(a, b): found[..., a, b] for a in range(found.shape[-1]) for b in range(a + 1)}


def remaining(found: Lower, known: Sequence[float], kept: int) -> Lower:
    """Information of the first `kept` unknown where the others are known no closer than that.

    By elimination of one after the other (Schur's complements), of all cases at once. known: of
    each unknown beforehand.
    """
    left = {(a, b): entry + known[a] if a == b else entry for (a, b), entry in found.items()}
    for last in range(len(known) - 1, kept - 1, -1):
        for a in range(last):
            share = left[last, a] / left[last, last]
            for b in range(a + 1):
                left[a, b] = left[a, b] - share * left[last, b]
    return {place: left[place] for place in left if place[0] < kept}


@dataclass(frozen=True)
class Right:
    """The share of sweeps right, by pairs: unknown are 1, then strengths in their deviations."""

    def value(self, found: Lower, weight: NDArray[np.float64]) -> NDArray:
        """As of `Merit`."""
        strengths, _ = max(found)
        known = [0.0] + [1.0] * strengths
        squared = np.maximum(remaining(found, known, 1)[0, 0], 0.0)
        return 1 - ndtr(-np.sqrt(squared) / 2) @ weight

    def __call__(self, found: NDArray[np.float64], weight: NDArray[np.float64]) -> Told:
        """weight: what share of all sweeps is lost where a pair is always mistaken."""
        own = found + np.diag([0.0] + [1.0] * (found.shape[-1] - 1))
        way = np.ones(own.shape[:-1])
        if own.shape[-1] > 1:
            way[..., 1:] = -np.linalg.solve(own[..., 1:, 1:], own[..., 1:, :1])[..., 0]
        squared = np.maximum((own[..., 0, :] * way).sum(axis=-1), 0.0)
        value = 1 - ndtr(-np.sqrt(squared) / 2) @ weight
        d = np.sqrt(np.maximum(squared, TINY))
        by = weight * np.exp(-squared / 8) / (math.sqrt(2 * math.pi) * 4 * d)
        return Told(value, way[..., None, :], by[..., None])


@dataclass(frozen=True)
class Near:
    """How near touches are told; unknown are x, y in m and the strength. room: along x and y, m."""

    room: tuple[float, float]

    @property
    def guess(self) -> float:
        """Root mean square distance of a guess, m: what is left of the merit at 0."""
        return math.hypot(*self.room) / math.sqrt(12)

    @property
    def known(self) -> NDArray[np.float64]:
        """1/deviation² before anything is read, shape (3,)."""
        least = 1e-3 * max(self.room)
        sides = [12 / max(side, least) ** 2 for side in self.room]
        return np.array([*sides, FARTHEST_STRENGTH**-2])

    def value(self, found: Lower, weight: NDArray[np.float64]) -> NDArray:
        """As of `Merit`."""
        left = remaining(found, self.known.tolist(), 2)
        xx, xy, yy = left[0, 0], left[1, 0], left[1, 1]
        return 1 - np.sqrt((xx + yy) / (xx * yy - xy**2)) @ weight / self.guess

    def __call__(self, found: NDArray[np.float64], weight: NDArray[np.float64]) -> Told:
        """weight: of each place, 1 in all."""
        inverse = np.linalg.inv(found + np.diag(self.known))
        ways = inverse[..., :2, :].astype(np.float64)
        far = np.sqrt(ways[..., 0, 0] + ways[..., 1, 1])
        value = 1 - far @ weight / self.guess
        by = weight / (2 * far * self.guess)
        return Told(value, ways, np.repeat(by[..., None], 2, axis=-1))
