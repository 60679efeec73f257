"""Point contacts on skins with tension: from tables where contacts are alone, else on a lattice."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...press.batch import PressBatch
from .contact_types import PointContacts
from .membrane_contacts import Membrane
from .patch_kernel import CURVATURE, DEPTH, FORCE, RADIUS
from .radial_tables import NO_TABLES, RadialTable, radial_table

MAX_TABLES = 256
"""Number of tables above which those are dropped that the latest contacts do not need."""


class PressedPoints(NamedTuple):
    """Point contacts on cells.

    limited: True for presses whose foam was limited to its largest strain, shape (press,). patches:
    radius of each patch, m, 0 for a rectangle, shape (press, contact). fault: press, contact and
    reason of the first invalid contact, shape (3,).
    """

    batch: PressBatch
    limited: NDArray[np.bool_]
    patches: NDArray[np.float64]
    fault: NDArray[np.int64]


@dataclass(eq=False)
class SpreadPoints:
    """Rasterizer of point contacts on skins with tension, with tables of the indenters so far.

    keys: radius and curvature radius of each table, m, shape (table, 2).
    """

    membrane: Membrane
    keys: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2)))
    tables: RadialTable = NO_TABLES

    def __call__(self, contacts: PointContacts) -> PressedPoints:
        """Cells of point contacts by force or depth."""
        from .spread_kernel import BY_LATTICE, NO_TABLE, spread_cells

        foam, cells = self.membrane.foam, self.membrane.cells
        by = DEPTH if contacts.by == "depth" else FORCE
        while True:
            *batch, limited, how, patches, fault = spread_cells(
                contacts.values, contacts.counts, by, self.keys, *self.tables, *foam, *cells
            )
            if fault[2] or not (how == NO_TABLE).any():
                break
            self._add_tables(contacts)
        found = PressedPoints(PressBatch(*batch), limited, patches, fault)
        on_lattice = np.flatnonzero(how == BY_LATTICE)
        return self._with_lattice(contacts, found, on_lattice) if len(on_lattice) else found

    def _with_lattice(
        self, contacts: PointContacts, found: PressedPoints, skins: NDArray[np.int64]
    ) -> PressedPoints:
        each = [*found.batch.each()]
        for skin in skins.tolist():
            own = self.membrane.under_points(contacts, skin)
            each[skin], found.limited[skin] = own.touched, own.limited
            found.patches[skin, : len(own.radius)] = own.radius
        return found._replace(batch=PressBatch.of(each))

    def _add_tables(self, contacts: PointContacts) -> None:
        there = np.arange(contacts.values.shape[1]) < contacts.counts[:, None]
        own = contacts.values[there][:, [RADIUS, CURVATURE]]
        needed = {(*key,) for key in own[np.isinf(own).any(axis=1)].tolist()}
        known = dict(zip(map(tuple, self.keys.tolist()), self.tables.each(), strict=True))
        if len(needed | {*known}) > MAX_TABLES:
            known = {key: table for key, table in known.items() if key in needed}
        for key in needed - {*known}:
            known[key] = radial_table(
                self.membrane.scene, self.membrane.foam, *key, self.membrane.reach
            )
        self.keys = np.array([*known])
        self.tables = RadialTable(*map(np.stack, zip(*known.values(), strict=True)))
