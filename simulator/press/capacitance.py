"""Capacitance per area under a press whose touches are pixels and rectangles: exact.

They are patches that a mesh of lines follows. Meshes for other shapes have edges along them, and
`press.rasterized` gives means over the cells of any grid.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Real
from ..scene.parts import Skin
from ..scene.planar import NO_LINES, SAME_EDGE, SAME_LINE, Lines, covered, distinct
from ..sweeps import InputError
from .pixels import pixel_lines
from .press import Press, require_plain
from .touch import AnyTouch, Box, Rectangle, Touch


def capacitance_map(skin: Skin, press: Press) -> Real:
    """c in F/m², shape (row, column): the unpressed foam, times each touch's factor.

    Raises InputError for a touch that is not whole pixels, of which `touched_cells` gives means.
    """
    require_plain(press)
    if not press.adds and lines(skin, press) != NO_LINES:
        raise InputError(f"press {press}: all touches must be whole pixels here")
    own = tile_map(skin, press, pixel_lines(skin, 0), pixel_lines(skin, 1))
    return skin.foam.unpressed_capacitance_per_area * own


def tile_map(skin: Skin, press: Press, x: Real, y: Real) -> Real:
    """c over its unpressed value between lines in m, shape (row, column): exact for `lines`.

    Edges that nearly coincide with a line enter the cells next to it by the covered area.
    """
    total = np.ones((len(y) - 1, len(x) - 1))
    for touch in press.touches:
        part = covered_part(touched_box(skin, touch), x, y)
        factors = (1 - part) + touch.factor * part
        total = total + (factors - 1) if press.adds else total * factors
    return total


def covered_part(box: Box, x: Real, y: Real) -> Real:
    """Part of each cell between lines in m that a rectangle covers, shape (row, column)."""
    return np.multiply.outer(covered(box.bottom, box.top, y), covered(box.left, box.right, x))


def lines(skin: Skin, press: Press, grid: tuple[int, int] | None = None) -> Lines:
    """Lines at which c may jump beside those of the grid, by default the pixels, ascending."""
    boxes = [
        touched_box(skin, touch, grid) for touch in press.touches if not isinstance(touch, Touch)
    ]
    if not boxes:
        return NO_LINES
    return _between_cells(skin, boxes, 0, grid), _between_cells(skin, boxes, 1, grid)


def touched_box(skin: Skin, touch: AnyTouch, grid: tuple[int, int] | None = None) -> Box:
    """Rectangle of a touch; its sides are lines of the grid, or of the pixels, that they meet.

    Raises InputError if it is no rectangle.
    """
    if not isinstance(touch, Touch | Rectangle):
        require_plain(Press((touch,)))
    assert isinstance(touch, Touch | Rectangle)
    x, y = pixel_lines(skin, 0, grid), pixel_lines(skin, 1, grid)
    if isinstance(touch, Touch):
        row, column = touch.row, touch.column
        return Box(x[column - 1], x[column], y[row - 1], y[row])
    left, right, bottom, top = touch.box
    return Box(_snapped(left, x), _snapped(right, x), _snapped(bottom, y), _snapped(top, y))


def _snapped(line: float, known: Real, same: float = SAME_LINE) -> float:
    nearest = known[np.abs(known - line).argmin()]
    return float(nearest if abs(nearest - line) <= same * known[-1] else line)


def _between_cells(
    skin: Skin, boxes: list[Box], axis: int, grid: tuple[int, int] | None
) -> tuple[float, ...]:
    known = pixel_lines(skin, axis, grid)
    of_touches = [line for box in boxes for line in box[2 * axis : 2 * axis + 2]]
    separate = distinct([*of_touches, known[-1]], SAME_EDGE).tolist()
    return tuple(line for line in separate if _snapped(line, known, SAME_EDGE) not in known)
