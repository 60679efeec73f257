"""How much of an error one order more shows: the error over the difference of two orders.

Where the field is smooth the next order takes nearly all of the error off; where it goes like
r^(1/2) at the end of a foil only four tenths, whatever the mesh. Z of order p is off by E = k D, D
its difference from order p + 1, and k hardly changes from mesh to mesh. So two meshes tell k, and
orders below tell it on one.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...fem.safety_factors import (
    FORESEEN,
    LEAST,
    MOST,
    MOST_BY_ORDERS,
    PARITY,
    TELLS,
    UNSEEN,
    VARIED,
)

Admittances = NDArray[np.complex128]


def smoothed(difference: NDArray[np.float64]) -> NDArray[np.float64]:
    """The first third of what is told at `frequencies_around`, never far below its neighbours.

    difference: shape (..., 3 f). Returns (..., f). What changes sign vanishes at one of the three
    frequencies; what grows with frequency does not: it is the mean of its neighbours.
    """
    here, below, above = np.split(difference, 3, axis=-1)
    return np.sqrt(here * np.maximum(here, np.sqrt(below * above)))


class ErrorHistory:
    """What one mesh after the other told of one press."""

    def __init__(self) -> None:
        self._told = dict[float, float]()
        self._frequency = np.empty(0)
        self._Y: tuple[Admittances, Admittances] | None = None
        self._largest = 0.0
        self._errors: list[float] = []
        self._unseen, self._most = UNSEEN, MOST
        self._foreseen = np.ones(1), np.full(1, np.inf)

    def foresees(self, frequency: NDArray[np.float64], k: NDArray[np.float64]) -> None:
        """k of the next mesh at some frequencies in Hz, ascending."""
        self._foreseen = frequency, k

    def meets(self, exponents: NDArray[np.float64], order: int) -> None:
        """Corners of those exponents, at which k may be more than elsewhere."""
        slowest = float(at_corners(exponents.min(initial=np.inf), order))
        self._unseen, self._most = max(UNSEEN, slowest), max(MOST, slowest)

    def lacks(self, rtol: float) -> float:
        """Times a tolerance that the latest error is; 1 before there is one."""
        return self._errors[-1] / rtol if self._errors else 1.0

    def reaches(self, rtol: float, meshes: int) -> bool:
        """Whether so many more meshes do for a tolerance, if each gains as much as the latest."""
        if len(self._errors) < 2:
            return True
        before, now = self._errors[-2:]
        return now * min(now / before, 1.0) ** meshes <= rtol

    def again(self) -> ErrorHistory:
        """Of another depth at the same place, whose k is much the same."""
        other = ErrorHistory()
        other._largest, other._unseen, other._most = self._largest, self._unseen, self._most
        return other

    def record(self, frequency: NDArray[np.float64], error: NDArray[np.float64]) -> None:
        """The relative error of the latest mesh, shape (..., frequency), at frequencies in Hz."""
        largest = error.reshape(-1, len(frequency)).max(axis=0)
        self._told = dict(zip(frequency.tolist(), largest.tolist(), strict=True))
        self._errors.append(float(largest.max()))

    def expected_at(self, frequency: NDArray[np.float64], likely: float) -> NDArray[np.float64]:
        """The same at some of these frequencies, the largest of all where none is told.

        likely: k of the next mesh, by which the error of a first one will be told anew.
        """
        largest = max(self._told.values())
        told = np.array([self._told.get(each, largest) for each in frequency.tolist()])
        return told if self._largest else told * np.clip(likely, LEAST, self._unseen) / self._unseen

    def effect(
        self, frequency: NDArray[np.float64], Z: Admittances, finer: Admittances
    ) -> NDArray[np.float64]:
        """k of this mesh, shape (frequency,). Z, finer: ohm, of two orders, at all
        `frequencies_around` those in Hz."""
        now = (1 / Z, 1 / finer)
        if self._Y is not None and np.isin(frequency, self._frequency).all():
            kept = np.flatnonzero(np.isin(self._frequency, frequency))
            before = (_in_thirds(each)[:, :, kept] for each in self._Y)
            self._largest = max(self._largest, _told(*before, *map(_in_thirds, now)))
        self._frequency, self._Y = frequency, now
        if not self._largest:
            return np.full(len(frequency), self._unseen)
        at, k = self._foreseen
        foreseen = FORESEEN * np.interp(np.log(frequency), np.log(at), k)
        return np.clip(np.minimum(self._largest, foreseen), LEAST, self._most)


def at_corners(exponents: NDArray[np.float64] | np.float64, order: int) -> NDArray[np.float64]:
    """k where the field goes like that power of the distance: D falls like order^(-4 power)."""
    return 1 / (1 - (order / (order + 1)) ** (4 * exponents))


def _in_thirds(Y: Admittances) -> Admittances:
    return Y.reshape(len(Y), 3, -1)


def _told(
    coarse: Admittances, fine: Admittances, next_coarse: Admittances, next_fine: Admittances
) -> float:
    """The largest k of all interfaces and frequencies; 0 where none tells. Y of two meshes, S."""
    shown = np.abs((coarse - fine) - (next_coarse - next_fine))
    tells = shown > TELLS * np.abs(coarse - fine)
    k = np.abs(coarse - next_coarse) / np.where(tells, shown, np.inf)
    return float(np.median(k, axis=1).max(initial=0.0))


def by_orders(order: int, steps: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Relative errors of Rs and Cp of that order, shape (2, interface, frequency), unsafe still.

    steps: D of that order from order + 1, of order - 1 from it and, where there is one, of order -
    2 from order - 1, all on one mesh. D falls like a power of the order, or faster.
    """
    latest, before, *first = (step.max(axis=0) for step in steps)
    gained = _ratio(before, latest)
    power = np.log(gained) / math.log(order / (order - 1)) - 1
    left = (order / (order + 1)) ** np.maximum(power, 0.0)
    k = np.minimum(1 / np.maximum(1 - left, 1 / MOST_BY_ORDERS), MOST_BY_ORDERS)
    if not first:
        return k * steps[0]
    odd = np.minimum(PARITY, 1 / _ratio(first[0], before))
    return np.maximum(k * steps[0], odd * steps[1] / VARIED)


def _ratio(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """a / b, at least 1; 1 where nothing tells."""
    return np.maximum(np.divide(a, b, out=np.ones_like(a), where=b > 0), 1.0)
