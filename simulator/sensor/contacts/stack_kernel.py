"""Stacks of discs under contacts on the cells of a grid, compiled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from ...models.mechanics.foam_law import FoamTables
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
from .patch_kernel import FACTOR, Stacks, of_press, patch_box, skin_of_cell
from .shared_patches import joint_minus_sum, overlap_box


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
