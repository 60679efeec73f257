"""A tear of a sheet, as a map of its resistance."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import BeforeValidator, Field

from ...arrays import Real
from ..planar import Lines
from ..ranges import Length
from ..validation import Number, by_kind
from .factor_maps import AnyMap, Constant, FactorMap, Gradient, Grid, Random, Sides, refuse_file

TORN = 1e9
"""Sheet resistance within a tear over that around it. Across a gap of 0.1 mm it leaves the current
at 1 kHz below 1e-3 of that through the foam beyond."""

GRADING, FINEST, WIDEST = 4.0, -1, 12
"""Ratio of the distances of lines from the gap, and powers of it for the nearest and the farthest
of them, in widths. The field is singular at the end of the gap."""

NEAR = 1e-3
"""Distance of `details` from the corners of the gap, over its half size."""

SAME = 1e-12
"""Distance in m below which two lines are one."""


class Tear(FactorMap):
    """A straight cut of a sheet from an edge inwards; no current flows across it.

    edge: where it begins. at: place along that edge, as a fraction from its low-coordinate end.
    length: over the skin's side, 1 for a cut to the opposite edge. width [m]: of the gap, in which
    the sheet does not conduct.
    """

    kind: Literal["tear"] = "tear"
    edge: Literal["left", "right", "bottom", "top"]
    at: Annotated[Number, Field(gt=0, lt=1)]
    length: Annotated[Number, Field(gt=0, le=1)]
    width: Length = 1e-4

    @property
    def uniform(self) -> float | None:
        return None

    def factors(self, x: Real, sides: Sides) -> Real:
        (left, right), (low, high) = self._gap(sides)
        torn = (x[0] > left) & (x[0] < right) & (x[1] > low) & (x[1] < high)
        return np.where(torn, TORN, 1.0)

    def kinks(self, sides: Sides) -> Lines:
        """Limits of the gap, and lines that narrow towards them, in m."""
        along, across = (
            self._graded(ends, side) for ends, side in zip(self._gap(sides), sides, strict=True)
        )
        return along, across

    def details(self, sides: Sides) -> Real:
        """Points on both sides of the four corners of the gap."""
        corners = np.stack([each.ravel() for each in np.meshgrid(*self._gap(sides))])
        middle = corners.mean(axis=1, keepdims=True)
        return np.hstack([middle + scale * (corners - middle) for scale in (1 - NEAR, 1 + NEAR)])

    def check(self, sides: Sides) -> None:
        along = sides[self.edge in ("left", "right")]
        least = self.width / along
        if not least < self.at < 1 - least:
            raise ValueError(
                f"at must be from {least:.3g} to {1 - least:.3g}, so that the gap of {self.width:g}"
                f" m is on the skin, got {self.at:g}"
            )

    def _gap(self, sides: Sides) -> tuple[tuple[float, float], tuple[float, float]]:
        """Limits of the gap along x and along y, m."""
        vertical = self.edge in ("bottom", "top")
        along, side = sides if vertical else sides[::-1]
        middle, cut = self.at * along, self.length * side
        gap = middle - self.width / 2, middle + self.width / 2
        inwards = (0.0, cut) if self.edge in ("left", "bottom") else (side - cut, side)
        return (gap, inwards) if vertical else (inwards, gap)

    def _graded(self, ends: tuple[float, float], side: float) -> tuple[float, ...]:
        """Lines at and around those ends that lie within the skin, ascending, m."""
        inside = [end for end in ends if SAME < end < side - SAME]
        steps = self.width * GRADING ** np.arange(FINEST, WIDEST)
        lines = [line for end in inside for line in (end, *(end - steps), *(end + steps))]
        kept = sorted(line for line in lines if SAME < line < side - SAME)
        apart = [k for k, line in enumerate(kept) if not k or line - kept[k - 1] > SAME]
        return tuple(kept[k] for k in apart)


SheetMap = Annotated[
    AnyMap | Tear,
    by_kind(Constant, Gradient, Random, Grid, Tear, elsewhere="file"),
    BeforeValidator(refuse_file),
]
