"""Merits of candidates, concave in the weight of each candidate.

Information adds up over readings, minus what the session's errors may hide, which is a concave
function of the weights of the candidates. A merit (see `merits`) is concave in the information.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...arrays import Integer, Real
from .fisher_merits import AccuracyMerit, LowerTriangle, Merit, lower_triangle
from .pair_separation import Pairs

ACCURACY = AccuracyMerit()
MERIT_DIGITS = 6
"""Digits of a merit that are compared."""
NUMBERS_AT_ONCE = 4_000_000


@dataclass(frozen=True)
class SessionPrecision:
    """Prior 1/deviation² of the meter's gain and phase errors of a session, in units of noise.

    Infinite where these errors cancel.
    """

    gain: float = math.inf
    phase: float = math.inf

    @property
    def both(self) -> Real:
        """Both values, shape (2,)."""
        return np.array([self.gain, self.phase])


def by_reading(
    pairs: Pairs, session: SessionPrecision, merit: Merit = ACCURACY
) -> AdditiveCandidates:
    """Readings as candidates, each at all the frequencies of the pairs."""
    x, count = pairs.separation, pairs.separation.shape[2]
    found = np.einsum("prfqa,prfqb->prab", x, x, optimize=True)
    common = x.sum(axis=2)
    return AdditiveCandidates(
        found - _hidden_information(common, session.both + count), pairs.weight, merit
    )


def by_frequency(
    pairs: Pairs, session: SessionPrecision, merit: Merit = ACCURACY
) -> AdditiveCandidates | TiedFrequencies:
    """Frequencies as candidates, each for all the readings of the pairs."""
    if not math.isinf(session.gain) or not math.isinf(session.phase):
        return TiedFrequencies(pairs, session, merit)
    x = pairs.separation
    return AdditiveCandidates(
        np.einsum("prfqa,prfqb->pfab", x, x, optimize=True), pairs.weight, merit
    )


def by_both(pairs: Pairs, merit: Merit = ACCURACY) -> AdditiveCandidates:
    """Frequencies of single readings as candidates, ordered by reading; needs a baseline."""
    x = pairs.separation
    found = np.einsum("prfqa,prfqb->prfab", x, x, optimize=True)
    return AdditiveCandidates(found.reshape(len(x), -1, *found.shape[-2:]), pairs.weight, merit)


def _hidden_information(common: Real, prior: Real) -> Real:
    """Information that unknown gain and phase errors hide, shape (pair, reading, p, p)."""
    return np.einsum("prqa,prqb,q->prab", common, common, 1 / prior)


class AdditiveCandidates:
    """Candidates whose information adds up, shape (case, candidate, p, p), symmetric."""

    def __init__(self, information: Real, weight: Real, merit: Merit = ACCURACY) -> None:
        """weight: of each case, shape (case,)."""
        _, self.candidates, p, _ = information.shape
        self._merit, self._weight = merit, weight
        self._lower = np.tril_indices(p)
        self._place = np.empty((p, p), dtype=np.int64)
        """Index of each entry of a matrix in its lower triangle, shape (p, p)."""
        self._place[self._lower] = self._place.T[self._lower] = range(len(self._lower[0]))
        entries = information.transpose(2, 3, 1, 0)[self._lower]
        self._entries = np.ascontiguousarray(entries.swapaxes(0, 1)).reshape(self.candidates, -1)
        """Entries of the lower triangles of all cases, shape (candidate, entry * case)."""

    def score(self, choices: Integer) -> Real:
        """1 minus the merit of choices, shape (choice, n) to (choice,)."""
        step = max(1, NUMBERS_AT_ONCE // max(self._entries.shape[1], 1))
        parts = [choices[k : k + step] for k in range(0, len(choices), step)]
        return np.concatenate([self._score(part) for part in parts])

    def slope(self, weights: Real) -> tuple[float, Real]:
        """The merit at weights of the candidates, and its exact derivatives by them."""
        whole = np.moveaxis(self._at(weights)[self._place], -1, 0)
        result = self._merit(whole, self._weight)
        rows, columns = self._lower
        both = np.where(rows == columns, 1.0, 2.0)[:, None]
        by_entry = both * result.slope().transpose(1, 2, 0)[self._lower]
        return float(result.value), self._entries @ by_entry.ravel()

    def _score(self, choices: Integer) -> Real:
        times = np.zeros((len(choices), self.candidates))
        np.add.at(times, (np.arange(len(choices))[:, None], choices), 1.0)
        found = np.moveaxis(self._at(times), -2, 0)
        rows, columns = self._lower
        places = zip(rows.tolist(), columns.tolist(), strict=True)
        each: LowerTriangle = dict(zip(places, found, strict=True))
        return _remaining(self._merit.value(each, self._weight))

    def _at(self, weights: Real) -> Real:
        """Information at weights of the candidates, (..., candidate) to (..., entry, case)."""
        return (weights @ self._entries).reshape(*weights.shape[:-1], -1, len(self._weight))


class TiedFrequencies:
    """Frequencies of readings with unknown gain and phase errors that are common to all of them."""

    def __init__(self, pairs: Pairs, session: SessionPrecision, merit: Merit = ACCURACY) -> None:
        self.candidates, self._pairs, self._session = pairs.separation.shape[2], pairs, session
        self._merit = merit

    def score(self, choices: Integer) -> Real:
        """See `AdditiveCandidates`."""
        result = []
        for choice in choices:
            part = Pairs(self._pairs.separation[:, :, choice], self._pairs.weight)
            found, _ = self._information(part, np.ones(len(choice)))
            result.append(_remaining(self._merit.value(lower_triangle(found), part.weight)))
        return np.array(result)

    def slope(self, weights: Real) -> tuple[float, Real]:
        """See `AdditiveCandidates`."""
        found, common = self._information(self._pairs, weights)
        result = self._merit(found, self._pairs.weight)
        left = self._pairs.separation - common[:, :, None]
        by = np.einsum("prfqa,prfqb,pab->f", left, left, result.slope(), optimize=True)
        return float(result.value), by

    def _information(self, pairs: Pairs, weights: Real) -> tuple[Real, Real]:
        """Information without what the session's errors hide, and the mean over frequencies.

        The mean, weighted by the session's errors, has shape (pair, reading, 2, p).
        """
        x, prior = pairs.separation, self._session.both + weights.sum()
        weighed = x * weights[:, None, None]
        found = np.einsum("prfqa,prfqb->pab", weighed, x, optimize=True)
        common = weighed.sum(axis=2)
        found = found - _hidden_information(common, prior).sum(axis=1)
        return found, common / prior[:, None]


def _remaining(merit: Real) -> Real:
    """1 minus a merit, to be minimized, rounded to the digits that are compared."""
    return np.round(1 - merit, MERIT_DIGITS) + 10.0**-MERIT_DIGITS
