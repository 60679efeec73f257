"""A share of sweeps told right, from pairs alone: concave in how much each candidate is read.

Of two presses, the distance of their readings at the strengths that hide it best is the least of
sums of squares, so it is concave in the weights w of the readings: d²(w) = min over strengths and
the session's errors. Phi(-d/2) of all pairs, summed, is at least the share of errors of the best
classifier of known strengths; it is convex in d², so that the share right is concave in w.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from .curves import Pairs

TINY = 1e-12
SEEN = 6
"""Digits of a share that count."""
NUMBERS_AT_ONCE = 4_000_000


@dataclass(frozen=True)
class Ties:
    """How closely the meter's errors of a session are known: 1/deviation² of gain and turn, in
    units of the noise; infinite where they drop out."""

    gain: float = math.inf
    turn: float = math.inf

    @property
    def both(self) -> NDArray[np.float64]:
        """Shape (2,)."""
        return np.array([self.gain, self.turn])


def share(squared: NDArray[np.float64], weight: NDArray[np.float64]) -> NDArray[np.float64]:
    """Told right; squared: distances of pairs, shape (..., pair). weight: see `Pairs`."""
    return 1 - ndtr(-np.sqrt(squared) / 2) @ weight


def squared_distances(found: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray]:
    """d² from the information of differences and strengths, shape (..., p, p) to (...); and
    (1, the strengths that hide it best), shape (..., p)."""
    way = np.ones((*found.shape[:-1], 1))[..., 0]
    if found.shape[-1] > 1:
        way[..., 1:] = -np.linalg.solve(found[..., 1:, 1:], found[..., 1:, :1])[..., 0]
    squared = (found[..., 0, :] * way).sum(axis=-1)
    return np.maximum(squared, 0.0), way


def by_reading(pairs: Pairs, ties: Ties) -> Additive:
    """Which readings tell, at all the frequencies of the pairs."""
    x, count = pairs.apart, pairs.apart.shape[2]
    found = np.einsum("prfqa,prfqb->prab", x, x, optimize=True)
    common = x.sum(axis=2)
    return Additive(found - _taken(common, ties.both + count), pairs.weight)


def by_frequency(pairs: Pairs, ties: Ties) -> Additive | Tied:
    """Which frequencies tell, for all the readings of the pairs together."""
    if not math.isinf(ties.gain) or not math.isinf(ties.turn):
        return Tied(pairs, ties)
    x = pairs.apart
    return Additive(np.einsum("prfqa,prfqb->pfab", x, x, optimize=True), pairs.weight)


def _taken(common: NDArray[np.float64], held: NDArray[np.float64]) -> NDArray[np.float64]:
    """What gain and turn that are not known take off, shape (pair, reading, p, p)."""
    return np.einsum("prqa,prqb,q->prab", common, common, 1 / held)


class Additive:
    """Candidates whose information adds up: shape (pair, candidate, p, p)."""

    def __init__(self, information: NDArray[np.float64], weight: NDArray[np.float64]) -> None:
        self.candidates, self._information, self._weight = information.shape[1], information, weight
        self._strengths = np.diag([0.0] + [1.0] * (information.shape[-1] - 1))

    def score(self, choices: NDArray[np.int64]) -> NDArray[np.float64]:
        """The share told wrong, shape (choice, n) to (choice,)."""
        size = len(self._weight) * self._strengths.size
        step = max(1, NUMBERS_AT_ONCE // max(size, 1))
        parts = [choices[k : k + step] for k in range(0, len(choices), step)]
        return np.concatenate([self._score(part) for part in parts])

    def slope(self, weights: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        """The share at weights of the candidates, and its exact derivative by each."""
        found = np.einsum("pnab,n->pab", self._information, weights, optimize=True)
        squared, way = squared_distances(found + self._strengths)
        by = np.einsum("pnab,pa,pb->pn", self._information, way, way, optimize=True)
        value = float(share(squared, self._weight))
        return value, _by_squared(squared, self._weight) @ by

    def _score(self, choices: NDArray[np.int64]) -> NDArray[np.float64]:
        times = np.zeros((len(choices), self.candidates))
        np.add.at(times, (np.arange(len(choices))[:, None], choices), 1.0)
        total = np.tensordot(times, self._information, axes=(1, 1)) + self._strengths
        squared, _ = squared_distances(total)
        return _wrong(share(squared, self._weight))


class Tied:
    """Frequencies of readings whose gain and turn are alike at all of them, and not quite known."""

    def __init__(self, pairs: Pairs, ties: Ties) -> None:
        self.candidates, self._pairs, self._ties = pairs.apart.shape[2], pairs, ties

    def score(self, choices: NDArray[np.int64]) -> NDArray[np.float64]:
        """As of `Additive`."""
        told = []
        for choice in choices:
            part = Pairs(self._pairs.apart[:, :, choice], self._pairs.weight)
            squared, *_ = self._seen(part, np.ones(len(choice)))
            told.append(_wrong(share(squared, part.weight)))
        return np.array(told)

    def slope(self, weights: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        """As of `Additive`."""
        squared, way, common = self._seen(self._pairs, weights)
        left = np.einsum("prfqa,pa->prfq", self._pairs.apart, way)
        left = left - np.einsum("prqa,pa->prq", common, way)[:, :, None]
        weight = self._pairs.weight
        by = np.einsum("prfq,p->f", left**2, _by_squared(squared, weight))
        return float(share(squared, weight)), by

    def _seen(
        self, pairs: Pairs, weights: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """d², the way to it, and the session's errors that hide most, (pair, reading, 2, p)."""
        x, held = pairs.apart, self._ties.both + weights.sum()
        weighed = x * weights[:, None, None]
        found = np.einsum("prfqa,prfqb->pab", weighed, x, optimize=True)
        common = weighed.sum(axis=2)
        found = found - _taken(common, held).sum(axis=1)
        strengths = np.arange(1, x.shape[-1])
        found[:, strengths, strengths] += 1.0
        squared, way = squared_distances(found)
        return squared, way, common / held[:, None]


def _wrong(right: NDArray[np.float64]) -> NDArray[np.float64]:
    """A share that is to be small; what no judge would see of it is the same."""
    return np.round(1 - right, SEEN) + 10.0**-SEEN


def _by_squared(squared: NDArray[np.float64], weight: NDArray[np.float64]) -> NDArray[np.float64]:
    """Derivative of the share by each d², shape (pair,)."""
    d = np.sqrt(np.maximum(squared, TINY))
    return weight * np.exp(-squared / 8) / (math.sqrt(2 * math.pi) * 4 * d)
