"""Ratio k of an error to the difference of two orders, estimated from a sequence of meshes.

Where the field is smooth, the next order removes nearly all of the error. Where the field varies as
r^(1/2), at the end of a foil, the next order removes only 40 % of the error, on any mesh. Z of
order p has the error E = k D, with D its difference from order p + 1. k hardly changes from mesh to
mesh, so two meshes give k; on one mesh lower orders give it.
"""

from __future__ import annotations

import math

import numpy as np

from ...arrays import Complex, Real
from ...fem.error_estimate import (
    FIRST_MESH,
    MAX_FACTOR,
    MAX_FACTOR_BY_ORDERS,
    MIN_DECREASE,
    MIN_FACTOR,
    PARITY,
    PREDICTED,
    VARIED,
)

Admittances = Complex


def smoothed(difference: Real) -> Real:
    """Difference at the first third of `frequencies_around`, smoothed over its neighbours.

    difference: shape (..., 3 f). Returns (..., f). A difference that changes sign vanishes at one
    of the three frequencies; the result is then its geometric mean with its neighbours. A
    difference that is a power of frequency stays as it is.
    """
    here, below, above = np.split(difference, 3, axis=-1)
    return np.sqrt(here * np.maximum(here, np.sqrt(below * above)))


class ErrorHistory:
    """Estimated errors of one press on one mesh after the other, and the k that follow from
    them."""

    def __init__(self) -> None:
        self._recorded = dict[float, float]()
        self._frequency = np.empty(0)
        self._Y: tuple[Admittances, Admittances] | None = None
        self._largest = 0.0
        self._errors: list[float] = []
        self._unseen, self._most = FIRST_MESH, MAX_FACTOR
        self._foreseen = np.ones(1), np.full(1, np.inf)

    def predict(self, frequency: Real, k: Real) -> None:
        """Set the predicted k of the next mesh at some frequencies in Hz, ascending."""
        self._foreseen = frequency, k

    def account_for_corners(self, exponents: Real, order: int) -> None:
        """Raise the bounds of k for corners with these exponents."""
        slowest = float(at_corners(exponents.min(initial=np.inf), order))
        self._unseen, self._most = max(FIRST_MESH, slowest), max(MAX_FACTOR, slowest)

    def relative_error(self, rtol: float) -> float:
        """Latest error over the tolerance; 1 before the first error."""
        return self._errors[-1] / rtol if self._errors else 1.0

    def will_reach(self, rtol: float, meshes: int) -> bool:
        """True if `meshes` more meshes reach the tolerance, each with the gain of the latest."""
        if len(self._errors) < 2:
            return True
        before, now = self._errors[-2:]
        return now * min(now / before, 1.0) ** meshes <= rtol

    def for_other_depth(self) -> ErrorHistory:
        """New history for another depth at the same place, which keeps the estimated k."""
        other = ErrorHistory()
        other._largest, other._unseen, other._most = self._largest, self._unseen, self._most
        return other

    def record(self, frequency: Real, error: Real) -> None:
        """Add the relative error of the latest mesh, shape (..., frequency), at frequencies in
        Hz."""
        largest = error.reshape(-1, len(frequency)).max(axis=0)
        self._recorded = dict(zip(frequency.tolist(), largest.tolist(), strict=True))
        self._errors.append(float(largest.max()))

    def expected_at(self, frequency: Real, likely: float) -> Real:
        """Latest estimated error at the given frequencies; the maximum over all where one is
        missing.

        likely: predicted k of the next mesh; it corrects the error of a first mesh.
        """
        largest = max(self._recorded.values())
        error = np.array([self._recorded.get(each, largest) for each in frequency.tolist()])
        return (
            error
            if self._largest
            else error * np.clip(likely, MIN_FACTOR, self._unseen) / self._unseen
        )

    def effect(self, frequency: Real, Z: Admittances, finer: Admittances) -> Real:
        """k of this mesh, shape (frequency,).

        Z, finer: ohm, of two orders, at all `frequencies_around` the frequencies in Hz.
        """
        now = (1 / Z, 1 / finer)
        if self._Y is not None and np.isin(frequency, self._frequency).all():
            kept = np.flatnonzero(np.isin(self._frequency, frequency))
            before = (_in_thirds(each)[:, :, kept] for each in self._Y)
            self._largest = max(self._largest, _largest_ratio(*before, *map(_in_thirds, now)))
        self._frequency, self._Y = frequency, now
        if not self._largest:
            return np.full(len(frequency), self._unseen)
        at, k = self._foreseen
        foreseen = PREDICTED * np.interp(np.log(frequency), np.log(at), k)
        return np.clip(np.minimum(self._largest, foreseen), MIN_FACTOR, self._most)


def at_corners(exponents: Real | np.float64, order: int) -> Real:
    """k where the field varies as a power of the distance: D falls as order^(-4 power)."""
    return 1 / (1 - (order / (order + 1)) ** (4 * exponents))


def _in_thirds(Y: Admittances) -> Admittances:
    return Y.reshape(len(Y), 3, -1)


def _largest_ratio(
    coarse: Admittances, fine: Admittances, next_coarse: Admittances, next_fine: Admittances
) -> float:
    """Largest k of all interfaces and frequencies; 0 if none can be estimated. Y of two meshes,
    S."""
    shown = np.abs((coarse - fine) - (next_coarse - next_fine))
    usable = shown > MIN_DECREASE * np.abs(coarse - fine)
    k = np.abs(coarse - next_coarse) / np.where(usable, shown, np.inf)
    return float(np.median(k, axis=1).max(initial=0.0))


def by_orders(order: int, steps: list[Real]) -> Real:
    """Relative errors of Rs and Cp, shape (2, interface, frequency), without safety factor.

    steps: differences between neighbouring orders on one mesh: of `order` and order + 1, of order -
    1 and `order` and, optionally, of order - 2 and order - 1. They fall at least as a power of the
    order.
    """
    latest, before, *first = (step.max(axis=0) for step in steps)
    gained = _ratio(before, latest)
    power = np.log(gained) / math.log(order / (order - 1)) - 1
    left = (order / (order + 1)) ** np.maximum(power, 0.0)
    k = np.minimum(1 / np.maximum(1 - left, 1 / MAX_FACTOR_BY_ORDERS), MAX_FACTOR_BY_ORDERS)
    if not first:
        return k * steps[0]
    odd = np.minimum(PARITY, 1 / _ratio(first[0], before))
    return np.maximum(k * steps[0], odd * steps[1] / VARIED)


def _ratio(a: Real, b: Real) -> Real:
    """a / b, at least 1; 1 where b is 0."""
    return np.maximum(np.divide(a, b, out=np.ones_like(a), where=b > 0), 1.0)
