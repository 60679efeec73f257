"""Point contacts on skins with tension, from tables of round indenters, compiled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from ...press.cell_kernel import box_cells
from ...press.pixels import GridCells
from .patch_kernel import (
    CURVATURE,
    DEPTH,
    FINE,
    RADIUS,
    STRENGTH,
    WIDTH,
    Fault,
    Stacks,
    X,
    Y,
    patch_box,
    reason_invalid,
    within_borders,
)
from .radial_tables import RadialTable

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
