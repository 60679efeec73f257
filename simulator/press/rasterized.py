"""Presses rasterized on the cells of a uniform grid: of pixels, rectangles and discs.

A touch enters a cell as 1 + (factor - 1) times the fraction of its area that it covers. Where
touches overlap, factors multiply, or rises add as capacitances to earth do.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Integer, Mask, Real
from ..scene.parts import Skin
from ..scene.planar import NO_LINES, SAME_LINE
from ..scene.supports import require
from ..sweeps import InputError
from .batch import NOTHING, PressBatch, TouchedCells, joined_cells
from .capacitance import lines, touched_box
from .parts import parts_of
from .pixels import GridCells
from .press import Press, check_fingers, pressed_factor
from .touch import Disc, Indentation, Rectangle, Touch, place_of


class TouchBatch(NamedTuple):
    """Rectangles and discs of many presses, those of each press first in their row.

    counts: touches of each press, shape (press,); all others have the shape (press, touch). disc:
    False for a rectangle. x, y: of the centre, width, height: of the box around it, m. factor: c
    over that without the touch. finger: capacitance to earth, F.
    """

    counts: Integer
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
        counts: Integer,
        x: Real,
        y: Real,
        width: ArrayLike,
        height: ArrayLike,
        factor: ArrayLike,
        finger: ArrayLike = 0.0,
    ) -> Self:
        """Rectangles; arrays of shape (press, touch), or broadcasting to it."""
        given = (np.broadcast_to(each, x.shape) for each in (width, height, factor, finger))
        return cls(counts, np.zeros(x.shape, dtype=bool), x, y, *given)

    @classmethod
    def of(cls, skin: Skin, press: Press) -> Self:
        """Touches of one press. Raises InputError for other shapes."""
        own = press.touches
        boxes = [each.box if isinstance(each, Disc) else touched_box(skin, each) for each in own]
        left, right, bottom, top = np.array(boxes).reshape(1, -1, 4).transpose(2, 0, 1)
        acts = np.array([(each.factor, each.finger) for each in own]).reshape(1, -1, 2)
        disc = np.array([[isinstance(each, Disc) for each in own]], dtype=bool)
        middle = (left + right) / 2, (bottom + top) / 2
        counts, sides = np.array([len(own)]), (right - left, top - bottom)
        return cls(counts, disc, *middle, *sides, *acts.transpose(2, 0, 1))

    @property
    def there(self) -> Mask:
        """True where a press has a touch, shape (press, touch)."""
        return np.arange(self.x.shape[1]) < self.counts[:, None]

    @property
    def boxes(self) -> Real:
        """Left, right, bottom and top of each touch, m, shape (press, touch, 4)."""
        x, y, wide, high = self.x, self.y, self.width / 2, self.height / 2
        return np.stack([x - wide, x + wide, y - high, y + high], axis=-1)

    @property
    def radii(self) -> Real:
        """Radius of each disc, m; 0 of rectangles."""
        return np.where(self.disc, self.width / 2, 0.0)


def rasterized(
    skin: Skin, touches: TouchBatch, grid: tuple[int, int], adds: bool = False
) -> PressBatch:
    """Cells in which presses raise c, and the rise relative to the unpressed c.

    grid: rows and columns; sides of rectangles snap to lines that they nearly coincide with. adds:
    see `Press`.
    """
    from .cell_kernel import cells_of_patches

    cells, boxes, radii = GridCells.of(skin, grid), touches.boxes, touches.radii
    for ends, line in ((boxes[..., :2], cells.x), (boxes[..., 2:], cells.y)):
        last = len(line) - 1
        near = line[np.clip(np.rint(ends / line[-1] * last), 0, last).astype(np.int64)]
        same = (radii == 0)[..., None] & (np.abs(near - ends) <= SAME_LINE * line[-1])
        ends[...] = np.where(same, near, ends)
    rises = np.ascontiguousarray(touches.factor - 1)
    return cells_of_patches(touches.counts, boxes, radii, rises, not adds, cells)


def with_fingers(
    skin: Skin,
    batch: PressBatch,
    touches: TouchBatch,
    grid: tuple[int, int],
    part: Real | None = None,
) -> PressBatch:
    """Presses with the fingers of their touches, as parts of M that rise by F; see `Parts`.

    grid: see `rasterized`. part: see `spread_finger`.
    """
    fingered = touches.there & (touches.finger > 0)
    for number in np.flatnonzero(fingered.any(axis=0)).tolist():
        counts = fingered[:, number].astype(np.int64)
        one = slice(number, number + 1)
        own = TouchBatch._make([counts, *(each[:, one] for each in touches[1:])])
        covered = rasterized(skin, own._replace(factor=np.full_like(own.factor, 2.0)), grid)
        batch = batch.and_(spread_finger(skin, covered, own.finger[:, 0], grid, part))
    return batch


def spread_finger(
    skin: Skin,
    covered: PressBatch,
    finger: Real,
    grid: tuple[int, int],
    part: Real | None = None,
) -> PressBatch:
    """Finger of one touch of each press, spread uniformly over the skin that it covers.

    covered: cells, and the covered fraction of each. finger: F, shape (press,). part: of each cell
    that is skin, shape (cell,); None if all is.
    """
    press, area = covered.press, covered.rises
    area = area if part is None else area * part[covered.cells]
    whole = np.bincount(press, area, covered.count)
    cells = parts_of(skin, grid).finger(covered.cells)
    return PressBatch(cells, finger[press] * area / whole[press], covered.starts)


def touched_cells(skin: Skin, press: Press, grid: tuple[int, int] | None = None) -> TouchedCells:
    """Cells of a uniform grid, by default the pixels, where a press raises c.

    Fingers follow, numbered as in `Parts`. Raises InputError for a finger if the scene has no
    earth, and for walls around touches that are not whole cells.
    """
    check_fingers(press, skin)
    shape = grid or skin.pixels.shape
    _check_walls(skin, press, shape)
    if press.indented:
        return joined_cells(_under_applicators(skin, press), fingers(skin, press, shape))
    touches = TouchBatch.of(skin, press)
    raised = rasterized(skin, touches, shape, press.adds)
    return with_fingers(skin, raised, touches, shape).one(0)


def fingers(skin: Skin, press: Press, grid: tuple[int, int] | None = None) -> TouchedCells:
    """Fingers of a press on such a grid, numbered as in `Parts`, F."""
    own = press.of(replace(place_of(t), finger=t.finger) for t in press.touches if t.finger)
    none, touches = PressBatch.of([NOTHING]), TouchBatch.of(skin, own)
    return with_fingers(skin, none, touches, grid or skin.pixels.shape).one(0)


def _check_walls(skin: Skin, press: Press, grid: tuple[int, int]) -> None:
    if skin.around is None or not skin.around.edges:
        return
    for touch in press.touches:
        if isinstance(touch, Touch | Indentation) or touch.factor == 1:
            continue
        if not isinstance(touch, Rectangle) or lines(skin, Press((touch,)), grid) != NO_LINES:
            require("touches on cells of pixels", skin, called=f"press {touch}")


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
