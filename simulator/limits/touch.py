"""A rectangular touch on the cells of a grid, and how it changes when it moves or grows stronger.

A cell enters with the fraction of its area that is covered, so the derivatives by x and y live in
the cells that an edge of the rectangle crosses. They are best where edges run through the middle of
cells.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.cover import shared
from simulator.grid import SAME_LINE

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TouchSize:
    """Sides along x and y in m, and the rise of capacitance over that at rest."""

    width: float
    height: float
    rise: float


@dataclass(frozen=True)
class Cells:
    """Lines of a grid across x and y, m."""

    x: Array
    y: Array

    @classmethod
    def of(cls, length: float, width: float, grid: tuple[int, int]) -> Cells:
        """A uniform grid of so many rows and columns over a skin."""
        return cls(np.linspace(0, length, grid[1] + 1), np.linspace(0, width, grid[0] + 1))

    def raised(self, place: tuple[float, float], touch: TouchSize) -> dict[str, Array]:
        """How c over that at rest changes with x and y [1/m] and with the rise; (row, column)."""
        along, by_x = covered(self.x, place[0], touch.width)
        across, by_y = covered(self.y, place[1], touch.height)
        return {
            "x": touch.rise * np.multiply.outer(across, by_x),
            "y": touch.rise * np.multiply.outer(by_y, along),
            "strength": np.multiply.outer(across, along),
        }


def covered(lines: Array, middle: float, size: float) -> tuple[Array, Array]:
    """Fraction of each interval that a span covers, and its derivative by the span's middle, 1/m.

    An end of the span at an end of the skin, or beyond it, does not move.
    """
    start, stop = middle - size / 2, middle + size / 2
    fraction = shared(np.array([start, stop]), lines)[0]
    return fraction, _at(lines, stop) - _at(lines, start)


def _at(lines: Array, end: float) -> Array:
    rounding, slope = SAME_LINE * lines[-1], np.zeros(len(lines) - 1)
    if rounding < end < lines[-1] - rounding:
        cell = int(np.searchsorted(lines, end, side="right")) - 1
        slope[cell] = 1 / (lines[cell + 1] - lines[cell])
    return slope
