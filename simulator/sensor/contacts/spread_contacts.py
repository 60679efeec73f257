"""Contacts on skins with tension, which deflect beside the contact as well.

Round contacts that are alone are looked up in tables of indenters; all others and images of
pressure are solved on a lattice, see `models.mechanics.lattice_presses`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Mask, Real
from ...compiled import compiled
from ...models.mechanics.foam_law import FoamTables
from ...models.mechanics.lattice_presses import pressed, relax, touched, under_pressure
from ...models.mechanics.relaxation_kernel import Bodies, Nodes
from ...models.mechanics.skin_lattice import Lattice, lattice_of
from ...press.batch import NOTHING, TouchedCells
from ...press.cell_kernel import box_cells
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
    patch_box,
    reason_invalid,
    winkler_patch,
    within_borders,
)

STEPS_PER_SPREAD = 16
"""Steps of the radius per length in which the skins spread a press."""
MAX_NODES = 4000
LEVELS = 80
DISCS = 12
NEGLIGIBLE = 3e-3
"""Rise of c, over the largest one, beyond which an indenter has no influence."""


class RadialTable(NamedTuple):
    """One indenter at depths from 0 to the largest.

    depth: m, shape (level,). force: N. radii [m], rises: discs whose rises add up to those around
    the indenter, shape (level, disc). reach: radius of its influence, m, shape (level,).
    """

    depth: Real
    force: Real
    radii: Real
    rises: Real
    reach: Real

    def each(self) -> Iterator[RadialTable]:
        """Each of several tables that are stacked along a first axis."""
        return (RadialTable(*arrays) for arrays in zip(*self, strict=True))


_LEVEL, _DISCS = np.zeros((0, 2)), np.zeros((0, 2, DISCS))
NO_TABLES = RadialTable(_LEVEL, _LEVEL, _DISCS, _DISCS, _LEVEL)
"""No indenter: stacked tables of none."""


def radial_table(lattice: Lattice, radius: float, curvature: float) -> RadialTable:
    """Table of an indenter of a radius with a spherical end of a radius of curvature, far from any
    edge of the skin of a lattice; m.

    The first is infinite for a sphere, the second for a flat end. Nodes are rings around it: a
    lattice of one row. Raises ToleranceError if the relaxation does not converge.
    """
    law, tension = lattice.law, lattice.mechanics.tension
    reach, thickness = lattice.reach(law.deepest), law.thickness
    patch = float(min(radius, np.sqrt(2 * curvature * law.deepest)))
    spread = lattice.mechanics.spread(thickness)
    step = max(min(spread, patch) / STEPS_PER_SPREAD, (patch + reach) / MAX_NODES)
    limit = int(np.ceil(patch / step))
    flat = limit if np.isinf(curvature) else 0
    step = patch / (limit if flat else limit - 0.5)  # the rim of a sphere lies on a node
    count = int(np.ceil((patch + reach) / step)) + 2
    rings = np.arange(count, dtype=np.float64) + 0.5
    area = 2 * np.pi * step**2 * rings
    arms = 2 * np.pi * (rings + 0.5)[None]
    arms[0, -1] = 0.0
    depth = _levels(law) * thickness
    w = np.zeros((len(depth), count))
    body = Bodies.by_depth(np.array([[-patch, patch, -patch, patch]]), np.array([patch]), depth[:1])
    body = body._replace(curvature=np.array([curvature]))
    at, none = (step * rings, np.zeros(1)), np.zeros_like(arms)
    for level in range(1, len(depth)):
        own = body._replace(depth=depth[[level]])
        nodes = Nodes(*at, arms.copy(), none, area[None] / tension, (step, step), tension)
        w[level] = w[level - 1]
        relax(lattice, nodes, own, w[level : level + 1], none)
    rise = lattice.rises(w)
    radii, rises = np.zeros((len(depth), DISCS)), np.zeros((len(depth), DISCS))
    stacked_rings(rise, step, flat, radii, rises)
    radii[0] = radii[1]  # without depth there are no rings
    counts = (rise > NEGLIGIBLE * rise[:, :1]).sum(axis=1)
    force = lattice.mechanics.elastic.stress(w / thickness) @ area
    return RadialTable(depth, force, radii, rises, counts * step)


def _levels(law: FoamTables) -> Real:
    """Strains of the levels, from 0: denser where the cells buckle and where they close."""
    greatest, t = law.greatest, np.linspace(0.0, 1.0, LEVELS + 1)
    if not law.elastomer:
        return t * greatest
    close = law.densified * (1 - (1 - greatest / law.densified) ** t)
    return np.unique(np.concatenate([greatest * t**1.5, close]).clip(0.0, greatest))


@compiled()
def stacked_rings(rise: NDArray, step: float, flat: int, radii: NDArray, rises: NDArray) -> None:
    """Discs of each level whose rises add up to those at the nodes, into `radii` and `rises`.

    rise: at nodes, shape (level, node). Each ring between discs takes its mean; rings are chosen so
    that the product of a ring's area and the fall of the rise over it is the same for all. A flat
    indenter is the first disc. radii: m, shape (level, disc).
    """
    levels, nodes = rise.shape
    discs = radii.shape[1]
    weight = np.zeros(nodes)
    for level in range(levels):
        total = 0.0
        for node in range(flat, nodes):
            before = rise[level, node - 1] if node > 0 else rise[level, 0]
            total += np.sqrt(max(before - rise[level, node], 0.0) * (node + 0.5))
            weight[node] = total
        first, node = 0, flat
        if flat > 0:
            radii[level, 0], rises[level, 0], first = flat * step, rise[level, 0], 1
        for disc in range(first, discs):
            until = total * (disc + 1 - first) / (discs - first)
            content, area = 0.0, 0.0
            last = disc == discs - 1
            while node < nodes and (last or weight[node] <= until or area == 0.0):
                content += rise[level, node] * (node + 0.5)
                area += node + 0.5
                node += 1
            radii[level, disc] = node * step
            rises[level, disc] = content / area if area > 0.0 else 0.0
        for disc in range(discs - 1):
            rises[level, disc] -= rises[level, disc + 1]


FROM_TABLE, BY_LATTICE, NO_TABLE = range(3)
"""How a press is computed; NO_TABLE: a table of one of its contacts is missing."""


@compiled()
def spread_stacks(
    values: NDArray,
    counts: NDArray,
    by: int,
    keys: NDArray,
    tables: RadialTable,
    cells: GridCells,
) -> tuple[Stacks, NDArray, NDArray, Fault, NDArray]:
    """Stacks under contacts, and faults; last how each press is to be computed, shape (press,).

    Presses whose contacts influence each other, reach the skin's edge or are not round have none.
    keys: radius and curvature radius of each table, m, shape (table, 2). Others and further
    results: see `winkler_stacks`.
    """
    presses, most, levels, discs = *values.shape[:2], *tables.radii.shape[1:]
    radii, rises = np.zeros((presses, most, discs)), np.zeros((presses, most, discs))
    own_discs, strain = np.zeros((presses, most), np.int64), np.zeros((presses, most))
    stacks = Stacks(radii, rises, own_discs, strain)
    patches, limited = np.zeros((presses, most)), np.zeros(presses, np.bool_)
    how, far = np.zeros(presses, np.int64), np.zeros(most)
    for press in range(presses):
        for k in range(counts[press]):
            contact = values[press, k]
            reason = reason_invalid(contact, by, cells)
            if reason != FINE:
                return stacks, limited, patches, (press, k, reason), how
            if contact[WIDTH] > 0.0 or _flat_overlap(values[press], k):
                how[press] = max(how[press], BY_LATTICE)
                continue
            table = _table_of(contact, keys)
            if table < 0:
                how[press] = NO_TABLE
                continue
            scale = tables.depth[table] if by == DEPTH else tables.force[table]
            limited[press] |= contact[STRENGTH] > scale[levels - 1]
            strength = min(contact[STRENGTH], scale[levels - 1])
            level = min(max(int(np.searchsorted(scale, strength)) - 1, 0), levels - 2)
            at = (strength - scale[level]) / (scale[level + 1] - scale[level])
            for disc in range(discs):
                radii[press, k, disc] = (1 - at) * tables.radii[table, level, disc]
                radii[press, k, disc] += at * tables.radii[table, level + 1, disc]
                rises[press, k, disc] = (1 - at) * tables.rises[table, level, disc]
                rises[press, k, disc] += at * tables.rises[table, level + 1, disc]
            own_discs[press, k] = discs if strength > 0.0 else 0
            far[k] = tables.reach[table, level + 1]
            deepest = (1 - at) * tables.depth[table, level] + at * tables.depth[table, level + 1]
            sphere = np.sqrt(2 * contact[CURVATURE] * deepest)
            patches[press, k] = min(contact[RADIUS], sphere)
            if not _alone(values[press], k, far, cells):
                how[press] = max(how[press], BY_LATTICE)
        if how[press] != FROM_TABLE:
            for k in range(counts[press]):
                own_discs[press, k] = 0
    return stacks, limited, patches, (0, 0, FINE), how


@compiled()
def _table_of(contact: NDArray, keys: NDArray) -> int:
    """Number of the table of a contact's indenter, -1 for none."""
    for table in range(len(keys)):
        if keys[table, 0] == contact[RADIUS] and keys[table, 1] == contact[CURVATURE]:
            return table
    return -1


