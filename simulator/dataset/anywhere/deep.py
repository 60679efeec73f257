"""Many touches pressed into foam whose skins have a tension, laid on the cells of a grid.

A cell rises by the mean of the factor over its skin, of the deflection of the whole press; see
`models.mechanics.lattice`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...models.mechanics.lattice.presses import Applied, raised, window
from ...models.mechanics.lattice.skin import Lattice, lattice_of
from ...models.reduced.indented.draws import spreading
from ...press.batch import NOTHING, PressBatch, TouchedCells
from ...press.press import Press, order
from ...press.touch import Depth, Disc, Indentation, Rectangle
from ...scene.scene import Scene
from ...scene.skin import covers
from ..strengths import told
from .laying import Placed, laid_on_cells

FACTOR_RTOL = 1e-3
"""Of the factor anywhere, which lattices are compared with."""
POINTS = 24
"""Along each side of a cell, at which that is seen."""


def raised_on_cells(
    scene: Scene, touches: NDArray[np.int64], placed: Placed, grid: tuple[int, int]
) -> PressBatch:
    """As `laid_on_cells`, by the deflection where a tension spreads how a scene is pressed."""
    if not spreading(scene):
        return laid_on_cells(scene, touches, placed, grid)
    lattice = lattice_under(scene, grid)
    each = (applied(scene, placed, k, count) for k, count in enumerate(touches.tolist()))
    return PressBatch.of(raised(lattice, own) for own in each)


def strengths_anywhere(scene: Scene, placed: Placed) -> tuple[NDArray[np.float64], str]:
    """How strongly touches press, as their texts say it, and the unit of that."""
    return told(scene, placed.factor) if spreading(scene) else (placed.factor, "")


def lattice_under(scene: Scene, grid: tuple[int, int]) -> Lattice:
    """As fine as the smallest touch of a scene's data set needs."""
    drawn, pixels = scene.dataset.press, scene.pixels
    length, width = scene.skin.sides
    smallest = min(length / pixels.columns, width / pixels.rows)
    if drawn.place == "anywhere":
        smallest = drawn.size.low
    return lattice_of(scene, grid, float(smallest))


def raised_by_triangles(
    scene: Scene, touches: NDArray[np.int64], placed: Placed, grid: tuple[int, int]
) -> PressBatch:
    """As `raised_on_cells`, to FACTOR_RTOL of the factor: some tenths of a second each."""
    lattice = lattice_under(scene, grid)
    each = (applied(scene, placed, k, count) for k, count in enumerate(touches.tolist()))
    return PressBatch.of(
        _by_triangles(scene, lattice, own) if len(own.depth) else NOTHING for own in each
    )


def _by_triangles(scene: Scene, lattice: Lattice, own: Applied) -> TouchedCells:
    from ...models.mechanics.indentation import pressed

    here, grid = window(lattice, own), lattice.grid
    y, x = (
        (np.arange(cells.start * POINTS, cells.stop * POINTS) + 0.5) * side / count / POINTS
        for cells, side, count in zip(here, scene.skin.sides[::-1], grid, strict=True)
    )
    at = np.stack(np.broadcast_arrays(x, y[:, None]))
    part = covers(scene.skin, at).astype(np.float64)
    rise = part * (pressed(scene, as_press(own), FACTOR_RTOL).factor(at) - 1)
    shape = len(y) // POINTS, POINTS, len(x) // POINTS, POINTS
    area, total = (each.reshape(shape).sum(axis=(1, 3)) for each in (part, rise))
    every = np.zeros(grid)
    every[here] = np.divide(total, area, out=np.zeros_like(total), where=area > 0)
    cells = np.flatnonzero(every)
    return TouchedCells(cells, every.ravel()[cells])


def applied(scene: Scene, placed: Placed, press: int, touches: int) -> Applied:
    """The first so many touches of a press as applicators."""
    own = press, slice(touches)
    x, y, wide, high = placed.x[own], placed.y[own], placed.width[own] / 2, placed.height[own] / 2
    boxes = np.stack([x - wide, x + wide, y - high, y + high], axis=-1)
    radius = np.where(placed.disc[own], wide, 0.0)
    return Applied(boxes, radius, told(scene, placed.factor[own])[0])


def as_press(found: Applied) -> Press:
    """The same for the mechanics on triangles."""
    touches = []
    for (left, right, bottom, top), radius, depth in zip(*(e.tolist() for e in found), strict=True):
        x, y = (left + right) / 2, (bottom + top) / 2
        box = Rectangle(x, y, right - left, top - bottom, 1.0)
        place = Disc(x, y, radius, 1.0) if radius else box
        touches.append(Indentation(place, Depth(depth)))
    return Press(tuple(sorted(touches, key=order)))
