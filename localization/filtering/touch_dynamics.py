"""Dynamics of touches: how often they come, how long they last, how fast they move."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from ...simulator.sweeps import InputError


@dataclass(frozen=True)
class TouchDynamics:
    """Means of exponential distributions, and a speed.

    lasts: s, of a touch. every: s, from a touch's end to the next one. speed: mm/s, of a touch
    along the skin, in a direction that it keeps for a second. Raises InputError for a value that is
    not above 0.
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
        """Rate 1/s at which a touch leaves a part of the skin of this width in mm.

        Parts that are crossed within a second are crossed as by a random walk of as many mm².
        """
        return self.speed / width * max(1.0, self.speed / width)
