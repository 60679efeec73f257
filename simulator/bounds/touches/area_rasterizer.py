"""Touches that end at their edges, rasterized on cells by covered area, with derivatives.

`press.rasterized` has no derivatives; here one touch at a time becomes a map of all cells.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...arrays import Real
from ...press.batch import TouchedCells
from ...scene.planar import SAME_LINE, covered

Point = tuple[float, float]
RISE_SPREAD = 0.2
"""Largest relative deviation of the rise of a random touch."""


class TouchSize(NamedTuple):
    """Rectangular touch: sides along x and y in m, and rise of c.

    finger: capacitance to earth, F, uniform over the touch; 0 for a rod.
    """

    width: float
    height: float
    rise: float
    finger: float = 0.0


class RasterizedTouch(NamedTuple):
    """Map of a touch and its derivatives.

    factors: c over the unpressed c. changes: derivatives by x and y [1/m] and by the rise
    ("strength"). Each has shape (row, column). For a finger each has shape (2, row, column), c and
    then the F in each cell, and there is also the derivative by its capacitance ("finger", 1/F).
    """

    factors: Real
    changes: dict[str, Real]


@dataclass(frozen=True)
class AreaRasterizer:
    """Grid of cells by its lines across x and y, m."""

    x: Real
    y: Real

    @classmethod
    def of(cls, length: float, width: float, grid: tuple[int, int]) -> AreaRasterizer:
        """A uniform grid of rows and columns over a skin."""
        return cls(np.linspace(0, length, grid[1] + 1), np.linspace(0, width, grid[0] + 1))

    def raised(self, place: Point, touch: TouchSize) -> dict[str, Real]:
        """Derivatives of c over the unpressed c by x, y [1/m] and rise, shape (row, column)."""
        along, by_x = covered_about(self.x, place[0], touch.width)
        across, by_y = covered_about(self.y, place[1], touch.height)
        return {
            "x": touch.rise * np.multiply.outer(across, by_x),
            "y": touch.rise * np.multiply.outer(by_y, along),
            "strength": np.multiply.outer(across, along),
        }

    def drawn(self, touch: TouchSize, random: np.random.Generator) -> TouchedCells:
        """A touch at a random position with a rise within RISE_SPREAD, to train a model."""
        sides = (self.x[-1], touch.width), (self.y[-1], touch.height)
        x, y = (own / 2 + random.uniform(0, side - own) for side, own in sides)
        rise = touch.rise * random.uniform(1 - RISE_SPREAD, 1 + RISE_SPREAD)
        rises = (rise * self.raised((x, y), touch)["strength"]).ravel()
        cells = np.flatnonzero(rises)
        return TouchedCells(cells, rises[cells])

    def rasterized(self, place: Point, touch: TouchSize) -> RasterizedTouch:
        """Map of a touch around a point, m."""
        changes = self.raised(place, touch)
        return RasterizedTouch(1 + touch.rise * changes["strength"], changes)

    def with_finger(
        self, rasterized: RasterizedTouch, place: Point, touch: TouchSize
    ) -> RasterizedTouch:
        """The map with the touch's finger added; unchanged for a rod."""
        if not touch.finger:
            return rasterized
        sides = np.multiply.outer(np.diff(self.y), np.diff(self.x)) / (touch.width * touch.height)
        own = self.raised(place, touch._replace(rise=touch.finger))
        fingers = {name: own[name] * sides for name in own}
        none = np.zeros_like(rasterized.factors)
        changes = {
            name: np.stack([change, none if name == "strength" else fingers[name]])
            for name, change in rasterized.changes.items()
        }
        changes["finger"] = np.stack([none, fingers["strength"]])
        return RasterizedTouch(
            np.stack([rasterized.factors, touch.finger * fingers["strength"]]), changes
        )


def covered_about(lines: Real, middle: float, size: float) -> tuple[Real, Real]:
    """Covered fraction of each interval, and its derivative by the middle of the span, 1/m.

    An end of the span at an end of the skin, or beyond it, has the derivative 0.
    """
    start, stop = middle - size / 2, middle + size / 2
    return covered(start, stop, lines), _at(lines, stop) - _at(lines, start)


def _at(lines: Real, end: float) -> Real:
    rounding, slope = SAME_LINE * lines[-1], np.zeros(len(lines) - 1)
    if rounding < end < lines[-1] - rounding:
        cell = int(np.searchsorted(lines, end, side="right")) - 1
        slope[cell] = 1 / (lines[cell + 1] - lines[cell])
    return slope
