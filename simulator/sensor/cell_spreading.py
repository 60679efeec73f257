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

from ..press.batch import PressBatch
from ..scene.parts import Skin

PARTS = 4
"""Fine cells along each side of a coarse one."""


class CellSpreading(NamedTuple):
    """Spreading onto a grid (rows, columns) whose cells are divided into parts along each side."""

    grid: tuple[int, int]
    parts: int

    def __call__(self, batch: PressBatch) -> PressBatch:
        """Presses on coarse cells. Fingers, numbered as in `Parts`, are spread as well."""
        from .spreading_kernel import spread

        return spread(PressBatch._make(map(np.ascontiguousarray, batch)), self.grid, self.parts)


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
