"""Images of depth or pressure on coarse cells so that moments are kept, compiled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from .cell_shares import add_point
from .image_kernel import BAD_VALUE, rise_of
from .moment_kernel import PARTS
from .stack_kernel import FAINT


@compiled()
def moments_of_images(
    images: NDArray,
    by_pressure: bool,
    law: NDArray,
    relative: NDArray,
    strains: NDArray,
    grid: tuple[int, int],
) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray]:  # pragma: no cover
    """Cells of a coarse grid (rows, columns), rises and starts of images on a rectangular skin.

    Others and further results: see `image_kernel.imaged_cells`.
    """
    presses, high, wide = images.shape
    rows, columns = grid
    cells = np.empty(presses * rows * columns, np.int64)
    rises = np.empty(presses * rows * columns)
    starts, limited = np.zeros(presses + 1, np.int64), np.zeros(presses, np.bool_)
    fault, total, found = np.zeros(4, np.int64), np.zeros((rows, columns)), 0
    across, along = rows / high, columns / wide
    down, right = int(np.ceil(across * PARTS)), int(np.ceil(along * PARTS))
    area = across * along / (down * right)
    for press in range(presses):
        touched = False
        for i in range(high):
            for j in range(wide):
                value = images[press, i, j]
                if value == 0.0:
                    continue
                if not 0.0 < value < np.inf:
                    fault[0], fault[1], fault[2], fault[3] = press, i, j, BAD_VALUE
                    return cells[:0], rises[:0], starts, limited, fault
                rise, beyond = rise_of(value, by_pressure, law, relative, strains)
                limited[press] |= beyond
                touched = True
                for k in range(down):
                    v = (i + (k + 0.5) / down) * across
                    for m in range(right):
                        u = (j + (m + 0.5) / right) * along
                        add_point(total, u, v, rise * area, along / right, across / down)
        if touched:
            for i in range(rows):
                for j in range(columns):
                    rise, total[i, j] = total[i, j], 0.0
                    if abs(rise) > FAINT:
                        cells[found], rises[found] = i * columns + j, rise
                        found += 1
        starts[press + 1] = found
    return cells[:found], rises[:found], starts, limited, fault
