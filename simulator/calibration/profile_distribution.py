"""Distribution of a quantity from its profile likelihood."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from ..arrays import Real

Interval = tuple[float, float]

CONFIDENCE, NORMAL = 0.95, 1.959963984540054
"""Confidence of every interval; its half width in standard deviations of a normal distribution."""


@dataclass(frozen=True)
class ProfileDistribution:
    """Distribution of a quantity by its profile likelihood.

    values: of the quantity, ascending, shape (value,). deviations: signed square root of the rise
    of the misfit above its minimum at each value, ascending. limits: of the quantity.
    """

    values: Real
    deviations: Real
    limits: Interval

    def at(self, deviations: Real) -> Real:
        """Values at these deviations, linearly extrapolated, within the limits."""
        own = np.clip(deviations, self.deviations[0], self.deviations[-1])
        found = PchipInterpolator(self.deviations, self.values)(own)
        for end, within in ((0, 1), (-1, -2)):
            step = self.values[end] - self.values[within]
            slope = step / (self.deviations[end] - self.deviations[within])
            found = np.where(own == self.deviations[end], self.values[end], found)
            past = deviations - own
            found = found + np.where(past < 0 if end == 0 else past > 0, slope * past, 0.0)
        return np.clip(found, *self.limits)

    def interval(self, width: float) -> Interval:
        """The 95 % interval for normal deviations, cut at the limits; see `cut_normal`.

        width: half of an uncut 95 % interval, in standard deviations.
        """
        low, high = self.at(np.array(cut_normal(0.0, 1.0, width, self._cut())))
        return float(low), float(high)

    def _cut(self) -> Interval:
        low = self.deviations[0] if self.values[0] <= self.limits[0] else -np.inf
        high = self.deviations[-1] if self.values[-1] >= self.limits[1] else np.inf
        return float(low), float(high)

    def shifted(self, by: float) -> ProfileDistribution:
        """Distribution of the quantity plus a constant."""
        low, high = self.limits
        return ProfileDistribution(self.values + by, self.deviations, (low + by, high + by))


def cut_normal(value: float, deviation: float, width: float, limits: Interval) -> Interval:
    """The 95 % interval of a normal distribution that is cut at limits.

    On the side of the nearer limit it is as wide as without limits, so it contains the limit unless
    a two-sided test at 5 % rejects it. The other side is shorter by the probability that is cut.
    width: half of an uncut 95 % interval, in standard deviations.
    """
    from scipy.special import ndtr, ndtri

    unit = deviation * width / NORMAL
    below, above = (value - limits[0]) / unit, (limits[1] - value) / unit
    near = min(below, above, NORMAL)
    far = float(ndtri(ndtr(-near) + CONFIDENCE * (ndtr(above) - ndtr(-below))))
    if below <= above:
        return limits[0] if near == below else value - unit * near, value + unit * far
    return value - unit * far, limits[1] if near == above else value + unit * near
