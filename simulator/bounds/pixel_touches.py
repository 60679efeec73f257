"""Touches of one size around the middles of pixels, of any strength, on the cells of a grid.

The rise of a cell is a smooth function of the depth of a touch. It is interpolated between
Chebyshev nodes; twice as many nodes give the error.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import Integer, Real
from ..chebyshev import Interpolant, refined
from ..mesh.pixel_coverage import pixel_coverage, with_fingers_at
from ..models.mechanics.lattice_presses import NOBODY, raised
from ..models.mechanics.relaxation_kernel import Bodies
from ..models.mechanics.skin_lattice import Lattice, Window
from ..models.reduced.touches import scene_spreads_presses
from ..press.batch import PressBatch
from ..press.parts import parts_of
from ..press.rasterized import TouchBatch, rasterized
from ..scene.parts import Pressing, Skin
from ..sweeps import ToleranceError
from .touch_rasterizers import DepthRasterizer, Point, enclosing_window

COUNTS = (5, 129)
"""First and largest number of Chebyshev nodes of depth."""
RTOL = 1e-4
"""Largest error of interpolation, over the largest rise of a cell."""


def touches_around_pixels(
    skin: Skin, pressing: Pressing, grid: tuple[int, int], size: float, strongest: float
) -> SharpPixelTouches | DepthPixelTouches:
    """Square touches of one size around the middles of a scene's pixels, on a grid of cells.

    size: of a side, m. grid: rows and columns of cells. strongest: largest rise.
    """
    if scene_spreads_presses(skin, pressing):
        return DepthPixelTouches(skin, grid, size, strongest)
    return SharpPixelTouches(skin, grid, size)


def rasterized_with_fingers(
    skin: Skin,
    grid: tuple[int, int],
    touches: SharpPixelTouches | DepthPixelTouches,
    batch: PressBatch,
    size: float,
) -> PressBatch:
    """Touches of pixels by rises, as touches of cells; they may have fingers, see `Parts`.

    size: of a side, m.
    """
    foam = parts_of(skin).foam
    finger = batch.cells >= foam
    on_cells = touches.rasterized(batch.where(~finger))
    if not finger.any():
        return on_cells
    own = batch.where(finger)
    pixel, capacitance = by_touch(own)
    x, y = np.moveaxis(np.array(middles(skin))[pixel - foam], -1, 0)
    squares = TouchBatch.rectangles(np.diff(own.starts), x, y, size, size, 1.0, capacitance)
    return with_fingers_at(skin, on_cells, squares, grid)


def by_touch(batch: PressBatch) -> tuple[Integer, Real]:
    """Cells and rises of each press as rows, shape (press, touch), padded with rises of 0."""
    touches = np.diff(batch.starts)
    there = np.arange(touches.max(initial=0)) < touches[:, None]
    cells = np.full(there.shape, batch.cells.min(initial=0), dtype=np.int64)
    rises = np.zeros(there.shape)
    cells[there], rises[there] = batch.cells, batch.rises
    return cells, rises


def middles(skin: Skin) -> list[Point]:
    """Middle of the skin of each pixel, m."""
    if not skin.rectangular:
        return [(float(x), float(y)) for x, y in pixel_coverage(skin).middle.T]
    skin, (rows, columns) = skin, skin.pixels.shape
    x, y = (
        (np.arange(count) + 0.5) * side / count
        for side, count in ((skin.length, columns), (skin.width, rows))
    )
    return [(u, v) for v in y.tolist() for u in x.tolist()]


class SharpPixelTouches:
    """Touches that end at their edges; factors of overlapping ones multiply."""

    def __init__(self, skin: Skin, grid: tuple[int, int], size: float) -> None:
        self._skin, self._grid, self._size = skin, grid, size
        self._middles = np.array(middles(skin))

    def rasterized(self, batch: PressBatch) -> PressBatch:
        """Touches of pixels by rises, as touches of cells."""
        pixel, rises = by_touch(batch)
        x, y = np.moveaxis(self._middles[pixel], -1, 0)
        counts, size = np.diff(batch.starts), self._size
        squares = TouchBatch.rectangles(counts, x, y, size, size, 1 + rises)
        return rasterized(self._skin, squares, self._grid)


class _Depths(NamedTuple):
    """Rises by touches of a pixel in a window of cells, as a function of their depth in m."""

    here: Window
    rises: Interpolant


class DepthPixelTouches:
    """Touches by depth. A press with touches that interact is solved for on its own."""

    def __init__(self, skin: Skin, grid: tuple[int, int], size: float, strongest: float) -> None:
        self._skin, self._deep = skin, DepthRasterizer(skin, grid, (size, size))
        self._strongest, self._middles = strongest, middles(skin)
        self._cache: dict[int, _Depths] = {}

    def rasterized(self, batch: PressBatch) -> PressBatch:
        """Touches of pixels by rises, as touches of cells.

        Raises InputError where the foam cannot be pressed so far, and ToleranceError where the
        interpolation between depths does not converge.
        """
        press, depth = batch.press, self._skin.pressed_depths(1 + batch.rises)
        rises = np.zeros((batch.count, *self._deep.lattice.grid))
        for pixel in np.unique(batch.cells).tolist():
            own, known = np.flatnonzero(batch.cells == pixel), self._of(pixel)
            rises[:, *known.here][press[own]] += known.rises(depth[own])
        rises = rises.reshape(batch.count, -1)
        for number in np.flatnonzero(np.diff(batch.starts) > 1).tolist():
            applied = self.applied(*batch.one(number))
            if len(self._deep.lattice.groups(applied)) < len(applied.depth):
                found = raised(self._deep.lattice, applied)
                rises[number] = 0.0
                rises[number, found.cells] = found.rises
        return PressBatch.on_grid(rises)

    @property
    def lattice(self) -> Lattice:
        """Lattice on which the touches are solved."""
        return self._deep.lattice

    def applied(self, pixels: Integer, rises: Real) -> Bodies:
        """Touches of pixels as applicators."""
        each = [
            self._deep.applied(self._middles[pixel], rise, beyond=0.0)
            for pixel, rise in zip(pixels.tolist(), rises.tolist(), strict=True)
            if rise > 0
        ]
        return Bodies(*(np.concatenate(own) for own in zip(NOBODY, *each, strict=True)))

    def _of(self, pixel: int) -> _Depths:
        if pixel not in self._cache:
            self._cache[pixel] = self._depth_curve(self._middles[pixel])
        return self._cache[pixel]

    def _depth_curve(self, place: Point) -> _Depths:
        """Rises over depth with twice as many nodes as RTOL needs."""
        here, deepest = self._window(place), self._skin.pressed_depth(1 + self._strongest)

        def close(found: Real, truth: Real) -> bool:
            return np.abs(found - truth).max() <= RTOL * max(np.abs(truth).max(), RTOL)

        rises = refined(lambda depth: self._at(place, here, depth), (0.0, deepest), COUNTS, close)
        if rises is None:
            raise ToleranceError(
                f"{self._skin.name}: interpolation between {COUNTS[1]} depths up to "
                f"{deepest:.4g} m does not reach {RTOL:.1e} for touches by depth"
            )
        return _Depths(here, rises)

    def _window(self, place: Point) -> Window:
        """The cells that touches of any depth change."""
        rises = np.linspace(0.0, self._strongest, COUNTS[0])[1:].tolist()
        return enclosing_window([self._deep.window(place, rise) for rise in rises])

    def _at(self, place: Point, here: Window, depth: Real) -> Real:
        """Rises of the cells of a window at depths in m, shape (depth, row, column)."""
        rise = (self._skin.pressed_factors(depth) - 1).tolist()
        return np.stack([self._deep.rises(place, own, here) for own in rise])