@compiled()
def _flat_overlap(contacts: NDArray, k: int) -> bool:
    """True if a flat contact overlaps an earlier one."""
    for m in range(k):
        away = (contacts[k, X] - contacts[m, X]) ** 2 + (contacts[k, Y] - contacts[m, Y]) ** 2
        flat = contacts[k, CURVATURE] == np.inf and contacts[m, CURVATURE] == np.inf
        if flat and away < (contacts[k, RADIUS] + contacts[m, RADIUS]) ** 2:
            return True
    return False


@compiled()
def _alone(contacts: NDArray, k: int, far: NDArray, cells: GridCells) -> bool:
    """True if contact k reaches neither the skin's edge nor the reach of an earlier contact."""
    for m in range(k):
        away = (contacts[k, X] - contacts[m, X]) ** 2 + (contacts[k, Y] - contacts[m, Y]) ** 2
        if away < (far[k] + far[m]) ** 2:
            return False
    if not within_borders(contacts[k], far[k], cells):
        return False
    if cells.whole:
        return True
    span = box_cells(patch_box(contacts[k], far[k]), cells)
    for i in range(span[2], span[3]):
        for j in range(span[0], span[1]):
            if cells.cut[i, j] >= 0 or cells.part[i, j] < 1.0:
                return False
    return True


MAX_TABLES = 256
"""Number of tables above which those are dropped that the latest contacts do not need."""
FINEST = 0.5
"""Smallest size that nodes resolve, over the length in which the skins spread a press."""


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

    def points(
        self, contacts: PointContacts
    ) -> tuple[Stacks, Mask, Real, Fault, dict[int, TouchedCells]]:
        """Point contacts by force or depth: as from `winkler_stacks`, and cells by press.

        The last are of presses on the lattice, which have no stacks.
        """
        by = DEPTH if contacts.by == "depth" else FORCE
        while True:
            stacks, limited, patches, fault, how = spread_stacks(
                contacts.values, contacts.counts, by, self.keys, self.tables, self.cells
            )
            if fault[2] != FINE:
                return stacks, limited, patches, fault, {}
            if not (how == NO_TABLE).any():
                break
            self._add_tables(contacts)
        on_lattice = {}
        for skin in np.flatnonzero(how == BY_LATTICE).tolist():
            own = self.on_lattice(contacts.values[skin, : contacts.counts[skin]], by)
            on_lattice[skin], limited[skin] = own.touched, own.limited
            patches[skin, : len(own.radius)] = own.radius
        return stacks, limited, patches, fault, on_lattice

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
