"""Cells of a grid that presses touch: of one press, and of many in one batch."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from ..arrays import Integer, Mask, Real


class TouchedCells(NamedTuple):
    """One press: cells, counted row by row from 0, and the rises of c there over its unpressed
    value."""

    cells: Integer
    rises: Real


NOTHING = TouchedCells(np.zeros(0, dtype=np.int64), np.zeros(0))


def joined_cells(*touched: TouchedCells) -> TouchedCells:
    """Join touched cells to one press."""
    cells = np.concatenate([each.cells for each in touched])
    return TouchedCells(cells, np.concatenate([each.rises for each in touched]))


class PressBatch(NamedTuple):
    """Many presses: press k touches cells[starts[k]:starts[k + 1]] with their rises."""

    cells: Integer
    rises: Real
    starts: Integer

    @classmethod
    def of(cls, presses: Iterable[tuple[Integer, Real]]) -> PressBatch:
        """Batch from the cells and rises of each press."""
        cells, rises = zip(NOTHING, *presses, strict=True)
        starts = np.cumsum([len(own) for own in cells], dtype=np.int64)
        return cls(np.concatenate(cells), np.concatenate(rises), starts)

    @classmethod
    def even(cls, cells: Integer, rises: Real) -> PressBatch:
        """Batch of presses of equally many cells: both of shape (press, cell), or broadcasting to
        it."""
        cells, rises = np.broadcast_arrays(cells, rises)
        count, each = cells.shape
        return cls(cells.flatten(), rises.flatten(), np.arange(count + 1) * each)

    @classmethod
    def on_grid(cls, rises: Real) -> PressBatch:
        """Batch from rises on every cell, shape (press, cell), without those that are 0."""
        press, cells = np.nonzero(rises)
        return cls(cells, rises[press, cells], np.searchsorted(press, np.arange(len(rises) + 1)))

    @property
    def count(self) -> int:
        """Number of presses."""
        return len(self.starts) - 1

    @property
    def press(self) -> Integer:
        """Number of the press of each cell, shape (cell,)."""
        return np.repeat(np.arange(self.count), np.diff(self.starts))

    def one(self, press: int) -> TouchedCells:
        """Touched cells of one press."""
        here = slice(self.starts[press], self.starts[press + 1])
        return TouchedCells(self.cells[here], self.rises[here])

    def each(self) -> Iterator[TouchedCells]:
        """Touched cells of each press in turn."""
        return map(self.one, range(self.count))

    def where(self, kept: Mask) -> PressBatch:
        """Same presses with some of their cells; kept: shape (cell,)."""
        starts = np.concatenate([[0], np.cumsum(kept)])[self.starts]
        return PressBatch(self.cells[kept], self.rises[kept], starts)

    def and_(self, other: PressBatch) -> PressBatch:
        """Each press with the cells of the same press in another batch."""
        if not other.cells.size:
            return self
        order = np.argsort(np.concatenate([self.press, other.press]), kind="stable")
        cells = np.concatenate([self.cells, other.cells])[order]
        rises = np.concatenate([self.rises, other.rises])[order]
        return PressBatch(cells, rises, self.starts + other.starts)

    def weighted(self, unpressed_factors: Real) -> PressBatch:
        """Rises for a skin whose cells have these factors relative to the reference of the rises,
        shape (cell,)."""
        return self._replace(rises=self.rises * unpressed_factors[self.cells])
