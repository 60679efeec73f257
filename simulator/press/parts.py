"""Numbers of the parts whose sum is the capacitance matrix M. Presses refer to them by number.

The foam's parts come first. If a scene has surroundings, others follow in this order: the
capacitance to earth of a finger on each pixel; the correction for the field along the foam in each
part of it; the walls between parts that are pressed to different thickness; the parts that no press
changes, which are bodies and the field along the outline.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Integer, Mask, Real
from ..scene.foam_mechanics import Mechanics
from ..scene.parts import Skin
from ..scene.surroundings import Surroundings
from .batch import NOTHING, PressBatch, TouchedCells
from .walls import NO_WALL, NO_WALLS, Walls, step_capacitance, step_capacitance_slope, walls_of

SOLVED = "solved"
"""Marks a part without a factor: solved surroundings are valid for one geometry."""
SLOPE_STEP = 1e-5
"""Relative step of central differences: their error is 1e-10 of the slope, plus rounding."""


@dataclass(frozen=True)
class Parts:
    """Number of parts of each kind, one kind after the other.

    foam: see `foam_parts`; a touch raises them by a fraction of the unpressed c. fingers: one on
    each pixel, or none; a finger raises its part from 0 by its capacitance in F. thickness:
    corrections for the field along each part of the foam, or none; `across` gives them from the
    factor of that part. walls: between parts of the foam, none unless a scene has `edges`; `wall`
    gives them from the factors on both sides. fixed: for each other part the factor of a
    `Variation` that scales it, or SOLVED. mechanics: of the foam.
    """

    foam: int
    fingers: int = 0
    thickness: int = 0
    fixed: tuple[str, ...] = ()
    mechanics: Mechanics | None = None
    walls: Walls = NO_WALLS

    @property
    def touched(self) -> int:
        """Number of parts that a press may change."""
        return self.foam + self.fingers + self.thickness + self.walls.count

    @property
    def count(self) -> int:
        """Number of parts."""
        return self.touched + len(self.fixed)

    @cached_property
    def kind(self) -> tuple[slice, slice, slice, slice]:
        """Slices of the parts of foam, fingers, the field along the foam, and walls."""
        of_kinds = self.foam, self.fingers, self.thickness, self.walls.count
        foam, fingers, across, walls = np.cumsum(of_kinds).tolist()
        return slice(0, foam), slice(foam, fingers), slice(fingers, across), slice(across, walls)

    @property
    def around(self) -> bool:
        """True if there are parts other than the foam's."""
        return self.count > self.foam

    @cached_property
    def in_air(self) -> Mask:
        """True for fingers, bodies and the rim, which lack the foam's loss, shape (part,)."""
        found = np.zeros(self.count, dtype=bool)
        found[self.kind[1]] = found[self.touched :] = True
        return found

    def finger(self, pixel: Integer) -> Integer:
        """Part of a finger on a pixel, counted row by row from 0."""
        return self.foam + pixel

    def by_kind(self, cells: Integer, rises: Real) -> tuple[TouchedCells, TouchedCells]:
        """Changes of a press, separated into those of the foam and those of fingers."""
        if not self.around:
            return TouchedCells(cells, rises), NOTHING
        foam = cells < self.foam
        return TouchedCells(cells[foam], rises[foam]), TouchedCells(cells[~foam], rises[~foam])

    def pixels(self, cells: Integer) -> tuple[Integer, Mask]:
        """Pixel of each touch on the foam or by a finger; True where no earlier one is on it.

        Earlier touches are those of the same press. Both results have shape (press, touch).
        """
        pixels = np.where(cells < self.foam, cells, cells - self.foam)
        same = pixels[:, :, None] == pixels[:, None, :]
        return pixels, ~np.tril(same, -1).any(axis=2)

    @cached_property
    def resting(self) -> Real:
        """Amount of each part without a press, shape (part,): 0 for fingers and walls, else 1."""
        found = np.ones(self.count)
        _, fingers, _, walls = self.kind
        found[fingers] = found[walls] = 0.0
        return found

    def pressed(self, cells: Integer, rises: Real) -> Real:
        """Amount of each part under a press, shape (part,)."""
        found = self.resting.copy()
        np.add.at(found, cells, rises)
        foam, _, thickness, walls = self.kind
        if self.thickness:
            found[thickness] = self.across(found[foam])
        if self.walls.count:
            found[walls] = self.wall(*found[foam][self.walls.pairs].T)
        return found

    def thinned(self, factor: Real) -> Real:
        """Thickness of the foam over the unpressed one for factors of c, of shape (...)."""
        if self.mechanics is None:
            return 1 / factor
        return 1 - np.asarray(self.mechanics.strain_at(factor))

    def across(self, factor: Real) -> Real:
        """Correction for the field along the foam over its unpressed value, shape (...).

        factor: of c, shape (...). The correction is proportional to c d². Without mechanics the
        permittivity is constant, and the foam becomes thinner by the factor.
        """
        if self.mechanics is None:
            return 1 / factor
        return factor * self.thinned(factor) ** 2

    def across_slope(self, factor: Real) -> Real:
        """Derivative of `across` by the factor, to six digits."""
        step = SLOPE_STEP * factor
        return (self.across(factor + step) - self.across(factor - step)) / (2 * step)

    def wall(self, one: Real, other: Real) -> Real:
        """Amount of a wall between foam with these factors of c, both of shape (...).

        `step_capacitance` of the ratio of the thicknesses; 0 if they are equal.
        """
        return step_capacitance(_ratio(self.thinned(one), self.thinned(other)))

    def wall_slope(self, own: Real, other: Real) -> Real:
        """Derivative of `wall` by the factor on its own side, to six digits."""
        thinned, beside, step = self.thinned(own), self.thinned(other), SLOPE_STEP * own
        by_factor = (self.thinned(own + step) - self.thinned(own - step)) / (2 * step)
        thinner = thinned < beside
        by_thickness = np.where(thinner, 1 / beside, -beside / thinned**2)
        return step_capacitance_slope(_ratio(thinned, beside)) * by_thickness * by_factor

    def wall_slopes(self, factor: Real) -> Real:
        """Derivatives of all walls by the factors of their first and second part, shape (wall, 2).

        factor: of each part of the foam, shape (part,).
        """
        one, other = factor[self.walls.pairs].T
        return np.stack([self.wall_slope(one, other), self.wall_slope(other, one)], axis=1)

    def completed(self, cells: Integer, rises: Real) -> TouchedCells:
        """Changes of one press, completed as `followed` does."""
        if not (self.thickness or self.walls.count):
            return TouchedCells(cells, rises)
        return self.followed(PressBatch.of([(cells, rises)])).one(0)

    def followed(self, batch: PressBatch) -> PressBatch:
        """Same presses with their changes of the field along the foam, and with their walls."""
        if not (self.thickness or self.walls.count):
            return batch
        on_foam, press = batch.cells < self.foam, batch.press
        keys, place = np.unique(
            press[on_foam] * self.foam + batch.cells[on_foam], return_inverse=True
        )
        factor = 1.0 + np.bincount(place, batch.rises[on_foam], len(keys)).astype(np.float64)
        if self.thickness:
            starts = np.searchsorted(keys // self.foam, np.arange(batch.count + 1))
            across = self.kind[2].start + keys % self.foam
            batch = batch.and_(PressBatch(across, self.across(factor) - 1, starts))
        if self.walls.count:
            batch = batch.and_(self._touched_walls(keys, factor, batch.count))
        return batch

    def _touched_walls(self, keys: Integer, factor: Real, count: int) -> PressBatch:
        """Walls around touched parts of `count` presses.

        keys: press * foam + touched part, ascending, and the factor of each.
        """
        press, part = np.divmod(keys, self.foam)
        walls, around = self.walls, self.walls.of(part)
        each = (press[:, None] * walls.count + around)[around != NO_WALL]
        press, wall = np.divmod(np.unique(each), walls.count)
        ends = press[:, None] * self.foam + walls.pairs[wall]
        at = np.minimum(np.searchsorted(keys, ends), max(len(keys) - 1, 0))
        beside = np.where(keys[at] == ends, factor[at], 1.0) if len(keys) else np.ones(ends.shape)
        starts = np.searchsorted(press, np.arange(count + 1))
        return PressBatch(self.kind[3].start + wall, self.wall(*beside.T), starts)


def _ratio(one: Real, other: Real) -> Real:
    """Ratio of the smaller one to the larger one."""
    return np.minimum(one, other) / np.maximum(one, other)


def foam_parts(skin: Skin, grid: tuple[int, int] | None = None) -> int:
    """Number of parts of the foam: the cells of a grid, row by row, by default the pixels.

    On a mesh one more part is the foam outside the cells.
    """
    rows, columns = grid or skin.pixels.shape
    return rows * columns + (skin.mesh is not None)


def parts_of(skin: Skin, grid: tuple[int, int] | None = None) -> Parts:
    """Parts of a scene with the cells of a grid, by default its pixels."""
    foam, around = foam_parts(skin, grid), skin.around
    if around is None:
        return Parts(foam)
    rows, columns = grid or skin.pixels.shape
    return Parts(
        foam,
        fingers=0 if around.no_finger_reason else rows * columns,
        thickness=foam if around.thickness or around.solved else 0,
        mechanics=skin.foam.mechanics,
        fixed=_fixed(around),
        walls=walls_of(skin, (rows, columns)) if around.edges else NO_WALLS,
    )


def _fixed(around: Surroundings) -> tuple[str, ...]:
    if around.solved:
        return (SOLVED,) * (len(around.body) + 1)
    return (*("body" for _ in around.body), *(("rim",) if around.rim else ()))
