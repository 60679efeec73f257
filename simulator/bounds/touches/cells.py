"""Touches that end at their edges, on cells by the area that they cover, and their slopes.

`press.rasterized` has no slopes: these are of one touch at a time, and of whole maps.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...press.batch import TouchedCells
from ...scene.planar import SAME_LINE, covered

Array = NDArray[np.float64]
Place = tuple[float, float]
ABOUT = 0.2
"""Of the rise of a touch: so far from it others are drawn."""


class TouchSize(NamedTuple):
    """Rectangles that are to be answered: sides along x and y in m, and by how much c rises.

    finger: capacitance to earth, F, spread evenly over it; 0 of a rod.
    """

    width: float
    height: float
    rise: float
    finger: float = 0.0


class Laid(NamedTuple):
    """c over that at rest, and how that changes with x and y [1/m] and with the rise under the
    touch, by name; each of shape (row, column), or (2, row, column) where a finger touches, with
    its F in each cell after c; then they change with the finger's capacitance [1/F], too."""

    factors: Array
    changes: dict[str, Array]


@dataclass(frozen=True)
class Cells:
    """Lines of a grid across x and y, m."""

    x: Array
    y: Array

    @classmethod
    def of(cls, length: float, width: float, grid: tuple[int, int]) -> Cells:
        """A uniform grid of so many rows and columns over a skin."""
        return cls(np.linspace(0, length, grid[1] + 1), np.linspace(0, width, grid[0] + 1))

    def raised(self, place: Place, touch: TouchSize) -> dict[str, Array]:
        """How c over that at rest changes with x and y [1/m] and with the rise; (row, column)."""
        along, by_x = covered_about(self.x, place[0], touch.width)
        across, by_y = covered_about(self.y, place[1], touch.height)
        return {
            "x": touch.rise * np.multiply.outer(across, by_x),
            "y": touch.rise * np.multiply.outer(by_y, along),
            "strength": np.multiply.outer(across, along),
        }

    def drawn(self, touch: TouchSize, random: np.random.Generator) -> TouchedCells:
        """One somewhere on the skin, as strong but for ABOUT, to train a model with."""
        sides = (self.x[-1], touch.width), (self.y[-1], touch.height)
        x, y = (own / 2 + random.uniform(0, side - own) for side, own in sides)
        rise = touch.rise * random.uniform(1 - ABOUT, 1 + ABOUT)
        rises = (rise * self.raised((x, y), touch)["strength"]).ravel()
        cells = np.flatnonzero(rises)
        return TouchedCells(cells, rises[cells])

    def laid(self, place: Place, touch: TouchSize) -> Laid:
        """A touch about a place, m."""
        changes = self.raised(place, touch)
        return Laid(1 + touch.rise * changes["strength"], changes)

    def with_finger(self, laid: Laid, place: Place, touch: TouchSize) -> Laid:
        """The same touch by a finger; itself by a rod."""
        if not touch.finger:
            return laid
        sides = np.multiply.outer(np.diff(self.y), np.diff(self.x)) / (touch.width * touch.height)
        own = self.raised(place, touch._replace(rise=touch.finger))
        fingers = {name: own[name] * sides for name in own}
        none = np.zeros_like(laid.factors)
        changes = {
            name: np.stack([change, none if name == "strength" else fingers[name]])
            for name, change in laid.changes.items()
        }
        changes["finger"] = np.stack([none, fingers["strength"]])
        return Laid(np.stack([laid.factors, touch.finger * fingers["strength"]]), changes)


def covered_about(lines: Array, middle: float, size: float) -> tuple[Array, Array]:
    """Fraction of each interval that a span covers, and its derivative by the span's middle, 1/m.

    An end of the span at an end of the skin, or beyond it, does not move.
    """
    start, stop = middle - size / 2, middle + size / 2
    return covered(start, stop, lines), _at(lines, stop) - _at(lines, start)


def _at(lines: Array, end: float) -> Array:
    rounding, slope = SAME_LINE * lines[-1], np.zeros(len(lines) - 1)
    if rounding < end < lines[-1] - rounding:
        cell = int(np.searchsorted(lines, end, side="right")) - 1
        slope[cell] = 1 / (lines[cell + 1] - lines[cell])
    return slope
