"""A skin as triangles, and what each of them is part of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.foam import pixel_lines, touched_box
from simulator.planar import inside, regular
from simulator.press import AnyTouch, Disc, Polygon, Press, Rectangle
from simulator.scene import Scene

DISC_SIDES = 128
"""Of the regular polygon of the same area that a disc is; its circumference is 1e-4 longer."""

Points = NDArray[np.float64]
Numbers = NDArray[np.int64]


@dataclass(frozen=True)
class Domain:
    """Triangles that meet edge to edge.

    p: points in m, shape (2 or 3, point). t: numbers of points, ascending in each column, shape
    (3, triangle). pixel: row * columns + column, both from 0, -1 where there is none, shape
    (triangle,). covered: whether each of `sharp_touches` covers a triangle, shape (touch,
    triangle). foils: for each contact the numbers of points of its facets, ascending in each
    column, shape (2, facet).
    """

    p: Points
    t: Numbers
    pixel: Numbers
    covered: NDArray[np.bool_]
    foils: dict[str, Numbers]

    @property
    def areas(self) -> NDArray[np.float64]:
        """Of the triangles, m², shape (triangle,)."""
        return areas(self.p, self.t)

    @property
    def lengths(self) -> NDArray[np.float64]:
        """Of the longest edge of each triangle, m, shape (triangle,)."""
        a, b, c = (self.p[:, corner] for corner in self.t)
        return np.linalg.norm([a - b, b - c, c - a], axis=1).max(axis=0)


def areas(p: Points, t: Numbers) -> NDArray[np.float64]:
    """Areas of triangles in the plane or in space, m², shape (triangle,)."""
    a, b, c = (p[:, corner] for corner in t)
    u, v = b - a, c - a
    squared = (u**2).sum(axis=0) * (v**2).sum(axis=0) - (u * v).sum(axis=0) ** 2
    if len(p) == 2:
        return np.abs(u[0] * v[1] - u[1] * v[0]) / 2
    return np.sqrt(np.maximum(squared, 0.0)) / 2


def sharp_touches(press: Press) -> list[Rectangle | Disc | Polygon]:
    """The touches of a press that have a factor and are no pixels, in order."""
    return [each for each in press.touches if isinstance(each, Rectangle | Disc | Polygon)]


def corners(scene: Scene, touch: AnyTouch) -> Points:
    """The polygon that such a touch is, shape (corner, 2)."""
    if isinstance(touch, Disc):
        return regular(touch.x, touch.y, touch.radius, DISC_SIDES)
    if isinstance(touch, Polygon):
        return np.array(touch.points, dtype=float)
    left, right, bottom, top = touched_box(scene, touch)
    return np.array([(left, bottom), (right, bottom), (right, top), (left, top)])


def labelled(
    scene: Scene, press: Press, p: Points, t: Numbers, foils: dict[str, Numbers]
) -> Domain:
    """The domain of triangles that conform to pixels and touches, labelled by their centres."""
    t = np.sort(t, axis=0)
    middle = p[:2, t].mean(axis=1)
    of_touches = [inside(corners(scene, touch), middle) for touch in sharp_touches(press)]
    covered = np.array(of_touches, dtype=bool).reshape(-1, t.shape[1])
    foils = {name: np.sort(facets, axis=0) for name, facets in foils.items()}
    return Domain(p, t, pixels(scene, middle), covered, foils)


def pixels(scene: Scene, x: Points) -> Numbers:
    """The pixel at positions x in m, shape (2, point) to (point,); -1 beyond the grid."""
    column, row = (
        np.searchsorted(pixel_lines(scene, axis), x[axis], side="right") - 1 for axis in (0, 1)
    )
    rows, columns = scene.pixels.shape
    if scene.skin.mesh is None:  # circles as polygons may pass a side of the grid by their corners
        row, column = np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)
    within = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
    return np.where(within, row * columns + column, -1)
