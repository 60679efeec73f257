"""Images of depth or pressure on the cells of a grid, compiled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from ...models.mechanics.foam_law import FoamTables, rise_at, strain_under
from ...press.batch import PressBatch
from ...press.cell_kernel import FAINT, empty_batch, moved_to_batch
from ...press.pixels import SAMPLES, GridCells
from .cell_shares import add_point
from .moment_kernel import PARTS

FINE, BAD_VALUE = range(2)
ImageFault = tuple[int, int, int, int]
"""Press, row and column of the first invalid value, and BAD_VALUE; FINE if there is none."""


@compiled()
def imaged_cells(
    images: NDArray,
    by_pressure: bool,
    foam: FoamTables,
    cells: GridCells,
    grid: tuple[int, int],
    moments: bool,
) -> tuple[PressBatch, NDArray, ImageFault]:
    """Presses of images on a grid (rows, columns), and True for those whose foam was limited.

    images: depths in m or pressures in Pa, shape (press, row, column). moments: True for cells that
    keep moments, on a rectangular skin; else the grid is that of `cells`.
    """
    presses, high, wide = images.shape
    rows, columns = grid
    batch, found = empty_batch(presses, presses * rows * columns), 0
    limited, total = np.zeros(presses, np.bool_), np.zeros((rows, columns))
    own = np.zeros((high, wide))
    for press in range(presses):
        touched = False
        for i in range(high):
            for j in range(wide):
                value = images[press, i, j]
                own[i, j] = 0.0
                if value == 0.0:
                    continue
                if not 0.0 < value < np.inf:
                    return empty_batch(presses, 0), limited, (press, i, j, BAD_VALUE)
                touched = True
                own[i, j], beyond = _rise_of(value, by_pressure, foam)
                limited[press] |= beyond
        if touched and moments:
            _add_moments(own, total)
        elif touched:
            _add_means(own, total)
            for i in range(rows):
                for j in range(columns):
                    if cells.cut[i, j] >= 0:
                        total[i, j] = _sampled(own, i, j, grid, cells.mask[cells.cut[i, j]])
        if touched:
            batch, found = moved_to_batch(total, (0, columns, 0, rows), 0.0, FAINT, batch, found)
        batch.starts[press + 1] = found
    batch = PressBatch(batch.cells[:found], batch.rises[:found], batch.starts)
    return batch, limited, (0, 0, 0, FINE)


@compiled()
def _rise_of(value: float, by_pressure: bool, foam: FoamTables) -> tuple[float, bool]:
    """Rise of c at a depth [m] or pressure [Pa]; True if the foam was limited."""
    if by_pressure:
        strain = strain_under(foam, min(value, foam.closed))
        return rise_at(foam, strain), value > foam.closed
    strain = value / foam.thickness
    return rise_at(foam, min(strain, foam.greatest)), strain > foam.greatest


@compiled()
def _add_moments(own: NDArray, total: NDArray) -> None:
    """Share an image between coarse cells so that moments are kept."""
    (high, wide), (rows, columns) = own.shape, total.shape
    across, along = rows / high, columns / wide
    down, right = int(np.ceil(across * PARTS)), int(np.ceil(along * PARTS))
    area = across * along / (down * right)
    for i in range(high):
        for j in range(wide):
            if own[i, j] == 0.0:
                continue
            for k in range(down):
                v = (i + (k + 0.5) / down) * across
                for m in range(right):
                    u = (j + (m + 0.5) / right) * along
                    add_point(total, u, v, own[i, j] * area, along / right, across / down)


@compiled()
def _add_means(own: NDArray, total: NDArray) -> None:
    """Add an image's means over each cell to `total`."""
    (high, wide), (rows, columns) = own.shape, total.shape
    for i in range(high):
        first, end = i * rows, (i + 1) * rows  # in units of 1 / high of a cell
        for j in range(wide):
            value = own[i, j] / (high * wide)
            if value == 0.0:
                continue
            left, right = j * columns, (j + 1) * columns
            for row in range(first // high, (end - 1) // high + 1):
                across = min(end, (row + 1) * high) - max(first, row * high)
                for column in range(left // wide, (right - 1) // wide + 1):
                    along = min(right, (column + 1) * wide) - max(left, column * wide)
                    total[row, column] += value * (across * along)


@compiled()
def _sampled(own: NDArray, i: int, j: int, grid: tuple[int, int], mask: NDArray) -> float:
    """Mean of an image over the skin of one cell."""
    (high, wide), there, total = own.shape, 0, 0.0
    for k in range(SAMPLES):
        row = min(int((i + (k + 0.5) / SAMPLES) / grid[0] * high), high - 1)
        for m in range(SAMPLES):
            if mask[k, m]:
                there += 1
                column = min(int((j + (m + 0.5) / SAMPLES) / grid[1] * wide), wide - 1)
                total += own[row, column]
    return total / there if there else 0.0
