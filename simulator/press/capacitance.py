"""Capacitance per area under a press whose touches are pixels and rectangles: exact.

They are patches that a mesh of lines follows. Meshes for other shapes have edges along them, and
`press.rasterized` gives means over the cells of any grid.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Real
from ..scene.parts import Skin
from ..scene.planar import NO_LINES, SAME_EDGE, SAME_LINE, Lines, distinct, shared
from ..sweeps import InputError
from .pixels import pixel_lines
from .press import Press, require_plain
from .touch import AnyTouch, Box, Rectangle, Touch


@dataclass(frozen=True)
class Patch:
    """A touch between two lines x and two lines y in m, and its factor."""

    x: Real
    y: Real
    factor: float

    @property
    def area(self) -> float:
        """Area between its lines, m²."""
        return float(np.ptp(self.x) * np.ptp(self.y))

    def share(self, x: Real, y: Real) -> Real:
        """Covered share of each cell between other lines, shape (row, column)."""
        return shared(self.y, y).T @ shared(self.x, x)

    def factors(self, x: Real, y: Real) -> Real:
        """c over that without the touch, averaged over each cell between other lines."""
        return mean_factor(self.share(x, y), self.factor)


def capacitance_map(skin: Skin, press: Press) -> Real:
    """c in F/m², shape (row, column): the unpressed foam, times each touch's factor.

    Raises InputError for a touch that is not whole pixels, of which `touched_cells` gives means.
    """
    require_plain(press)
    c = np.full((skin.pixels.rows, skin.pixels.columns), skin.foam.unpressed_capacitance_per_area)
    if press.adds:
        return c * tile_map(skin, press, pixel_lines(skin, 0), pixel_lines(skin, 1))
    for touch in press.touches:
        if isinstance(touch, Touch):
            c[touch.row - 1, touch.column - 1] *= touch.factor
        elif lines(skin, Press((touch,))) != NO_LINES:
            raise InputError(f"press {press}: all touches must be whole pixels here")
        else:
            c *= patch(skin, touch).factors(pixel_lines(skin, 0), pixel_lines(skin, 1))
    return c


def _with_touch(press: Press, total: Real, factors: Real) -> Real:
    """c with one more touch: factors multiply, capacitances to earth add."""
    return total + (factors - 1) if press.adds else total * factors


def tile_map(skin: Skin, press: Press, x: Real, y: Real) -> Real:
    """c over its unpressed value between lines in m, shape (row, column): exact for `lines`.

    Edges that nearly coincide with a line enter the cells next to it by the covered area.
    """
    total = np.ones((len(y) - 1, len(x) - 1))
    for touch in press.touches:
        total = _with_touch(press, total, patch(skin, touch).factors(x, y))
    return total


def lines(skin: Skin, press: Press, grid: tuple[int, int] | None = None) -> Lines:
    """Lines at which c may jump beside those of the grid, by default the pixels, ascending."""
    areas = [patch(skin, touch, grid) for touch in press.touches if not isinstance(touch, Touch)]
    if not areas:
        return NO_LINES
    return _between_cells(skin, areas, 0, grid), _between_cells(skin, areas, 1, grid)


def patch(skin: Skin, touch: AnyTouch, grid: tuple[int, int] | None = None) -> Patch:
    """Patch that a touch covers, see `touched_box`. Raises InputError if it is no patch."""
    box = touched_box(skin, touch, grid)
    return Patch(np.array(box[:2]), np.array(box[2:]), touch.factor)


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


def mean_factor(fraction: Real, factor: float) -> Real:
    """1 + (factor - 1) fraction, exact for fractions 0 and 1."""
    return (1 - fraction) + factor * fraction


def _snapped(line: float, known: Real, same: float = SAME_LINE) -> float:
    nearest = known[np.abs(known - line).argmin()]
    return float(nearest if abs(nearest - line) <= same * known[-1] else line)


def _between_cells(
    skin: Skin, patches: list[Patch], axis: int, grid: tuple[int, int] | None
) -> tuple[float, ...]:
    known = pixel_lines(skin, axis, grid)
    of_touches = [line for each in patches for line in (each.x, each.y)[axis]]
    separate = distinct([*of_touches, known[-1]], SAME_EDGE).tolist()
    return tuple(line for line in separate if _snapped(line, known, SAME_EDGE) not in known)
