"""Goals of a choice of readings, as functions of the information on each case.

Those of `limits` are figures that are minimized: the root mean square error of positions, and the
distance of the nearest two presses. Those of `design` are merits, at most 1 and concave in the
information, so that a merit is concave in the weight of each candidate.

Accuracy: the squared distance d² of the readings of two presses is the minimum of sums of squares
over their strengths, so it is concave in the information. The sum of Phi(-d/2) over all pairs is at
least the error of the best classifier of known strengths. It is convex in d², so the share of
correct answers is concave.

Position: the errors of x and y of a touch are at least Cramér and Rao's bound. 1 / (the trace of
its part for x and y) is concave in the information, and the root of that trace is convex. The merit
is 1 minus this root mean square distance over that of a guess.

Information adds up over readings, minus what the session's errors may hide, which is a concave
function of the weights of the candidates.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.special import ndtr

from ..arrays import Integer, Mask, Real
from .likelihood import LowerTriangle, SummedInformation, remaining, variances


class Goal(Protocol):
    """What a choice of candidates is best for."""

    def score(self, found: LowerTriangle, weight: Real, /) -> Real:
        """The minimized figure of choices, shape (choice,).

        found: information with priors, entries (choice, case). weight: of each case, (case,).
        """
        ...


class Candidates:
    """Candidates for a choice, and the goal that it is best for."""

    def __init__(self, information: SummedInformation, weight: Real, goal: Goal) -> None:
        """weight: of each case, shape (case,)."""
        self._information, self._weight, self._goal = information, weight, goal
        self.count = information.candidates

    def score(self, choices: Integer) -> Real:
        """Minimized figures of choices of candidates, shape (choice, n) to (choice,)."""
        parts = self._information.of(choices)
        return np.concatenate([self._goal.score(each, self._weight) for each in parts])

    def slope(self, weights: Real) -> tuple[float, Real]:
        """The merit at weights of the candidates, and its exact derivatives by them."""
        assert isinstance(self._goal, Merit)
        value, by = self._goal(self._information.at(weights), self._weight)
        return float(value), self._information.slope(weights, by)


NO_ROOM = 1e-30
"""m²: prior variance of a coordinate that is known."""


@dataclass(frozen=True)
class RmsError:
    """Root mean square error of positions, m; the first unknowns are x and y in m.

    resolved: coordinates that count, shape (case, 2). anywhere: variance of each coordinate without
    a sweep, m².
    """

    resolved: Mask
    anywhere: Real

    def score(self, found: LowerTriangle, weight: Real) -> Real:
        """See `Goal`; all cases count alike."""
        known = 1 / variances(found, 2) + 1 / np.maximum(self.anywhere, NO_ROOM)
        squares = (self.resolved / known).sum(axis=(-1, -2))
        return np.sqrt(squares / self.resolved.any(axis=-1).sum())


@dataclass(frozen=True)
class NearestPair:
    """Inverse distance of the nearest pair, whose difference is the first unknown."""

    def score(self, found: LowerTriangle, weight: Real) -> Real:
        """See `Goal`; all cases count alike."""
        return np.sqrt(variances(found, 1)[..., 0].max(axis=-1))


TINY = 1e-12
FARTHEST_STRENGTH = 10.0
"""Prior standard deviation of a touch's strength, over the unpressed capacitance."""
MERIT_DIGITS = 6
"""Digits of a merit that are compared."""


class Merit(ABC):
    """A goal with derivatives: function of the information with priors and the cases' weights."""

    @abstractmethod
    def value(self, found: LowerTriangle, weight: Real, /) -> Real:
        """The merit without its derivative, shape (...), which is faster. Entries: (..., case)."""

    @abstractmethod
    def __call__(self, found: Real, weight: Real, /) -> tuple[Real, Real]:
        """The merit at information (..., case, p, p), and its derivative by that."""

    def score(self, found: LowerTriangle, weight: Real, /) -> Real:
        """1 minus the merit, rounded to the digits that are compared."""
        return np.round(1 - self.value(found, weight), MERIT_DIGITS) + 10.0**-MERIT_DIGITS


class AccuracyMerit(Merit):
    """Share of correct sweeps, by pairs.

    The first unknown is the difference of a pair, the others are its strengths. weight: share of
    all sweeps that is wrong if a pair is always confused.
    """

    def value(self, found: LowerTriangle, weight: Real) -> Real:
        """See `Merit`."""
        squared = np.maximum(remaining(found, 1)[0, 0], 0.0)
        return 1 - ndtr(-np.sqrt(squared) / 2) @ weight

    def __call__(self, found: Real, weight: Real) -> tuple[Real, Real]:
        """See `Merit`."""
        direction = np.ones(found.shape[:-1])
        if found.shape[-1] > 1:
            direction[..., 1:] = -np.linalg.solve(found[..., 1:, 1:], found[..., 1:, :1])[..., 0]
        squared = np.maximum((found[..., 0, :] * direction).sum(axis=-1), 0.0)
        value = 1 - ndtr(-np.sqrt(squared) / 2) @ weight
        d = np.sqrt(np.maximum(squared, TINY))
        by = weight * np.exp(-squared / 8) / (math.sqrt(2 * math.pi) * 4 * d)
        return value, by[..., None, None] * direction[..., None] * direction[..., None, :]


@dataclass(frozen=True)
class PositionMerit(Merit):
    """Precision of positions; the unknowns are x, y in m and the strength.

    room: range of positions along x and y, m.
    """

    room: tuple[float, float]

    @property
    def guess(self) -> float:
        """Root mean square distance of a guess, m, at which the merit is 0."""
        return math.hypot(*self.room) / math.sqrt(12)

    @property
    def prior(self) -> Real:
        """Prior 1/deviation² of x, y and strength, shape (3,)."""
        smallest = 1e-3 * max(self.room)
        sides = [12 / max(side, smallest) ** 2 for side in self.room]
        return np.array([*sides, FARTHEST_STRENGTH**-2])

    def value(self, found: LowerTriangle, weight: Real) -> Real:
        """See `Merit`."""
        left = remaining(found, 2)
        xx, xy, yy = left[0, 0], left[1, 0], left[1, 1]
        return 1 - np.sqrt((xx + yy) / (xx * yy - xy**2)) @ weight / self.guess

    def __call__(self, found: Real, weight: Real) -> tuple[Real, Real]:
        """weight: of each position, 1 in total."""
        to_both = np.linalg.inv(found)[..., :2, :]
        far = np.sqrt(to_both[..., 0, 0] + to_both[..., 1, 1])
        by = weight / (2 * far * self.guess)
        squares = np.einsum("...ka,...kb->...ab", to_both, to_both)
        return 1 - far @ weight / self.guess, by[..., None, None] * squares
