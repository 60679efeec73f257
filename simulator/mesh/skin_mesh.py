"""Meshes of triangles for skins of any outline, and those that mesh files bring."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from ..press.press import Press
from ..scene.planar import Circle
from ..scene.scene import Scene
from .domain import Domain
from .drawing import Shape, around_pixels, drawing_of, sharp_touches
from .imported import imported
from .outline_mesh import drawn

KEPT = 8
"""Meshes, the same of all depths or factors of an applicator: the latest asked for."""
Corners = tuple[tuple[float, ...], ...]


def domain(
    scene: Scene,
    press: Press,
    size: float,
    creases: Sequence[Shape] = (),
    between: bool = True,
) -> Domain:
    """The skin of a scene as triangles that conform to all at which something jumps.

    These are its outline and holes, the ends of foils, the edges of the press's touches that have a
    factor, and `creases`, circles and polylines of shape (point, 2). All are in m. Edges along
    circles are arcs. size: the longest edge asked for [m]; edges are shorter where something small
    is near. between: whether the triangles conform to the lines between all pixels, too; if not,
    one belongs to the pixel that its middle lies in. A mesh that a file brings keeps its own size,
    and is cut where it does not conform.

    Raises InputError where a mesh file does not serve, or the mesher is not installed;
    ToleranceError where lines or circles lie too near to each other.
    """
    if not between and scene.pixels.groups is None:
        creases = [*creases, *around_pixels(scene, press)]
    if scene.skin.mesh is not None:
        return imported(drawing_of(scene, press, creases, between))
    sharp, edges = Press(tuple(sharp_touches(press))), tuple(map(_fixed, creases))
    return _drawn(scene, sharp, size, edges, between)  # pyright: ignore[reportArgumentType]


def _fixed(crease: Shape) -> Circle | Corners:
    return crease if isinstance(crease, Circle) else tuple(map(tuple, crease.tolist()))


@lru_cache(maxsize=KEPT)
def _drawn(
    scene: Scene,
    press: Press,
    size: float,
    creases: tuple[Circle | Corners, ...],
    between: bool,
) -> Domain:
    edges = [each if isinstance(each, Circle) else np.array(each) for each in creases]
    return drawn(drawing_of(scene, press, edges, between), size)
