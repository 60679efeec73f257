"""The law of a quantity by the rise of its misfit: where it lies at so many deviations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

Interval = tuple[float, float]

CONFIDENCE, NORMAL = 0.95, 1.959963984540054
"""Of every interval; deviations that so large a share of a normal law lies within."""


@dataclass(frozen=True)
class Law:
    """Of a quantity, ascending `places`, shape (place,).

    deviations: of the places, ascending: the square root of how far the misfit there lies above
    its least, below 0 on the lower side. limits: of the quantity.
    """

    places: NDArray[np.float64]
    deviations: NDArray[np.float64]
    limits: Interval

    def at(self, deviations: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values at these deviations, straight on beyond the last place, to the limits."""
        own = np.clip(deviations, self.deviations[0], self.deviations[-1])
        found = PchipInterpolator(self.deviations, self.places)(own)
        for end, within in ((0, 1), (-1, -2)):
            step = self.places[end] - self.places[within]
            slope = step / (self.deviations[end] - self.deviations[within])
            found = np.where(own == self.deviations[end], self.places[end], found)
            past = deviations - own
            found = found + np.where(past < 0 if end == 0 else past > 0, slope * past, 0.0)
        return np.clip(found, *self.limits)

    def interval(self, width: float) -> Interval:
        """95 of 100 values, the deviations being normal, cut where limits are; see `cut_normal`.

        width: times the deviation that 95 of 100 lie within where nothing is cut.
        """
        low, high = self.at(np.array(cut_normal(0.0, 1.0, width, self._cut())))
        return float(low), float(high)

    def _cut(self) -> Interval:
        low = self.deviations[0] if self.places[0] <= self.limits[0] else -np.inf
        high = self.deviations[-1] if self.places[-1] >= self.limits[1] else np.inf
        return float(low), float(high)

    def shifted(self, by: float) -> Law:
        """Of the quantity and a number that is added to it."""
        low, high = self.limits
        return Law(self.places + by, self.deviations, (low + by, high + by))


def cut_normal(value: float, deviation: float, width: float, limits: Interval) -> Interval:
    """An interval of 95 of 100 values of a normal law that is cut at limits.

    Toward the nearer limit it reaches as far as without limits, so that it contains a limit unless
    a two-sided test at 5 % rejects it. What the limit cuts off shortens the other side.
    width: times the deviation that 95 of 100 lie within where nothing is cut.
    """
    from scipy.special import ndtr, ndtri

    unit = deviation * width / NORMAL
    below, above = (value - limits[0]) / unit, (limits[1] - value) / unit
    near = min(below, above, NORMAL)
    far = float(ndtri(ndtr(-near) + CONFIDENCE * (ndtr(above) - ndtr(-below))))
    if below <= above:
        return limits[0] if near == below else value - unit * near, value + unit * far
    return value - unit * far, limits[1] if near == above else value + unit * near
