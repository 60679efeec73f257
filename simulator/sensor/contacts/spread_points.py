"""Point contacts on skins with tension: from tables where contacts are alone, else on a lattice."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ...arrays import Mask, Real
from ...press.batch import TouchedCells
from .contact_types import PointContacts
from .membrane_contacts import ContactMembrane
from .patch_kernel import CURVATURE, DEPTH, FINE, FORCE, RADIUS, Fault, Stacks
from .radial_tables import NO_TABLES, RadialTable, radial_table

MAX_TABLES = 256
"""Number of tables above which those are dropped that the latest contacts do not need."""


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


@dataclass(eq=False)
class SpreadPoints:
    """Rasterizer of point contacts on skins with tension, with tables of the indenters so far.

    keys: radius and curvature radius of each table, m, shape (table, 2).
    """

    membrane: ContactMembrane
    keys: Real = field(default_factory=lambda: np.zeros((0, 2)))
    tables: RadialTable = NO_TABLES

    def __call__(self, contacts: PointContacts) -> PressedPoints:
        """Discs or cells of point contacts by force or depth."""
        from .spread_kernel import BY_LATTICE, NO_TABLE, spread_stacks

        by = DEPTH if contacts.by == "depth" else FORCE
        while True:
            stacks, limited, patches, fault, how = spread_stacks(
                contacts.values, contacts.counts, by, self.keys, self.tables, self.membrane.cells
            )
            if fault[2] != FINE:
                return PressedPoints(stacks, limited, patches, fault, {})
            if not (how == NO_TABLE).any():
                break
            self._add_tables(contacts)
        on_lattice = {}
        for skin in np.flatnonzero(how == BY_LATTICE).tolist():
            own = self.membrane.under_points(contacts, skin)
            on_lattice[skin], limited[skin] = own.touched, own.limited
            patches[skin, : len(own.radius)] = own.radius
        return PressedPoints(stacks, limited, patches, fault, on_lattice)

    def _add_tables(self, contacts: PointContacts) -> None:
        there = np.arange(contacts.values.shape[1]) < contacts.counts[:, None]
        own = contacts.values[there][:, [RADIUS, CURVATURE]]
        needed = {(*key,) for key in own[np.isfinite(own).any(axis=1)].tolist()}
        known = dict(zip(map(tuple, self.keys.tolist()), self.tables.each(), strict=True))
        if len(needed | {*known}) > MAX_TABLES:
            known = {key: table for key, table in known.items() if key in needed}
        for key in needed - {*known}:
            known[key] = radial_table(
                self.membrane.skin,
                self.membrane.foam,
                key[0],
                key[1],
                self.membrane.reach,
            )
        self.keys = np.array([*known])
        self.tables = RadialTable._make(
            np.stack(each) for each in zip(*known.values(), strict=True)
        )
