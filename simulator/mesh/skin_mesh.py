"""Triangle meshes of skins of any outline, and of skins that mesh files describe."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from ..press.press import Press
from ..scene.parts import Skin
from ..scene.planar import Circle
from .domain import Domain
from .drawing import Shape, around_pixels, drawing_of, sharp_touches
from .imported import imported
from .outline_mesh import drawn

KEPT = 8
"""Number of meshes cached, those requested last.

All depths or factors of an applicator share one.
"""
Corners = tuple[tuple[float, ...], ...]


def domain(
    skin: Skin,
    press: Press,
    size: float,
    creases: Sequence[Shape] = (),
    between: bool = True,
) -> Domain:
    """Triangles of a scene's skin that conform to all lines where something jumps.

    These are its outline and holes, the ends of foils, the edges of the press's touches that have a
    factor, and `creases`, circles and polylines of shape (point, 2). All are in m. Edges along
    circles are arcs. size: requested longest edge [m]; edges are shorter near small features.
    between: True if the triangles also conform to the lines between all pixels; otherwise a
    triangle belongs to the pixel that its middle lies in. A mesh from a file keeps its own size,
    and is cut where it does not conform.

    Raises InputError if a mesh file cannot be used or the mesher is not installed; ToleranceError
    if lines or circles lie too near to each other.
    """
    if not between and skin.pixels.groups is None:
        creases = [*creases, *around_pixels(skin, press)]
    if skin.mesh is not None:
        return imported(drawing_of(skin, press, creases, between))
    sharp, edges = Press(tuple(sharp_touches(press))), tuple(map(_fixed, creases))
    return _drawn(skin, sharp, size, edges, between)  # pyright: ignore[reportArgumentType]


def _fixed(crease: Shape) -> Circle | Corners:
    return crease if isinstance(crease, Circle) else tuple(map(tuple, crease.tolist()))


@lru_cache(maxsize=KEPT)
def _drawn(
    skin: Skin,
    press: Press,
    size: float,
    creases: tuple[Circle | Corners, ...],
    between: bool,
) -> Domain:
    edges = [each if isinstance(each, Circle) else np.array(each) for each in creases]
    return drawn(drawing_of(skin, press, edges, between), size)
