"""Presses on fine cells, spread over the coarser cells of a model so that moments are kept.

A rise of c on a fine cell is shared between three coarse cells along each axis, so that its
integral with every polynomial of degree 2 is kept, as if c were constant in each coarse cell. The
potential varies over more than a cell, so readings change by the third order of the cells' size
only. Presses of whole coarse cells are kept as they are. At the border of the skin two cells share,
and polynomials of degree 1 are kept.
"""

from __future__ import annotations

from typing import NamedTuple, Self

import numpy as np

from ..compiled import compiled
from ..press.batch import PressBatch
from ..press.cell_kernel import FAINT, add_point, empty_batch, moved_to_batch
from ..scene.parts import Skin

PARTS = 4
"""Fine cells along each side of a coarse one."""


class CellSpreading(NamedTuple):
    """Spreading onto a grid (rows, columns) whose cells are divided into parts along each side."""

    grid: tuple[int, int]
    parts: int

    def __call__(self, batch: PressBatch) -> PressBatch:
        """Presses on coarse cells. Fingers, numbered as in `Parts`, are spread as well."""
        return _spread(PressBatch._make(map(np.ascontiguousarray, batch)), self.grid, self.parts)


class SkinCells(NamedTuple):
    """Cells of a skin: those on which contacts are rasterized, and the coarser ones of its model.

    fine, coarse: rows and columns. spreading: from the first to the second; None if they are equal.
    """

    fine: tuple[int, int]
    coarse: tuple[int, int]
    spreading: CellSpreading | None

    @classmethod
    def of(cls, skin: Skin, coarse: tuple[int, int]) -> Self:
        """Cells for a model's grid (rows, columns).

        Both are equal unless the skin is a rectangle without walls around pressed cells.
        """
        around = skin.around
        if not skin.rectangular or (around is not None and around.edges):
            return cls(coarse, coarse, None)
        rows, columns = coarse
        return cls((PARTS * rows, PARTS * columns), coarse, CellSpreading(coarse, PARTS))

    def spread(self, batch: PressBatch) -> PressBatch:
        """Presses of fine cells on those of the model."""
        return batch if self.spreading is None else self.spreading(batch)


@compiled()
def _spread(batch: PressBatch, grid: tuple[int, int], parts: int) -> PressBatch:
    """Presses of `CellSpreading`, compiled."""
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
