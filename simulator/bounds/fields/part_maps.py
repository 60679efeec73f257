"""Conversion of maps of cells to the parts that M is a sum of; see `Parts`."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np

from ...arrays import Real
from ...models.parameters import of_parts
from ...models.reduced.indentation.indentation_draws import scene_spreads_presses
from ...press.parts import SOLVED, Parts, parts_of
from ...scene.parts import Pressing, Skin
from .edge_walls import EdgeWalls


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
