"""Two merits of Fisher information, at most 1 and concave in the information.

Accuracy: the squared distance d² of the readings of two presses is the minimum of sums of squares
over their strengths, so it is concave in the information. The sum of Phi(-d/2) over all pairs is at
least the error of the best classifier of known strengths. It is convex in d², so the share of
correct answers is concave.

Position: the errors of x and y of a touch are at least Cramér and Rao's bound. 1 / (the trace of
its part for x and y) is concave in the information, and the root of that trace is convex. The merit
is 1 minus this root mean square distance over that of a guess.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from ...arrays import Real

TINY = 1e-12
FARTHEST_STRENGTH = 10.0
"""Prior standard deviation of a touch's strength, over the unpressed capacitance."""


LowerTriangle = Mapping[tuple[int, int], Real]
"""Entries of symmetric matrices by (row, column), row >= column, each of shape (...)."""


class MeritValue(NamedTuple):
    """A merit and its derivative by the information, as a sum of weighted outer products.

    value: shape (...). vectors: w, shape (..., case, k, p). coefficients: c, shape
    (..., case, k). The derivative is the sum of c w w'.
    """

    value: Real
    vectors: Real
    coefficients: Real

    def slope(self) -> Real:
        """Derivative by the information of each case, shape (..., case, p, p)."""
        weighed = self.vectors * self.coefficients[..., None]
        return np.einsum("...ka,...kb->...ab", weighed, self.vectors)


class Merit(Protocol):
    """Function of the information (..., case, p, p) and the weight of each case (case,)."""

    def value(self, found: LowerTriangle, weight: Real, /) -> NDArray:
        """The merit without its derivative, shape (...), which is faster. Entries: (..., case)."""
        ...

    def __call__(self, found: Real, weight: Real, /) -> MeritValue:
        """The merit and its derivative."""
        ...


def lower_triangle(found: Real) -> LowerTriangle:
    """Lower triangle of matrices of shape (..., p, p)."""
    return {(a, b): found[..., a, b] for a in range(found.shape[-1]) for b in range(a + 1)}


def remaining(found: LowerTriangle, known: Sequence[float], kept: int) -> LowerTriangle:
    """Information on the first `kept` unknowns, with the others marginalized.

    Eliminates the others one by one (Schur complements), for all cases at once. known: prior
    information on each unknown.
    """
    left = {(a, b): entry + known[a] if a == b else entry for (a, b), entry in found.items()}
    for last in range(len(known) - 1, kept - 1, -1):
        for a in range(last):
            share = left[last, a] / left[last, last]
            for b in range(a + 1):
                left[a, b] = left[a, b] - share * left[last, b]
    return {place: left[place] for place in left if place[0] < kept}


@dataclass(frozen=True)
class AccuracyMerit:
    """Share of correct sweeps, by pairs.

    Row 0 of the information is the difference of a pair, the others are its strengths in standard
    deviations.
    """

    def value(self, found: LowerTriangle, weight: Real) -> NDArray:
        """See `Merit`."""
        strengths, _ = max(found)
        known = [0.0] + [1.0] * strengths
        squared = np.maximum(remaining(found, known, 1)[0, 0], 0.0)
        return 1 - ndtr(-np.sqrt(squared) / 2) @ weight

    def __call__(self, found: Real, weight: Real) -> MeritValue:
        """weight: share of all sweeps that is wrong if a pair is always confused."""
        own = found + np.diag([0.0] + [1.0] * (found.shape[-1] - 1))
        direction = np.ones(own.shape[:-1])
        if own.shape[-1] > 1:
            direction[..., 1:] = -np.linalg.solve(own[..., 1:, 1:], own[..., 1:, :1])[..., 0]
        squared = np.maximum((own[..., 0, :] * direction).sum(axis=-1), 0.0)
        value = 1 - ndtr(-np.sqrt(squared) / 2) @ weight
        d = np.sqrt(np.maximum(squared, TINY))
        by = weight * np.exp(-squared / 8) / (math.sqrt(2 * math.pi) * 4 * d)
        return MeritValue(value, direction[..., None, :], by[..., None])


@dataclass(frozen=True)
class PositionMerit:
    """Precision of positions; the unknowns are x, y in m and the strength.

    room: range of positions along x and y, m.
    """

    room: tuple[float, float]

    @property
    def guess(self) -> float:
        """Root mean square distance of a guess, m, at which the merit is 0."""
        return math.hypot(*self.room) / math.sqrt(12)

    @property
    def known(self) -> Real:
        """Prior 1/deviation² of x, y and strength, shape (3,)."""
        smallest = 1e-3 * max(self.room)
        sides = [12 / max(side, smallest) ** 2 for side in self.room]
        return np.array([*sides, FARTHEST_STRENGTH**-2])

    def value(self, found: LowerTriangle, weight: Real) -> NDArray:
        """See `Merit`."""
        left = remaining(found, self.known.tolist(), 2)
        xx, xy, yy = left[0, 0], left[1, 0], left[1, 1]
        return 1 - np.sqrt((xx + yy) / (xx * yy - xy**2)) @ weight / self.guess

    def __call__(self, found: Real, weight: Real) -> MeritValue:
        """weight: of each position, 1 in total."""
        inverse = np.linalg.inv(found + np.diag(self.known))
        vectors = inverse[..., :2, :].astype(np.float64)
        far = np.sqrt(vectors[..., 0, 0] + vectors[..., 1, 1])
        value = 1 - far @ weight / self.guess
        by = weight / (2 * far * self.guess)
        return MeritValue(value, vectors, np.repeat(by[..., None], 2, axis=-1))
