"""Dynamics of touches: their frequency, duration and speed."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from ...simulator.sweeps import InputError


@dataclass(frozen=True)
class TouchDynamics:
    """Mean durations of exponential distributions, and a speed.

    lasts: duration of a touch, s. every: time from a touch's end to the next one, s. speed: speed
    of a touch along the skin, mm/s; it keeps its direction for a second. Raises InputError for a
    value that is not above 0.
    """

    lasts: float = 2.0
    every: float = 5.0
    speed: float = 20.0

    def __post_init__(self) -> None:
        for each in fields(self):
            value = getattr(self, each.name)
            if not 0 < value < math.inf:
                raise InputError(f"`touch-{each.name}` must be above 0, got {value:g}")

    def crossings(self, width: float) -> float:
        """Rate in 1/s at which a touch leaves a part of the skin of this width in mm.

        If it crosses the part within a second, the rate is that of a random walk: speed² / width².
        """
        return self.speed / width * max(1.0, self.speed / width)
