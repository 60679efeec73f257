"""Point contacts on skins with tension, from tables of round indenters, compiled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from .patch_kernel import (
    CURVATURE,
    DEPTH,
    FINE,
    RADIUS,
    STRENGTH,
    WIDTH,
    X,
    Y,
    box_cells,
    patch_box,
    reason_invalid,
    within_skin,
)

FROM_TABLE, BY_LATTICE, NO_TABLE = range(3)
"""How a press is computed; NO_TABLE: a table of one of its contacts is missing."""


@compiled()
def spread_stacks(
    values: NDArray,
    counts: NDArray,
    by: int,
    keys: NDArray,
    depth: NDArray,
    force: NDArray,
    radii: NDArray,
    rises: NDArray,
    reach: NDArray,
    x: NDArray,
    y: NDArray,
    cut: NDArray,
    part: NDArray,
    whole: bool,
) -> tuple[
    NDArray, NDArray, NDArray, NDArray, NDArray, NDArray, NDArray, NDArray
]:  # pragma: no cover
    """Discs of rises under contacts: their radii, rises and number, strains, and faults.

    Presses whose contacts influence each other, reach the skin's edge or are not round have none.
    keys: radius and curvature radius of each table, m, shape (table, 2). Others: see
    `radial_tables.RadialTable`, for each table, and `winkler_stacks`. Returned as there, and last
    how each press is to be computed, shape (press,).
    """
    presses, most, levels, discs = *values.shape[:2], *radii.shape[1:]
    own_radii, stacked = np.zeros((presses, most, discs)), np.zeros((presses, most, discs))
    own_discs, strain = np.zeros((presses, most), np.int64), np.zeros((presses, most))
    patches, limited = np.zeros((presses, most)), np.zeros(presses, np.bool_)
    how, fault, far = np.zeros(presses, np.int64), np.zeros(3, np.int64), np.zeros(most)
    length, width = x[len(x) - 1], y[len(y) - 1]
    for press in range(presses):
        for k in range(counts[press]):
            contact = values[press, k]
            reason = reason_invalid(contact, by, length, width)
            if reason != FINE:
                fault[0], fault[1], fault[2] = press, k, reason
                return own_radii, stacked, own_discs, strain, limited, patches, fault, how
            if contact[WIDTH] > 0.0 or _flat_overlap(values[press], k):
                how[press] = max(how[press], BY_LATTICE)
                continue
            table = _table_of(contact, keys)
            if table < 0:
                how[press] = NO_TABLE
                continue
            scale = depth[table] if by == DEPTH else force[table]
            limited[press] |= contact[STRENGTH] > scale[levels - 1]
            strength = min(contact[STRENGTH], scale[levels - 1])
            level = min(max(int(np.searchsorted(scale, strength)) - 1, 0), levels - 2)
            at = (strength - scale[level]) / (scale[level + 1] - scale[level])
            for disc in range(discs):
                own_radii[press, k, disc] = (1 - at) * radii[table, level, disc]
                own_radii[press, k, disc] += at * radii[table, level + 1, disc]
                stacked[press, k, disc] = (1 - at) * rises[table, level, disc]
                stacked[press, k, disc] += at * rises[table, level + 1, disc]
            own_discs[press, k] = discs if strength > 0.0 else 0
            far[k] = reach[table, level + 1]
            deepest = (1 - at) * depth[table, level] + at * depth[table, level + 1]
            sphere = np.sqrt(2 * contact[CURVATURE] * deepest)
            patches[press, k] = min(contact[RADIUS], sphere)
            if not _alone(values[press], k, far, x, y, cut, part, whole):
                how[press] = max(how[press], BY_LATTICE)
        if how[press] != FROM_TABLE:
            for k in range(counts[press]):
                own_discs[press, k] = 0
    return own_radii, stacked, own_discs, strain, limited, patches, fault, how


@compiled()
def _table_of(contact: NDArray, keys: NDArray) -> int:  # pragma: no cover
    """Number of the table of a contact's indenter, -1 for none."""
    for table in range(len(keys)):
        if keys[table, 0] == contact[RADIUS] and keys[table, 1] == contact[CURVATURE]:
            return table
    return -1


@compiled()
def _flat_overlap(contacts: NDArray, k: int) -> bool:  # pragma: no cover
    """True if a flat contact overlaps an earlier one."""
    for m in range(k):
        away = (contacts[k, X] - contacts[m, X]) ** 2 + (contacts[k, Y] - contacts[m, Y]) ** 2
        flat = contacts[k, CURVATURE] == np.inf and contacts[m, CURVATURE] == np.inf
        if flat and away < (contacts[k, RADIUS] + contacts[m, RADIUS]) ** 2:
            return True
    return False


@compiled()
def _alone(
    contacts: NDArray,
    k: int,
    far: NDArray,
    x: NDArray,
    y: NDArray,
    cut: NDArray,
    part: NDArray,
    whole: bool,
) -> bool:  # pragma: no cover
    """True if contact k reaches neither the skin's edge nor the reach of an earlier contact."""
    length, width = x[len(x) - 1], y[len(y) - 1]
    for m in range(k):
        away = (contacts[k, X] - contacts[m, X]) ** 2 + (contacts[k, Y] - contacts[m, Y]) ** 2
        if away < (far[k] + far[m]) ** 2:
            return False
    if not within_skin(contacts[k], far[k], length, width, True):
        return False
    if whole:
        return True
    span = box_cells(patch_box(contacts[k], far[k]), x, y)
    for i in range(span[2], span[3]):
        for j in range(span[0], span[1]):
            if cut[i, j] >= 0 or part[i, j] < 1.0:
                return False
    return True
