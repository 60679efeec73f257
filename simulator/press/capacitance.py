"""Capacitance per area under a press: of every pixel, of any grid, and exactly.

A pixel and a rectangle are patches that a mesh of lines follows. A disc is not: it enters a grid by
the share of each cell's area that it covers, and meshes for discs have arcs as edges.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ..arrays import Real
from ..scene.parts import Skin
from ..scene.planar import NO_LINES, SAME_EDGE, SAME_LINE, Lines, disc_fraction, distinct, shared
from ..sweeps import InputError
from .batch import NOTHING, TouchedCells, joined_cells
from .parts import parts_of
from .pixels import pixel_lines
from .press import Press, check_fingers, pressed_factor, require_plain
from .touch import AnyTouch, Box, Disc, Indentation, Rectangle, Touch, place_of
from .walls import require_no_walls


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

    Raises InputError for a touch that is not whole pixels; `grid_map` then gives the pixels' means.
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


def grid_map(skin: Skin, press: Press, rows: int, columns: int) -> Real:
    """c over its unpressed value, on a uniform grid over the skin, shape (row, column).

    Each touch enters a cell as 1 + (factor - 1) times the fraction of its area that it covers, a
    disc as an exact circle; factors multiply.
    """
    x, y = _uniform_lines(skin.length, columns), _uniform_lines(skin.width, rows)
    total = np.ones((rows, columns))
    for touch in press.touches:
        if isinstance(touch, Disc):
            covered = disc_fraction(touch.x, touch.y, touch.radius, x, y)
            total = _with_touch(press, total, mean_factor(covered, touch.factor))
        else:
            total = _with_touch(press, total, patch(skin, touch).factors(x, y))
    return total


def _with_touch(press: Press, total: Real, factors: Real) -> Real:
    """c with one more touch: factors multiply, capacitances to earth add."""
    return total + (factors - 1) if press.adds else total * factors


@lru_cache
def _uniform_lines(length: float, cells: int) -> Real:
    """Lines between equal cells, from 0 to a length in m; read-only."""
    lines = np.linspace(0, length, cells + 1)
    lines.flags.writeable = False
    return lines


def touched_cells(skin: Skin, press: Press, grid: tuple[int, int] | None = None) -> TouchedCells:
    """Cells of a uniform grid, by default the pixels, where a press raises c; as `grid_map`.

    Fingers follow, numbered as in `Parts`. Raises InputError for a finger if the scene has no
    earth, and for walls around touches that are not whole cells.
    """
    check_fingers(press, skin)
    shape = grid or skin.pixels.shape
    _check_walls(skin, press, shape)
    raised = (
        _under_applicators(skin, press)
        if press.indented
        else _cells_under_factors(skin, press, shape)
    )
    if not press.fingers:
        return raised
    return joined_cells(raised, fingers(skin, press, shape))


def _check_walls(skin: Skin, press: Press, grid: tuple[int, int]) -> None:
    if skin.around is None or not skin.around.edges:
        return
    for touch in press.touches:
        if isinstance(touch, Touch | Indentation) or touch.factor == 1:
            continue
        if not isinstance(touch, Rectangle) or lines(skin, Press((touch,)), grid) != NO_LINES:
            require_no_walls(skin, f"press {touch} on pixels")


def fingers(skin: Skin, press: Press, grid: tuple[int, int] | None = None) -> TouchedCells:
    """Fingers of a press on such a grid, numbered as in `Parts`, F."""
    shape = grid or skin.pixels.shape
    each = [_finger(skin, touch, shape) for touch in press.touches if touch.finger]
    return joined_cells(NOTHING, *each)


def _cells_under_factors(skin: Skin, press: Press, grid: tuple[int, int]) -> TouchedCells:
    rises = grid_map(skin, press, *grid).ravel() - 1
    cells = np.flatnonzero(rises)
    return TouchedCells(cells, rises[cells])


def _finger(skin: Skin, touch: AnyTouch, grid: tuple[int, int]) -> TouchedCells:
    """Finger of one touch, spread uniformly over the area that it covers."""
    cells, covered = _cells_under_factors(
        skin, Press((replace(place_of(touch), factor=2.0),)), grid
    )
    share = touch.finger * covered / covered.sum()
    return TouchedCells(parts_of(skin, grid).finger(cells), share)


def _under_applicators(skin: Skin, press: Press) -> TouchedCells:
    """Pixels, and the rise of c under their applicators.

    Raises InputError for other touches.
    """
    places = [each.place for each in press.indented if isinstance(each.place, Touch)]
    if len(places) < len(press.touches):
        raise needs_factors(press)
    cells = [(each.row - 1) * skin.pixels.columns + each.column - 1 for each in places]
    rises = [pressed_factor(skin, each) - 1 for each in press.indented]
    return TouchedCells(np.array(cells, dtype=np.int64), np.array(rises))


def needs_factors(press: Press) -> InputError:
    """Error for a depth or a force where only a factor can be rasterized."""
    return InputError(
        f"press {press}: needs a capacitance factor here; a depth is possible only for whole "
        "pixels of a scene with `press.depth`"
    )


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
