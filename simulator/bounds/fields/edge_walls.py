"""Walls of one touch that ends at its edges, on cells that it covers in part.

An edge between two lines of the grid stands on both of them, by how near it is to each: of a cover
p of cells it is the integral of eps E |p - p'| along all lines between cells, E of the step from
the foam at rest to that under the touch. So it moves with the touch, and whole cells have it where
it is. One within the outermost cells stands on the line beside them alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...press.parts import Parts

Array = NDArray[np.float64]
STRENGTH = "strength"
"""The name of the rise under a touch among what changes a map."""
SAME = 1e-9
"""Of a cell: covers of two cells that differ by less are one."""


@dataclass(frozen=True)
class EdgeWalls:
    """cover: what part of each part of the foam a touch covers, shape (part,). rise: of c under it,
    over that at rest. grid: rows and columns of cells."""

    parts: Parts
    cover: Array
    rise: float
    grid: tuple[int, int]

    @classmethod
    def of_touch(
        cls, parts: Parts, foam: Array, by: Mapping[str, Array], grid: tuple[int, int]
    ) -> EdgeWalls | None:
        """Of foam that one touch presses, (part,), and how that changes; None without any wall."""
        if not parts.walls.count or (foam == 1).all():
            return None
        cover = by[STRENGTH]
        most = int(np.argmax(cover))
        return cls(parts, cover, float((foam[most] - 1) / cover[most]), grid)

    @property
    def walls(self) -> Array:
        """How much of each there is, shape (wall,)."""
        return float(self.parts.wall(*self._sides)) * np.abs(self._steps(self.cover))

    def change_by(self, name: str, change: Array) -> Array:
        """How that changes with something of this name by which the foam changes, (part,)."""
        if name == STRENGTH:
            return float(self.parts.wall_slope(*self._sides)) * np.abs(self._steps(self.cover))
        steps, by_name = self._steps(self.cover), self._steps(change) / self.rise
        grown = np.where(np.abs(steps) > SAME, np.sign(steps) * by_name, np.abs(by_name))
        return float(self.parts.wall(*self._sides)) * grown

    def with_foam(self, share: Array) -> Array:
        """The same as the foam's permittivity changes by such a share, shape (part,)."""
        return self.walls * share[self.parts.walls.pairs].mean(axis=1)

    @property
    def _sides(self) -> tuple[Array, Array]:
        return np.array(1 + self.rise), np.array(1.0)

    def _steps(self, of_parts: Array) -> Array:
        sides = of_parts[self.parts.walls.pairs]
        less, size = self._less(self.cover), np.abs(sides)
        alike = np.abs(self.cover[self.parts.walls.pairs] @ [1.0, -1.0]) <= SAME
        less |= alike[:, None] & (size < size[:, ::-1])
        one, other = np.where(self._outermost & less, 0.0, sides).T
        return other - one

    def _less(self, of_parts: Array) -> NDArray[np.bool_]:
        """Whether one side of each wall is covered less than the other, shape (wall, 2)."""
        sides = of_parts[self.parts.walls.pairs]
        return sides < sides[:, ::-1] - SAME

    @cached_property
    def _outermost(self) -> NDArray[np.bool_]:
        """Sides of walls that have nothing behind, shape (wall, 2)."""
        row, column = np.divmod(self.parts.walls.pairs, self.grid[1])
        along = row[:, :1] == row[:, 1:]
        place, count = np.where(along, column, row), np.where(along, self.grid[1], self.grid[0])
        return (place == 0) | (place == count - 1)
