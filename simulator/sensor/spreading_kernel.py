"""Spreading of presses over coarser cells, compiled; see `cell_spreading`."""

from __future__ import annotations

import numpy as np

from ..compiled import compiled
from ..press.batch import PressBatch
from .contacts.cell_shares import add_point
from .contacts.stack_kernel import FAINT, empty_batch, moved_to_batch


@compiled()
def spread(batch: PressBatch, grid: tuple[int, int], parts: int) -> PressBatch:
    """Compiled form of `CellSpreading`."""
    cells, rises, starts = batch
    rows, columns = grid
    coarse, fine = rows * columns, rows * columns * parts * parts
    foam, fingers = np.zeros(grid), np.zeros(grid)
    found, count = empty_batch(len(starts) - 1, 2 * coarse), 0
    for press in range(len(starts) - 1):
        touched = False
        for k in range(starts[press], starts[press + 1]):
            is_finger = cells[k] >= fine
            i, j = (cells[k] % fine) // (columns * parts), cells[k] % (columns * parts)
            u, v, side = (j + 0.5) / parts, (i + 0.5) / parts, 1 / parts
            if is_finger:
                add_point(fingers, u, v, rises[k], side, side)
                touched = True
            else:
                add_point(foam, u, v, rises[k] * side * side, side, side)
        whole = 0, columns, 0, rows
        found, count = moved_to_batch(foam, whole, 0.0, FAINT, found, count)
        first = count
        if touched:
            found, count = moved_to_batch(fingers, whole, 0.0, 0.0, found, count)
        for k in range(first, count):
            found.cells[k] += coarse
        found.starts[press + 1] = count
    return PressBatch(found.cells[:count], found.rises[:count], found.starts)
