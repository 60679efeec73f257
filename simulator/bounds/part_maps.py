"""Conversion of maps of cells to the parts that M is a sum of; see `Parts`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Mask, Real
from ..models.parameters import of_parts
from ..models.reduced.touches import scene_spreads_presses
from ..press.parts import SOLVED, Parts, parts_of
from ..scene.parts import Pressing, Skin

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


class PartMaps:
    """Parts of a scene whose pixels are the cells, from maps.

    A map is c over the unpressed c, shape (row, column), or that and the F of fingers in each cell,
    shape (2, row, column).
    """

    def __init__(self, skin: Skin, pressing: Pressing) -> None:
        self._skin, self._pressing = skin, pressing

    @cached_property
    def parts(self) -> Parts:
        """Numbering of the parts."""
        return parts_of(self._skin)

    @property
    def foam(self) -> slice:
        """Indices of the parts of the foam."""
        return self.parts.kind[0]

    def of_foam(self, map_of: Real, outside: float) -> Real:
        """Value of each part of the foam. outside: value of parts outside all cells."""
        own = map_of if map_of.ndim == 2 else map_of[0]
        return of_parts(self._skin, own, outside)

    def edges(self, factors: Real, directions: Mapping[str, Real]) -> EdgeWalls | None:
        """Walls around one touch; None if there are none, or if a tension spreads the press.

        factors: map of the touch. directions: its derivatives by name.
        """
        if not self.parts.walls.count or scene_spreads_presses(self._skin, self._pressing):
            return None
        by = {name: self.of_foam(change, 0.0) for name, change in directions.items()}
        return EdgeWalls.of_touch(
            self.parts, self.of_foam(factors, 1.0), by, self._skin.pixels.shape
        )

    def pressed(self, factors: Real, edges: EdgeWalls | None = None) -> Real:
        """Amount of each part under a map, shape (part,). edges: of the touch."""
        found, kind = self._with_fingers(self.parts.resting, factors), self.parts.kind
        foam, _, across, walls = kind
        found[foam] = self.of_foam(factors, 1.0)
        if self.parts.thickness:
            found[across] = self.parts.across(found[foam])
        if edges:
            found[walls] = edges.walls
        return found

    def by_press(self, name: str, change: Real, foam: Real, edges: EdgeWalls | None = None) -> Real:
        """Derivative of `pressed` by a quantity of a press.

        name: of the quantity. change: derivative of the map by it. foam: pressed, shape (foam
        part,). edges: of the touch.
        """
        found = self._change(change, self.parts.across_slope(foam))
        if edges:
            found[self.parts.kind[3]] = edges.change_by(name, self.of_foam(change, 0.0))
        return found

    def by_foam(self, change: Real, foam: Real, edges: EdgeWalls | None = None) -> Real:
        """Derivative of `pressed` by the foam's own capacitance.

        It also scales the field along the foam and the walls. Arguments as in `by_press`.
        """
        found = self._change(change, self.parts.across(foam) / foam)
        if edges:
            found[self.parts.kind[3]] = edges.with_foam(self.of_foam(change, 0.0) / foam)
        return found

    def by_skin(self, pressed: Real) -> dict[str, Real]:
        """Change of the factors by logarithms of bodies and the rim, which no press changes.

        Where there is more than the foam, also by the logarithm of the foam's capacitance.
        """
        fixed = enumerate(self.parts.fixed, self.parts.touched)
        found = dict[str, Real]()
        for number, name in fixed:
            if name != SOLVED:
                found.setdefault(name, np.zeros(self.parts.count))[number] = 1.0
        if self.parts.around:
            of_foam = np.r_[self.parts.kind[0], self.parts.kind[2], self.parts.kind[3]]
            found["capacitance"] = np.zeros(self.parts.count)
            found["capacitance"][of_foam] = pressed[of_foam]
        return found

    def _change(self, change: Real, across: Real) -> Real:
        found, kind = self._with_fingers(np.zeros(self.parts.count), change), self.parts.kind
        found[kind[0]] = self.of_foam(change, 0.0)
        if self.parts.thickness:
            found[kind[2]] = across * found[kind[0]]
        return found

    def _with_fingers(self, each: Real, map_of: Real) -> Real:
        found = each.copy()
        if map_of.ndim == 3:
            found[self.parts.kind[1]] = map_of[1].ravel()
        return found
