"""Spreading of presses over coarser cells, compiled; see `cell_spreading`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled

ROUNDING = 1e-12
"""Rises below this come from rounding."""


@compiled()
def spread(
    cells: NDArray,
    rises: NDArray,
    starts: NDArray,
    down_first: NDArray,
    down: NDArray,
    along_first: NDArray,
    along: NDArray,
) -> tuple[NDArray, NDArray, NDArray]:  # pragma: no cover
    """Compiled form of `CellSpreading`: cells, rises and starts of presses on coarse cells."""
    fine_columns, near = len(along), down.shape[1]
    fine = len(down) * fine_columns
    rows, columns = down_first[len(down) - 1] + 2, along_first[fine_columns - 1] + 2
    coarse = rows * columns
    total, seen = np.zeros(2 * coarse), np.zeros(2 * coarse, np.int64)
    order = np.empty(2 * coarse, np.int64)
    most = min(near * near * len(cells), 2 * coarse * (len(starts) - 1))
    found_cells, found_rises = np.empty(most, np.int64), np.empty(most)
    found_starts, found = np.zeros(len(starts), np.int64), 0
    for press in range(len(starts) - 1):
        count = 0
        for k in range(starts[press], starts[press + 1]):
            finger = cells[k] >= fine
            cell = cells[k] - fine if finger else cells[k]
            own = rises[k] if finger else rises[k] * (coarse / fine)
            i, j = cell // fine_columns, cell % fine_columns
            for a in range(near):
                for b in range(near):
                    share = down[i, a] * along[j, b]
                    if share == 0.0:
                        continue
                    at = (down_first[i] + a) * columns + along_first[j] + b
                    at = at + coarse if finger else at
                    total[at] += share * own
                    if seen[at] <= press:
                        seen[at] = press + 1
                        order[count] = at
                        count += 1
        touched = np.sort(order[:count])
        for at in touched:
            least = 0.0 if at >= coarse else ROUNDING
            if abs(total[at]) > least:
                found_cells[found], found_rises[found] = at, total[at]
                found += 1
            total[at] = 0.0
        found_starts[press + 1] = found
    return found_cells[:found], found_rises[:found], found_starts
