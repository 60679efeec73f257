"""Many touches rasterized on the cells of a uniform grid; `grid_map` does so for one press.

A touch enters a cell as 1 + (factor - 1) times the fraction of its area that it covers, and factors
multiply. `grid_map` is the kernel's readable twin, and serves single presses without loading numba.
"""

from __future__ import annotations

from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Integer, Mask, Real
from ..scene.parts import Skin
from ..scene.planar import SAME_LINE
from .batch import PressBatch


class Footprints(NamedTuple):
    """Rectangles and discs, those of each press first in their row, shape (press, touch).

    disc: False for a rectangle. x, y: of the centre, width, height: of the box around it, m.
    factor: c over that without the touch. finger: capacitance to earth, F.
    """

    disc: Mask
    x: Real
    y: Real
    width: Real
    height: Real
    factor: Real
    finger: Real

    @classmethod
    def rectangles(
        cls,
        x: Real,
        y: Real,
        width: ArrayLike,
        height: ArrayLike,
        factor: ArrayLike,
        finger: ArrayLike = 0.0,
    ) -> Self:
        """Footprints of rectangles; arrays of shape (press, touch), or broadcasting to it."""
        given = (np.broadcast_to(each, x.shape) for each in (width, height, factor, finger))
        return cls(np.zeros(x.shape, dtype=bool), x, y, *given)


def rasterized(
    skin: Skin, touches: Integer, footprints: Footprints, grid: tuple[int, int]
) -> PressBatch:
    """Cells in which presses raise c, and the rise relative to the unpressed c.

    touches: number in each press, shape (press,). grid: rows and columns.
    """
    from .overlap_kernel import touched

    x, y = (np.linspace(0, side, n + 1) for side, n in zip(skin.sides, grid[::-1], strict=True))
    disc = footprints.disc
    boxes = np.stack(
        [
            *_ends(footprints.x, footprints.width, x, disc),
            *_ends(footprints.y, footprints.height, y, disc),
        ],
        axis=-1,
    )
    radius = np.where(disc, footprints.width / 2, 0.0)
    factor = np.ascontiguousarray(footprints.factor)
    return PressBatch(*touched(touches, boxes, radius, factor, x, y))


def _ends(middle: Real, extent: Real, lines: Real, disc: Mask) -> tuple[Real, Real]:
    """Start and end of touches along an axis, m; rectangles snap to lines that they nearly coincide
    with."""
    low, high = (_on_lines(middle + side * extent / 2, lines, disc) for side in (-1, 1))
    return low, high


def _on_lines(ends: Real, lines: Real, disc: Mask) -> Real:
    cells = len(lines) - 1
    near = lines[np.clip(np.rint(ends / lines[-1] * cells), 0, cells).astype(np.int64)]
    return np.where(~disc & (np.abs(near - ends) <= SAME_LINE * lines[-1]), near, ends)
