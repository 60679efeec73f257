"""Which candidates tell most: merits that are concave in how much each candidate is read.

Information adds up over readings, and the session's errors take off what they may hide: a concave
function of the weights of the candidates. A merit (see `merits`) is concave in the information.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .curves import Pairs
from .merits import Lower, Merit, Right, lower

RIGHT = Right()
SEEN = 6
"""Digits of a merit that count."""
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


def by_reading(pairs: Pairs, ties: Ties, merit: Merit = RIGHT) -> Additive:
    """Which readings tell, at all the frequencies of the pairs."""
    x, count = pairs.apart, pairs.apart.shape[2]
    found = np.einsum("prfqa,prfqb->prab", x, x, optimize=True)
    common = x.sum(axis=2)
    return Additive(found - _taken(common, ties.both + count), pairs.weight, merit)


def by_frequency(pairs: Pairs, ties: Ties, merit: Merit = RIGHT) -> Additive | Tied:
    """Which frequencies tell, for all the readings of the pairs together."""
    if not math.isinf(ties.gain) or not math.isinf(ties.turn):
        return Tied(pairs, ties, merit)
    x = pairs.apart
    return Additive(np.einsum("prfqa,prfqb->pfab", x, x, optimize=True), pairs.weight, merit)


def by_both(pairs: Pairs, merit: Merit = RIGHT) -> Additive:
    """Which frequencies of which readings tell, against rest; candidates reading by reading."""
    x = pairs.apart
    found = np.einsum("prfqa,prfqb->prfab", x, x, optimize=True)
    return Additive(found.reshape(len(x), -1, *found.shape[-2:]), pairs.weight, merit)


def _taken(common: NDArray[np.float64], held: NDArray[np.float64]) -> NDArray[np.float64]:
    """What gain and turn that are not known take off, shape (pair, reading, p, p)."""
    return np.einsum("prqa,prqb,q->prab", common, common, 1 / held)


class Additive:
    """Candidates whose information adds up: shape (case, candidate, p, p), symmetric."""

    def __init__(
        self, information: NDArray[np.float64], weight: NDArray[np.float64], merit: Merit = RIGHT
    ) -> None:
        """weight: of each case, shape (case,)."""
        _, self.candidates, p, _ = information.shape
        self._merit, self._weight = merit, weight
        self._lower = np.tril_indices(p)
        self._place = np.empty((p, p), dtype=np.int64)
        """Of each entry of a matrix, among those of its lower triangle."""
        self._place[self._lower] = self._place.T[self._lower] = range(len(self._lower[0]))
        entries = information.transpose(2, 3, 1, 0)[self._lower]
        self._entries = np.ascontiguousarray(entries.swapaxes(0, 1)).reshape(self.candidates, -1)
        """Of lower triangles, those of all cases side by side, shape (candidate, entry * case)."""

    def score(self, choices: NDArray[np.int64]) -> NDArray[np.float64]:
        """What is left of the merit, shape (choice, n) to (choice,)."""
        step = max(1, NUMBERS_AT_ONCE // max(self._entries.shape[1], 1))
        parts = [choices[k : k + step] for k in range(0, len(choices), step)]
        return np.concatenate([self._score(part) for part in parts])

    def slope(self, weights: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        """The merit at weights of the candidates, and its exact derivative by each."""
        whole = np.moveaxis(self._at(weights)[self._place], -1, 0)
        told = self._merit(whole, self._weight)
        rows, columns = self._lower
        both = np.where(rows == columns, 1.0, 2.0)[:, None]
        by_entry = both * told.slope().transpose(1, 2, 0)[self._lower]
        return float(told.value), self._entries @ by_entry.ravel()

    def _score(self, choices: NDArray[np.int64]) -> NDArray[np.float64]:
        times = np.zeros((len(choices), self.candidates))
        np.add.at(times, (np.arange(len(choices))[:, None], choices), 1.0)
        found = np.moveaxis(self._at(times), -2, 0)
        rows, columns = self._lower
        places = zip(rows.tolist(), columns.tolist(), strict=True)
        each: Lower = dict(zip(places, found, strict=True))
        return _left(self._merit.value(each, self._weight))

    def _at(self, weights: NDArray[np.float64]) -> NDArray[np.float64]:
        """Information at weights of the candidates, (..., candidate) to (..., entry, case)."""
        return (weights @ self._entries).reshape(*weights.shape[:-1], -1, len(self._weight))


class Tied:
    """Frequencies of readings whose gain and turn are alike at all of them, and not quite known."""

    def __init__(self, pairs: Pairs, ties: Ties, merit: Merit = RIGHT) -> None:
        self.candidates, self._pairs, self._ties = pairs.apart.shape[2], pairs, ties
        self._merit = merit

    def score(self, choices: NDArray[np.int64]) -> NDArray[np.float64]:
        """As of `Additive`."""
        told = []
        for choice in choices:
            part = Pairs(self._pairs.apart[:, :, choice], self._pairs.weight)
            found, _ = self._seen(part, np.ones(len(choice)))
            told.append(_left(self._merit.value(lower(found), part.weight)))
        return np.array(told)

    def slope(self, weights: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        """As of `Additive`."""
        found, common = self._seen(self._pairs, weights)
        told = self._merit(found, self._pairs.weight)
        left = self._pairs.apart - common[:, :, None]
        by = np.einsum("prfqa,prfqb,pab->f", left, left, told.slope(), optimize=True)
        return float(told.value), by

    def _seen(
        self, pairs: Pairs, weights: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Information, and what is common to all frequencies of a reading, (pair, reading, 2, p),
        as the session's errors hide it."""
        x, held = pairs.apart, self._ties.both + weights.sum()
        weighed = x * weights[:, None, None]
        found = np.einsum("prfqa,prfqb->pab", weighed, x, optimize=True)
        common = weighed.sum(axis=2)
        found = found - _taken(common, held).sum(axis=1)
        return found, common / held[:, None]


def _left(merit: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of a merit of 1 at most, that is to be small; what no judge would see of it is the same."""
    return np.round(1 - merit, SEEN) + 10.0**-SEEN
