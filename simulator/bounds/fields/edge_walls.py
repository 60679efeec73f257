"""Walls of one touch that ends at its edges, on cells that it covers in part.

An edge of the touch between two lines of the grid contributes to the wall on each of them, weighted
by how near it is. For a cover p of the cells, the walls are the integral of eps E |p - p'| along
all lines between cells, with E of the step from the unpressed foam to that under the touch. They
move with the touch, and for a touch of whole cells they are exactly at its edge. An edge within the
outermost cells contributes only to the line next to them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Mask, Real
from ...press.parts import Parts

STRENGTH = "strength"
"""Name of the rise under a touch among the quantities that change a map."""
SAME = 1e-9
"""Smallest distinct difference between the covers of two cells."""


@dataclass(frozen=True)
class EdgeWalls:
    """Walls around one touch.

    cover: fraction of each part of the foam that the touch covers, shape (part,). rise: of c under
    the touch, over the unpressed c. grid: rows and columns of cells.
    """

    parts: Parts
    cover: Real
    rise: float
    grid: tuple[int, int]

    @classmethod
    def of_touch(
        cls, parts: Parts, foam: Real, by: Mapping[str, Real], grid: tuple[int, int]
    ) -> EdgeWalls | None:
        """Walls around one touch; None if there are none.

        foam: c over the unpressed c, shape (part,). by: its derivatives by name, with STRENGTH.
        """
        if not parts.walls.count or (foam == 1).all():
            return None
        cover = by[STRENGTH]
        most = int(np.argmax(cover))
        return cls(parts, cover, float((foam[most] - 1) / cover[most]), grid)

    @property
    def walls(self) -> Real:
        """Amount of each wall, shape (wall,); see `Parts`."""
        return float(self.parts.wall(*self._sides)) * np.abs(self._steps(self.cover))

    def change_by(self, name: str, change: Real) -> Real:
        """Derivative of `walls` by the quantity of this name.

        change: derivative of the foam by it, shape (part,).
        """
        if name == STRENGTH:
            return float(self.parts.wall_slope(*self._sides)) * np.abs(self._steps(self.cover))
        steps, by_name = self._steps(self.cover), self._steps(change) / self.rise
        grown = np.where(np.abs(steps) > SAME, np.sign(steps) * by_name, np.abs(by_name))
        return float(self.parts.wall(*self._sides)) * grown

    def with_foam(self, share: Real) -> Real:
        """Derivative of `walls` by the foam's permittivity.

        share: its relative change, shape (part,).
        """
        return self.walls * share[self.parts.walls.pairs].mean(axis=1)

    @property
    def _sides(self) -> tuple[Real, Real]:
        return np.array(1 + self.rise), np.array(1.0)

    def _steps(self, of_parts: Real) -> Real:
        sides = of_parts[self.parts.walls.pairs]
        less, size = self._less(self.cover), np.abs(sides)
        equal = np.abs(self.cover[self.parts.walls.pairs] @ [1.0, -1.0]) <= SAME
        less |= equal[:, None] & (size < size[:, ::-1])
        one, other = np.where(self._outermost & less, 0.0, sides).T
        return other - one

    def _less(self, of_parts: Real) -> Mask:
        """True for a side of a wall that is covered less than the other, shape (wall, 2)."""
        sides = of_parts[self.parts.walls.pairs]
        return sides < sides[:, ::-1] - SAME

    @cached_property
    def _outermost(self) -> Mask:
        """True for sides of walls that are outermost cells, shape (wall, 2)."""
        row, column = np.divmod(self.parts.walls.pairs, self.grid[1])
        along = row[:, :1] == row[:, 1:]
        place, count = np.where(along, column, row), np.where(along, self.grid[1], self.grid[0])
        return (place == 0) | (place == count - 1)
