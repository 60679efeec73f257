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
from numpy.typing import NDArray

from ..press.batch import PressBatch
from ..scene.scene import Scene

PARTS = 4
"""Fine cells along each side of a coarse one."""
NEIGHBOURS = 3
"""Number of coarse cells along an axis that share a fine one."""


class AxisShares(NamedTuple):
    """Shares of fine cells along one axis.

    first: first of NEIGHBOURS coarse cells, shape (fine,). share: of each, shape (fine,
    NEIGHBOURS), 0 beyond the skin.
    """

    first: NDArray[np.int64]
    share: NDArray[np.float64]

    @classmethod
    def of(cls, coarse: int, parts: int) -> Self:
        """Shares for coarse cells that are each divided into equal parts."""
        cell, part = np.divmod(np.arange(coarse * parts), parts)
        t = (part + 0.5) / parts - 0.5
        first, share = cell - 1, _inner_shares(t, 1 / parts)
        low, high = cell == 0, cell == coarse - 1
        zero = np.zeros(len(t))
        share[low] = np.stack([zero, 1 - t, t], axis=1)[low] if coarse > 1 else [0.0, 1.0, 0.0]
        if coarse > 1:
            share[high] = np.stack([-t, 1 + t, zero], axis=1)[high]
        return cls(first, share)


def _inner_shares(t: NDArray[np.float64], width: float) -> NDArray[np.float64]:
    """Shares of a part at t from the middle of its cell; t and width over that of the cell."""
    second = t**2 + (width**2 - 1) / 12
    return np.stack([(second - t) / 2, 1 - second, (second + t) / 2], axis=1)


class CellSpreading(NamedTuple):
    """Spreading from fine cells to coarse ones. down: along rows. along: along columns."""

    down: AxisShares
    along: AxisShares

    @classmethod
    def of(cls, grid: tuple[int, int], parts: int) -> Self:
        """Spreading onto a grid (rows, columns) whose cells are divided along each side."""
        rows, columns = grid
        return cls(AxisShares.of(rows, parts), AxisShares.of(columns, parts))

    def __call__(self, batch: PressBatch) -> PressBatch:
        """Presses on coarse cells. Fingers, numbered as in `Parts`, are spread as well."""
        from .spreading_kernel import spread

        cells, rises, starts = (np.ascontiguousarray(each) for each in batch)
        return PressBatch(*spread(cells, rises, starts, *self.down, *self.along))


class SkinCells(NamedTuple):
    """Cells of a skin: those on which contacts are rasterized, and the coarser ones of its model.

    fine, coarse: rows and columns. spreading: from the first to the second; None if they are equal.
    """

    fine: tuple[int, int]
    coarse: tuple[int, int]
    spreading: CellSpreading | None

    @classmethod
    def of(cls, scene: Scene, coarse: tuple[int, int]) -> Self:
        """Cells for a model's grid (rows, columns).

        Both are equal unless the skin is a rectangle without walls around pressed cells.
        """
        around = scene.surroundings
        if not scene.skin.rectangular or (around is not None and around.edges):
            return cls(coarse, coarse, None)
        rows, columns = coarse
        return cls((PARTS * rows, PARTS * columns), coarse, CellSpreading.of(coarse, PARTS))

    def spread(self, batch: PressBatch) -> PressBatch:
        """Presses of fine cells on those of the model."""
        return batch if self.spreading is None else self.spreading(batch)
