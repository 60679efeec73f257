"""Stacks of discs under contacts on the cells of a grid, and the rise where they overlap."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from ...models.mechanics.foam_law import FoamTables, rise_at, strain_under, stress
from ...press.batch import PressBatch
from ...press.cell_kernel import (
    CELLS_AT_FIRST,
    FAINT,
    Box,
    add_patch,
    box_cells,
    empty_batch,
    moved_to_batch,
)
from ...press.pixels import SAMPLES, GridCells
from .patch_kernel import (
    ADDED,
    CURVATURE,
    FACTOR,
    FORCE,
    HEIGHT,
    RADIUS,
    ROUNDING,
    WIDTH,
    Stacks,
    X,
    Y,
    of_press,
    patch_box,
    skin_of_cell,
)

MAX_BITS = 62


@compiled()
def cells_of_stacks(
    values: NDArray,
    counts: NDArray,
    by: int,
    stacks: Stacks,
    limited: NDArray,
    foam: FoamTables,
    cells: GridCells,
) -> PressBatch:
    """Presses on the cells of a grid, each of a number of contacts with stacks of discs.

    values: see `contact_types.COLUMNS`, shape (press, contact, 7). counts: contacts of each press.
    Where patches of forces or depths overlap, a correction is sampled; `limited` becomes True where
    that needs more than the largest strain.
    """
    presses, (rows, columns) = len(values), cells.cut.shape
    batch, found = empty_batch(presses, CELLS_AT_FIRST * presses), 0
    unpressed = 1.0 if by == FACTOR else 0.0
    total = np.full((rows, columns), unpressed)
    for press in range(presses):
        span = columns, 0, rows, 0
        for k in range(counts[press]):
            for disc in range(stacks.discs[press, k]):
                radius, rise = stacks.radii[press, k, disc], stacks.rises[press, k, disc]
                box = patch_box(values[press, k], radius)
                span = add_patch(total, span, box, radius, rise, by == FACTOR, cells)
        if by < FACTOR and counts[press] > 1:
            contacts, own = values[press, : counts[press]], of_press(stacks, press)
            limited[press] |= _add_overlaps(contacts, by, own, foam, cells, total)
        batch, found = moved_to_batch(total, span, unpressed, FAINT, batch, found)
        batch.starts[press + 1] = found
    return PressBatch(batch.cells[:found], batch.rises[:found], batch.starts)


@compiled()
def _add_overlaps(
    contacts: NDArray, by: int, own: Stacks, foam: FoamTables, cells: GridCells, total: NDArray
) -> bool:
    """Correct the summed rises of cells where patches overlap; True if one was limited.

    The correction is sampled in a rectangle around all overlaps.
    """
    left, right, bottom, top = overlap_box(contacts, by, own)
    if left >= right:
        return False
    x, y, limited = cells.x, cells.y, False
    span = box_cells((left, right, bottom, top), cells)
    for i in range(span[2], span[3]):
        for j in range(span[0], span[1]):
            sides = max(left, x[j]), min(right, x[j + 1]), max(bottom, y[i]), min(top, y[i + 1])
            change, beyond = _overlap_rise(contacts, by, own, foam, sides, i, j, cells)
            limited |= beyond
            if cells.part[i, j] > 0.0:
                area = (sides[1] - sides[0]) * (sides[3] - sides[2])
                total[i, j] += change * area / skin_of_cell(i, j, cells)
    return limited


@compiled()
def _overlap_rise(
    contacts: NDArray,
    by: int,
    own: Stacks,
    foam: FoamTables,
    sides: Box,
    i: int,
    j: int,
    cells: GridCells,
) -> tuple[float, bool]:
    """Rise under all patches minus the sum of their own, averaged over a rectangle in a cell.

    True if a strain was limited.
    """
    x, y, cut, total, limited = cells.x, cells.y, cells.cut[i, j], 0.0, False
    for k in range(SAMPLES):
        at_y = sides[2] + (k + 0.5) / SAMPLES * (sides[3] - sides[2])
        row = min(int((at_y - y[i]) / (y[i + 1] - y[i]) * SAMPLES), SAMPLES - 1)
        for m in range(SAMPLES):
            at_x = sides[0] + (m + 0.5) / SAMPLES * (sides[1] - sides[0])
            column = min(int((at_x - x[j]) / (x[j + 1] - x[j]) * SAMPLES), SAMPLES - 1)
            if cut >= 0 and not cells.mask[cut, row, column]:
                continue
            change, beyond = joint_minus_sum(contacts, by, own, foam, at_x, at_y)
            limited |= beyond
            total += change
    return total / SAMPLES**2, limited


@compiled()
def overlap_box(contacts: NDArray, by: int, stacks: Stacks) -> Box:
    """Rectangle around all overlaps of patches, m; infinite and reversed if there is none.

    Capacitances to earth of ADDED touches and spread contacts add, and have none.
    """
    left, right, bottom, top = np.inf, -np.inf, np.inf, -np.inf
    if by == ADDED:
        return left, right, bottom, top
    for k in range(len(contacts)):
        for m in range(k):
            own = stacks.radii[k, stacks.discs[k] - 1]
            other = stacks.radii[m, stacks.discs[m] - 1]
            if not _meet(contacts[k], contacts[m], own, other):
                continue
            one, two = patch_box(contacts[k], own), patch_box(contacts[m], other)
            left, right = min(left, max(one[0], two[0])), max(right, min(one[1], two[1]))
            bottom, top = min(bottom, max(one[2], two[2])), max(top, min(one[3], two[3]))
    return left, right, bottom, top


@compiled()
def _meet(one: NDArray, other: NDArray, radius: float, its: float) -> bool:
    """True if two patches may overlap: discs do, boxes around them do if one is a rectangle."""
    if radius > 0.0 and its > 0.0:
        far = (one[X] - other[X]) ** 2 + (one[Y] - other[Y]) ** 2
        return far < (radius + its) ** 2 * (1 - ROUNDING)
    first, second = patch_box(one, radius), patch_box(other, its)
    wide = min(first[1], second[1]) - max(first[0], second[0])
    high = min(first[3], second[3]) - max(first[2], second[2])
    return wide > ROUNDING * (first[1] - first[0]) and high > ROUNDING * (first[3] - first[2])


@compiled()
def _strain_at(
    contact: NDArray, strain: float, foam: FoamTables, at_x: float, at_y: float
) -> float:
    """Strain that a contact alone causes at a position, `strain` in its middle."""
    along, across = at_x - contact[X], at_y - contact[Y]
    if contact[WIDTH] > 0.0:
        under = abs(along) <= contact[WIDTH] / 2 and abs(across) <= contact[HEIGHT] / 2
        return strain if under else 0.0
    far = along * along + across * across
    if far > contact[RADIUS] * contact[RADIUS]:
        return 0.0
    return max(strain - far / (2 * contact[CURVATURE] * foam.thickness), 0.0)


@compiled()
def all_flat(contacts: NDArray) -> bool:
    """True if the rise is the same wherever the same patches overlap, of at most 62 contacts."""
    for contact in contacts:
        if contact[WIDTH] == 0.0 and contact[CURVATURE] < np.inf:
            return False
    return len(contacts) <= MAX_BITS


@compiled()
def contacts_over(
    contacts: NDArray, by: int, strain: NDArray, foam: FoamTables, at_x: float, at_y: float
) -> int:
    """Contacts that press a position, one bit each; of more than 62, all bits."""
    if len(contacts) > MAX_BITS:
        return -1
    found = 0
    for k in range(len(contacts)):
        deepest = 1.0 if by == FACTOR else strain[k]
        if _strain_at(contacts[k], deepest, foam, at_x, at_y) > 0.0:
            found |= 1 << k
    return found


@compiled()
def joint_minus_sum(
    contacts: NDArray, by: int, stacks: Stacks, foam: FoamTables, at_x: float, at_y: float
) -> tuple[float, bool]:
    """Rise under all patches at a position minus the sum of their own; True if it was limited.

    Pressures of forces add, of depths the deeper counts, and factors multiply.
    """
    deepest, pressure, apart, joint, under = 0.0, 0.0, 0.0, 1.0, 0
    for k in range(len(contacts)):
        if by == FACTOR:
            if _strain_at(contacts[k], 1.0, foam, at_x, at_y) > 0.0:
                rise, under = stacks.rises[k, 0], under + 1
                joint, apart = joint * (1 + rise), apart + rise
            continue
        depth = _strain_at(contacts[k], stacks.strain[k], foam, at_x, at_y)
        if depth > 0.0:
            deepest, under = max(deepest, depth), under + 1
            apart += rise_at(foam, depth)
            pressure += stress(foam, depth) if by == FORCE else 0.0
    if under < 2:
        return 0.0, False
    if by == FACTOR:
        return joint - 1 - apart, False
    limited = by == FORCE and pressure > foam.closed
    if by == FORCE:
        deepest = strain_under(foam, min(pressure, foam.closed))
    return rise_at(foam, deepest) - apart, limited
