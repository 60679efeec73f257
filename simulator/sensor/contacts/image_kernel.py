"""Images of depth or pressure on the cells of a grid, compiled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from .cell_samples import SAMPLES
from .foam_kernel import rise_at, strain_under

FINE, BAD_VALUE = range(2)


@compiled()
def imaged_cells(
    images: NDArray,
    by_pressure: bool,
    law: NDArray,
    relative: NDArray,
    strains: NDArray,
    grid: tuple[int, int],
    cut: NDArray,
    mask: NDArray,
) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray]:  # pragma: no cover
    """Cells that images press, the rises of c there, starts of presses, and faults.

    images: depths in m or pressures in Pa, shape (press, row, column). cut, mask: see
    `covered_part`. Returned as well: True for presses whose foam would be compressed further than
    it can, shape (press,); and press, row and column of the first invalid value and 1, shape (4,).
    """
    presses, high, wide = images.shape
    rows, columns = grid
    cells = np.empty(presses * rows * columns, np.int64)
    rises = np.empty(presses * rows * columns)
    starts, limited = np.zeros(presses + 1, np.int64), np.zeros(presses, np.bool_)
    fault, total = np.zeros(4, np.int64), np.zeros((rows, columns))
    own, found = np.zeros((high, wide)), 0
    for press in range(presses):
        touched = False
        for i in range(high):
            for j in range(wide):
                value = images[press, i, j]
                own[i, j] = 0.0
                if value == 0.0:
                    continue
                if not 0.0 < value < np.inf:
                    fault[0], fault[1], fault[2], fault[3] = press, i, j, BAD_VALUE
                    return cells[:0], rises[:0], starts, limited, fault
                touched = True
                own[i, j], beyond = rise_of(value, by_pressure, law, relative, strains)
                limited[press] |= beyond
        if touched:
            _add_means(own, total)
            for i in range(rows):
                for j in range(columns):
                    rise, total[i, j] = total[i, j], 0.0
                    if cut[i, j] >= 0:
                        rise = _sampled(own, i, j, grid, mask[cut[i, j]])
                    if rise != 0.0:
                        cells[found], rises[found] = i * columns + j, rise
                        found += 1
        starts[press + 1] = found
    return cells[:found], rises[:found], starts, limited, fault


@compiled()
def rise_of(
    value: float, by_pressure: bool, law: NDArray, relative: NDArray, strains: NDArray
) -> tuple[float, bool]:  # pragma: no cover
    """Rise of c at a depth [m] or pressure [Pa]; True if the foam was limited."""
    if by_pressure:
        return rise_at(law, relative, strain_under(law, strains, min(value, law[6]))), value > law[
            6
        ]
    strain = value / law[5]
    return rise_at(law, relative, min(strain, law[4])), strain > law[4]


@compiled()
def _add_means(own: NDArray, total: NDArray) -> None:  # pragma: no cover
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
def _sampled(
    own: NDArray, i: int, j: int, grid: tuple[int, int], mask: NDArray
) -> float:  # pragma: no cover
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
