"""Many touches laid on the cells of a uniform grid at once, as `grid_map` lays those of one press.

A touch enters a cell as 1 + (factor - 1) times the fraction of its area that it covers, and factors
multiply; `touched_cells` is the readable twin, press by press.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...press.batch import PressBatch
from ...scene.planar import SAME_LINE
from ...scene.scene import Scene


class Placed(NamedTuple):
    """Rectangles and discs, those of each press first in their row, shape (press, touch).

    disc: else a rectangle. x, y: of the centre, width, height: of the box around it, m. factor: c
    over that without the touch.
    """

    disc: NDArray[np.bool_]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    width: NDArray[np.float64]
    height: NDArray[np.float64]
    factor: NDArray[np.float64]


def laid_on_cells(
    scene: Scene, touches: NDArray[np.int64], placed: Placed, grid: tuple[int, int]
) -> PressBatch:
    """Cells in which presses raise c, and by how much of that without them.

    touches: how many each press has, shape (press,). grid: rows and columns.
    """
    from .kernel import laid

    x, y = (
        np.linspace(0, side, n + 1) for side, n in zip(scene.skin.sides, grid[::-1], strict=True)
    )
    boxes = np.stack(
        [
            *_ends(placed.x, placed.width, x, placed.disc),
            *_ends(placed.y, placed.height, y, placed.disc),
        ],
        axis=-1,
    )
    radius = np.where(placed.disc, placed.width / 2, 0.0)
    return PressBatch(*laid(touches, boxes, radius, placed.factor, x, y))


def _ends(
    middle: NDArray[np.float64],
    extent: NDArray[np.float64],
    lines: NDArray[np.float64],
    disc: NDArray[np.bool_],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Where touches begin and end along an axis, m; rectangles on lines that they cannot be told
    from."""
    low, high = (_on_lines(middle + side * extent / 2, lines, disc) for side in (-1, 1))
    return low, high


def _on_lines(
    ends: NDArray[np.float64], lines: NDArray[np.float64], disc: NDArray[np.bool_]
) -> NDArray[np.float64]:
    cells = len(lines) - 1
    near = lines[np.clip(np.rint(ends / lines[-1] * cells), 0, cells).astype(np.int64)]
    return np.where(~disc & (np.abs(near - ends) <= SAME_LINE * lines[-1]), near, ends)
