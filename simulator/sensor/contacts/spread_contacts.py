"""Contacts on skins with tension, which deflect beside the contact as well.

Round contacts that are alone are looked up in tables, see `radial_tables`; all others and images of
pressure are solved on a lattice, see `models.mechanics.lattice_presses`.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from ...arrays import Mask, Real
from ...models.mechanics.foam_law import FoamTables
from ...models.mechanics.lattice_presses import pressed, touched, under_pressure
from ...models.mechanics.relaxation_kernel import Bodies
from ...models.mechanics.skin_lattice import Lattice, lattice_of
from ...press.batch import NOTHING, TouchedCells
from ...press.pixels import GridCells
from ...scene.parts import Skin
from .contact_types import PointContacts, PressureImage
from .patch_kernel import (
    CURVATURE,
    DEPTH,
    FINE,
    FORCE,
    HEIGHT,
    RADIUS,
    STRENGTH,
    WIDTH,
    Fault,
    Stacks,
    X,
    Y,
)
from .radial_tables import NO_TABLES, RadialTable, radial_table
from .spread_kernel import BY_LATTICE, NO_TABLE, spread_stacks
from .winkler_kernel import winkler_patch

MAX_TABLES = 256
"""Number of tables above which those are dropped that the latest contacts do not need."""
FINEST = 0.5
"""Smallest size that nodes resolve, over the length in which the skins spread a press."""


class PressedPoints(NamedTuple):
    """Point contacts pressed into the foam.

    limited: True for presses whose foam was limited to its largest strain, shape (press,). patches:
    radius of each patch, m, 0 for a rectangle, shape (press, contact). on_lattice: cells of presses
    that have no stacks, by press.
    """

    stacks: Stacks
    limited: Mask
    patches: Real
    fault: Fault
    on_lattice: dict[int, TouchedCells]


class LatticePress(NamedTuple):
    """One press solved on a lattice.

    touched: its cells. depth, radius: of each contact and its patch, m; 0 for the radius of a
    rectangle. limited: True if the foam was limited to its largest strain.
    """

    touched: TouchedCells
    depth: Real
    radius: Real
    limited: bool


@dataclass(eq=False)
class SpreadContacts:
    """Rasterizer of contacts on skins with tension, with tables of the indenters so far.

    grid: rows and columns of cells. keys: radius and curvature radius of each table, m, shape
    (table, 2). Its methods raise ToleranceError where a relaxation does not converge.
    """

    skin: Skin
    grid: tuple[int, int]
    foam: FoamTables
    cells: GridCells
    keys: Real = field(default_factory=lambda: np.zeros((0, 2)))
    tables: RadialTable = NO_TABLES

    def points(self, contacts: PointContacts) -> PressedPoints:
        """Discs or cells of point contacts by force or depth."""
        by = DEPTH if contacts.by == "depth" else FORCE
        while True:
            stacks, limited, patches, fault, how = spread_stacks(
                contacts.values, contacts.counts, by, self.keys, self.tables, self.cells
            )
            if fault[2] != FINE:
                return PressedPoints(stacks, limited, patches, fault, {})
            if not (how == NO_TABLE).any():
                break
            self._add_tables(contacts)
        on_lattice = {}
        for skin in np.flatnonzero(how == BY_LATTICE).tolist():
            own = self.on_lattice(contacts.values[skin, : contacts.counts[skin]], by)
            on_lattice[skin], limited[skin] = own.touched, own.limited
            patches[skin, : len(own.radius)] = own.radius
        return PressedPoints(stacks, limited, patches, fault, on_lattice)

    def on_lattice(self, own: Real, by: int) -> LatticePress:
        """Press by contacts. own: see `contact_types.COLUMNS`, shape (contact, 7)."""
        strain, radius = np.array(
            [winkler_patch(each, by, self.foam, self.cells) for each in own]
        ).T
        wide, high = (np.where(radius > 0, radius, own[:, side] / 2) for side in (WIDTH, HEIGHT))
        x, y = own[:, X], own[:, Y]
        boxes = np.stack([x - wide, x + wide, y - high, y + high], axis=-1)
        bodies = Bodies.by_depth(boxes, radius, strain * self.foam.thickness)
        bodies = bodies._replace(curvature=own[:, CURVATURE].copy())
        strength, deepest = own[:, STRENGTH], self.foam.deepest
        if by == FORCE:
            bodies = bodies._replace(force=strength.copy())
        rise, depth = pressed(self.lattice(2 * float(np.minimum(wide, high).min())), bodies)
        limited = depth >= deepest if by == FORCE else strength > deepest
        return LatticePress(touched(rise), depth, radius, bool(limited.any()))

    def under_pressure(self, image: PressureImage, skin: int) -> tuple[TouchedCells, bool]:
        """Cells under an image of pressure, and True if the foam was limited to its largest
        strain."""
        values, (rows, columns) = image.values[skin], image.values.shape[1:]
        if not values.any():
            return NOTHING, False
        lattice = self.lattice(np.inf)
        here = slice(0, self.grid[0]), slice(0, self.grid[1])
        row, column = (
            np.minimum(at / side * count, count - 1).astype(np.int64)
            for at, side, count in (
                (lattice.y, self.skin.width, rows),
                (lattice.x, self.skin.length, columns),
            )
        )
        w = under_pressure(lattice, values[np.ix_(row, column)], here)
        rise = lattice.in_cells(lattice.rises(w), here)
        return touched(rise), bool((w >= self.foam.deepest).any())

    def lattice(self, smallest: float) -> Lattice:
        """Lattice for contacts of a smallest side, m."""
        assert self.skin.foam.mechanics is not None
        spread = self.skin.foam.mechanics.spread(self.foam.thickness)
        size = np.clip(smallest, FINEST * spread, min(self.skin.sides))
        own = lattice_of(self.skin, self.grid, float(2.0 ** np.floor(np.log2(size))))
        return replace(own, law=self.foam)

    def _add_tables(self, contacts: PointContacts) -> None:
        there = np.arange(contacts.values.shape[1]) < contacts.counts[:, None]
        own = contacts.values[there][:, [RADIUS, CURVATURE]]
        needed = {(*key,) for key in own[np.isfinite(own).any(axis=1)].tolist()}
        known = dict(zip(map(tuple, self.keys.tolist()), self.tables.each(), strict=True))
        if len(needed | {*known}) > MAX_TABLES:
            known = {key: table for key, table in known.items() if key in needed}
        for key in needed - {*known}:
            known[key] = radial_table(self.lattice(np.inf), *key)
        self.keys = np.array([*known])
        self.tables = RadialTable._make(
            np.stack(each) for each in zip(*known.values(), strict=True)
        )
