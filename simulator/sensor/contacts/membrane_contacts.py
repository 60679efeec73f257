"""Contacts on foam under skins with tension, which deflect beside the contact as well.

The skins are a membrane on the foam: T div grad w = p(w / d) - q, with the deflection w, the
tension T, the foam's pressure p and thickness d, and the pressure q on the skin. It is solved on a
lattice of nodes, see `models.mechanics.lattice`. Indenters are rigid; a force moves its indenter
until foam and skins return it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ...arrays import Integer, Real
from ...models.mechanics.foam_law import FoamTables
from ...models.mechanics.lattice.relaxed_presses import (
    FAINT,
    MAX_RELAXATION_SWEEPS,
    SLOWEST,
    STILL,
    LatticeApplicators,
    Window,
    in_cells,
    independent,
    window,
)
from ...models.mechanics.lattice.skin_lattice import Lattice, lattice_of
from ...press.batch import NOTHING, TouchedCells
from ...scene.parts import Skin
from ...sweeps import ToleranceError
from .contact_types import PointContacts, PressureImage
from .grid_cells import GridCells
from .membrane_kernel import MembraneLaw, RigidBodies, relaxed_under
from .membrane_nodes import WindowNodes
from .patch_kernel import CURVATURE, DEPTH, FORCE, HEIGHT, STRENGTH, WIDTH, X, Y, area_on_skin
from .winkler_kernel import winkler_patch

EMPTY, TINY = np.zeros(0), 1e-30
FINEST = 0.5
"""Smallest size that nodes resolve, over the length in which the skins spread a press."""


class MembraneCells(NamedTuple):
    """Cells of one press.

    depth, radius: of each contact and its patch, m; 0 for the radius of a rectangle. limited: True
    if the foam was limited to its largest strain.
    """

    touched: TouchedCells
    depth: Real
    radius: Real
    limited: bool


@dataclass(frozen=True, eq=False)
class ContactMembrane:
    """Skins with tension on the foam of a scene, and the grid (rows, columns) of cells."""

    skin: Skin
    grid: tuple[int, int]
    foam: FoamTables
    cells: GridCells

    @cached_property
    def reach(self) -> float:
        """Distance from a contact beyond which it has no influence, m."""
        return self._lattice(np.inf).reach(self.foam.deepest)

    def under_points(self, contacts: PointContacts, skin: int) -> MembraneCells:
        """Cells under the contacts of one skin. Raises ToleranceError without convergence."""
        own = contacts.values[skin, : contacts.counts[skin]]
        depth, rise = np.zeros(len(own)), np.zeros(self.grid)
        if not (own[:, STRENGTH] > 0).any():
            return MembraneCells(_touched(rise), depth, depth, False)
        at_most, radius = self._patches(own, contacts.by)
        lattice = self._lattice(
            float(np.where(radius > 0, 2 * radius, own[:, WIDTH:].min(axis=1)).min())
        )
        applied = self._applied(own, radius, at_most)
        for group in _groups(lattice, applied):
            part = LatticeApplicators(*(each[group] for each in applied))
            here = window(lattice, part)
            if contacts.by == "force" and not independent(lattice, part, reach=0.0):
                w, depth[group] = self._under_loads(lattice, own[group], part, here)
            else:
                w, depth[group] = self._relaxed(lattice, own[group], part, here, contacts.by)
            rise[here] += in_cells(lattice, self._rise(w), here)
        limited = bool((depth >= self.foam.deepest).any())
        if contacts.by == "depth":
            limited = bool((own[:, STRENGTH] > self.foam.deepest).any())
        return MembraneCells(_touched(rise), depth, radius, limited)

    def under_pressure(self, image: PressureImage, skin: int) -> MembraneCells:
        """Cells under an image of pressure. Raises ToleranceError without convergence."""
        values, (rows, columns) = image.values[skin], image.values.shape[1:]
        lattice = self._lattice(np.inf)
        here = slice(0, self.grid[0]), slice(0, self.grid[1])
        if not values.any():
            return MembraneCells(NOTHING, EMPTY, EMPTY, False)
        row, column = (
            np.minimum(at / side * count, count - 1).astype(np.int64)
            for at, side, count in (
                (lattice.y, self.skin.width, rows),
                (lattice.x, self.skin.length, columns),
            )
        )
        w = self._under_load(lattice, here, values[np.ix_(row, column)])
        touched = _touched(in_cells(lattice, self._rise(w), here))
        return MembraneCells(touched, EMPTY, EMPTY, bool((w >= self.foam.deepest).any()))

    def _patches(self, own: Real, by: str) -> tuple[Real, ...]:
        """Largest depth of each contact, m, and the radius of its patch at that depth.

        Without tension the indenter would go deeper. The radius is 0 for rectangles.
        """
        how = DEPTH if by == "depth" else FORCE
        each = [winkler_patch(contact, how, self.foam, self.cells) for contact in own]
        strain, radius = np.array(each).T
        return strain * self.foam.thickness, radius

    def _lattice(self, smallest: float) -> Lattice:
        mechanics = self.skin.foam.mechanics
        assert mechanics is not None
        spread = np.sqrt(mechanics.tension * self.foam.thickness / mechanics.young)
        size = np.clip(smallest, FINEST * spread, min(self.skin.sides))
        return lattice_of(self.skin, self.grid, float(2.0 ** np.floor(np.log2(size))))

    def _applied(self, own: Real, radius: Real, depth: Real) -> LatticeApplicators:
        wide = np.where(radius > 0, radius, own[:, WIDTH] / 2)
        high = np.where(radius > 0, radius, own[:, HEIGHT] / 2)
        x, y = own[:, X], own[:, Y]
        return LatticeApplicators(
            np.stack([x - wide, x + wide, y - high, y + high], axis=-1), radius, depth
        )

    def _relaxed(
        self,
        lattice: Lattice,
        own: Real,
        applied: LatticeApplicators,
        here: Window,
        by: str,
        w: Real | None = None,
        pressure: Real | None = None,
    ) -> tuple[Real, Real]:
        """Deflection at the nodes of a window and depth of each contact, m."""
        nodes, tension = WindowNodes.of(lattice, here), lattice.mechanics.tension
        flat = np.isinf(own[:, CURVATURE])
        area, band = np.zeros(len(own)), 0.0
        if flat.any():
            each = zip(own[flat], applied.radius[flat], strict=True)
            area[flat] = [area_on_skin(contact, radius, self.cells) for contact, radius in each]
            under = LatticeApplicators(*(each[flat] for each in applied))
            nodes, band = nodes.cut_at_edges(under, area.sum() / tension)
        half = np.diff(applied.boxes)[:, ::2] / 2
        shapes = np.column_stack([own[:, [X, Y]], half, applied.radius, own[:, CURVATURE]])
        force = own[:, STRENGTH].copy() if by == "force" else np.full(len(own), np.nan)
        bodies = RigidBodies(shapes, area, band, force, applied.depth.copy())
        deepest = float(applied.depth.max()) if w is None else float(w.max())
        w = np.zeros(nodes.load.shape) if w is None else w
        pressure = np.zeros(w.shape) if pressure is None else pressure
        sides = max(np.ptp(nodes.x), np.ptp(nodes.y))
        slowest = min(SLOWEST * lattice.falls_within(deepest), sides)
        relaxed = 2 / (1 + np.pi * min(lattice.steps) / slowest)
        law = MembraneLaw(lattice.law, lattice.per_metre, tension, self.foam.deepest)
        limits = relaxed, STILL * deepest, MAX_RELAXATION_SWEEPS
        swept = relaxed_under(w, pressure, nodes, law, bodies, *limits)
        if swept > MAX_RELAXATION_SWEEPS:
            raise ToleranceError(
                f"{self.skin.name}: the relaxation of the foam under contacts does not converge"
            )
        return w, bodies.depth

    def _under_load(self, lattice: Lattice, here: Window, pressure: Real) -> Real:
        """Deflection at the nodes of a window under a pressure alone, m."""
        alone = self.foam.strains_under(np.minimum(pressure, self.foam.closed))
        nobody = LatticeApplicators(np.zeros((0, 4)), np.zeros(0), np.zeros(0))
        start = alone * self.foam.thickness
        w, _ = self._relaxed(lattice, np.zeros((0, 7)), nobody, here, "force", start, pressure)
        return w

    def _under_loads(
        self,
        lattice: Lattice,
        own: Real,
        applied: LatticeApplicators,
        here: Window,
    ) -> tuple[Real, Real]:
        """Deflection at the nodes of a window and at each contact, m, under overlapping patches.

        Overlapping indenters are not rigid bodies: each contact is a load, with the pressure that
        foam without tension returns, and pressures add.
        """
        nodes, elastic = lattice.nodes(here), lattice.mechanics.elastic
        x, y, part = lattice.x[nodes[1]], lattice.y[nodes[0]], lattice.part[nodes]
        area, pressure = np.prod(lattice.steps) * part, np.zeros(part.shape)
        for contact, radius, depth in zip(own, applied.radius, applied.depth, strict=True):
            along, across = x - contact[X], (y - contact[Y])[:, None]
            far = along**2 + across**2
            flat = (abs(along) <= contact[WIDTH] / 2) & (abs(across) <= contact[HEIGHT] / 2)
            under = far <= radius**2 if radius else flat
            surface = (depth - far / (2 * contact[CURVATURE])) / self.foam.thickness
            load = np.where(under, elastic.stress(surface.clip(0.0)), 0.0)
            pressure += load * (contact[STRENGTH] / max((load * area).sum(), TINY))
        w = self._under_load(lattice, here, pressure)
        row, column = np.abs(y - own[:, [Y]]).argmin(axis=1), np.abs(x - own[:, [X]]).argmin(axis=1)
        return w, w[row, column]

    def _rise(self, w: Real) -> Real:
        return self.skin.foam.factor_at(w / self.foam.thickness) - 1


def _touched(rise: Real) -> TouchedCells:
    cells = np.flatnonzero(rise > FAINT)
    return TouchedCells(cells, rise.ravel()[cells])


def _groups(lattice: Lattice, applied: LatticeApplicators) -> list[Integer]:
    """Numbers of the applicators of each group that may influence each other."""
    far = np.array([lattice.reach(depth) if depth > 0 else 0.0 for depth in applied.depth])
    low = applied.boxes[:, ::2] - far[:, None]
    high = applied.boxes[:, 1::2] + far[:, None]
    group = np.arange(len(far))
    for k in range(len(far)):
        for m in range(k):
            if ((low[k] < high[m]) & (low[m] < high[k])).all():
                group[group == group[k]] = group[m]
    return [np.flatnonzero(group == number) for number in np.unique(group)]
