"""The law of a quantity by its likelihood at some places: chances, quantiles, likeliest values."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

Interval = tuple[float, float]

FAR = 3.5
"""Deviations beyond which next to nothing lies."""
CELLS = 4000
NORMAL = 1.959963984540054
"""Deviations that 95 of 100 values of a normal law lie within."""


@dataclass(frozen=True)
class Law:
    """Of a quantity, ascending `places`, all of shape (place,).

    misfit: twice the negative logarithm of its density but for `factor`, the logarithm of what else
    it goes with. slope: of misfit. limits: beyond which nothing is. width: of half an interval of
    95 % over the deviation, where all is linear.
    """

    places: NDArray[np.float64]
    misfit: NDArray[np.float64]
    slope: NDArray[np.float64]
    factor: NDArray[np.float64]
    limits: Interval
    width: float

    def quantile(self, chance: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values that are not exceeded by these shares."""
        x, density = self._density
        steps = np.diff(x) * (density[1:] + density[:-1]) / 2
        below = np.concatenate([[0.0], np.cumsum(steps)])
        return np.interp(chance, below / below[-1], x)

    def at(self, deviations: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values as likely exceeded as these of a normal law that is as much widened."""
        from scipy.special import ndtr

        return self.quantile(ndtr(deviations * NORMAL / self.width))

    def interval(self, confidence: float) -> Interval:
        """Of so large a share: the likeliest values where a limit cuts, else with equal tails."""
        if not self._cut:
            low, high = self.quantile(np.array([1 - confidence, 1 + confidence]) / 2)
            return float(low), float(high)
        x, density = self._density
        order = np.argsort(-density)
        share = np.cumsum(density[order])
        likely = x[order[: 1 + int(np.searchsorted(share, confidence * share[-1]))]]
        return float(likely.min()), float(likely.max())

    @property
    def _cut(self) -> bool:
        _, density = self._density
        ends = self.places[0] <= self.limits[0], self.places[-1] >= self.limits[1]
        least = np.exp(-(FAR**2) / 2) * density.max()
        return bool((ends[0] and density[0] > least) or (ends[1] and density[-1] > least))

    @cached_property
    def _density(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """On a fine grid, as far as there is any."""
        x = np.linspace(*self._ends(), CELLS + 1)
        within = np.clip(x, self.places[0], self.places[-1])
        rise = CubicHermiteSpline(self.places, self.misfit, self.slope)(within)
        for side in (0, -1):
            beyond = x - self.places[side]
            outside = beyond < 0 if side == 0 else beyond > 0
            rise[outside] += self.slope[side] * beyond[outside]
        factor = PchipInterpolator(self.places, self.factor)(within)
        of = -(rise - self.misfit.min()) / 2 + factor
        return x, np.exp((of - of.max()) * (NORMAL / self.width) ** 2)

    def _ends(self) -> Interval:
        """Beyond the last place where no limit is, as far as its slope leaves anything."""
        low, high = float(self.places[0]), float(self.places[-1])
        left = (FAR * self.width / NORMAL) ** 2 - (self.misfit - self.misfit.min())
        if left[0] > 0 > self.slope[0]:
            low = max(low + left[0] / self.slope[0], self.limits[0])
        if left[-1] > 0 < self.slope[-1]:
            high = min(high + left[-1] / self.slope[-1], self.limits[1])
        return low, high
