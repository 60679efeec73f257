"""Cells of a grid that presses touch: of one press, and of many in one batch."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class TouchedCells(NamedTuple):
    """Of one press: cells, counted row by row from 0, and rises of c there over that at rest."""

    cells: NDArray[np.int64]
    rises: NDArray[np.float64]


NOTHING = TouchedCells(np.zeros(0, dtype=np.int64), np.zeros(0))


def together(*touched: TouchedCells) -> TouchedCells:
    """All of them as one press."""
    cells = np.concatenate([each.cells for each in touched])
    return TouchedCells(cells, np.concatenate([each.rises for each in touched]))


class PressBatch(NamedTuple):
    """Of many presses: press k touches cells[starts[k]:starts[k + 1]] with their rises."""

    cells: NDArray[np.int64]
    rises: NDArray[np.float64]
    starts: NDArray[np.int64]

    @classmethod
    def of(cls, presses: Iterable[tuple[NDArray[np.int64], NDArray[np.float64]]]) -> PressBatch:
        """Cells and rises of each press, one after the other."""
        cells, rises = zip(NOTHING, *presses, strict=True)
        starts = np.cumsum([len(own) for own in cells], dtype=np.int64)
        return cls(np.concatenate(cells), np.concatenate(rises), starts)

    @classmethod
    def even(cls, cells: NDArray[np.int64], rises: NDArray[np.float64]) -> PressBatch:
        """Presses of equally many cells: both of shape (press, cell), or what broadcasts to it."""
        cells, rises = np.broadcast_arrays(cells, rises)
        count, each = cells.shape
        return cls(cells.flatten(), rises.flatten(), np.arange(count + 1) * each)

    @classmethod
    def on_grid(cls, rises: NDArray[np.float64]) -> PressBatch:
        """Of rises on every cell, shape (press, cell): those that are not 0."""
        press, cells = np.nonzero(rises)
        return cls(cells, rises[press, cells], np.searchsorted(press, np.arange(len(rises) + 1)))

    @property
    def count(self) -> int:
        """How many presses."""
        return len(self.starts) - 1

    @property
    def press(self) -> NDArray[np.int64]:
        """To which press each cell belongs, shape (cell,)."""
        return np.repeat(np.arange(self.count), np.diff(self.starts))

    def one(self, press: int) -> TouchedCells:
        """What one of them touches."""
        here = slice(self.starts[press], self.starts[press + 1])
        return TouchedCells(self.cells[here], self.rises[here])

    def each(self) -> Iterator[TouchedCells]:
        """What one after the other touches."""
        return map(self.one, range(self.count))

    def where(self, kept: NDArray[np.bool_]) -> PressBatch:
        """The same presses of some of their cells; kept: shape (cell,)."""
        starts = np.concatenate([[0], np.cumsum(kept)])[self.starts]
        return PressBatch(self.cells[kept], self.rises[kept], starts)

    def and_(self, other: PressBatch) -> PressBatch:
        """Each press with what another batch adds to it."""
        if not other.cells.size:
            return self
        order = np.argsort(np.concatenate([self.press, other.press]), kind="stable")
        cells = np.concatenate([self.cells, other.cells])[order]
        rises = np.concatenate([self.rises, other.rises])[order]
        return PressBatch(cells, rises, self.starts + other.starts)

    def weighted(self, rest_factors: NDArray[np.float64]) -> PressBatch:
        """Of a skin whose cells are by such factors above what rises refer to, shape (cell,)."""
        return self._replace(rises=self.rises * rest_factors[self.cells])
