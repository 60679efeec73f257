"""Meshes of triangles for skins of any outline, and those that mesh files bring."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from simulator.domain.drawn import drawn
from simulator.domain.imported import imported
from simulator.domain.region import Domain, Points, sharp_touches
from simulator.domain.untangled import finer
from simulator.planar import Circle
from simulator.press import Press
from simulator.scene import Scene
from simulator.scene_file import pixel_by_pixel

__all__ = ["Domain", "domain", "every_press", "finer", "sharp_touches"]


def domain(
    scene: Scene, press: Press, size: float, creases: Sequence[Circle | Points] = ()
) -> Domain:
    """The skin of a scene as triangles that conform to all at which something jumps.

    These are its outline and holes, the lines of pixels, the ends of foils, the edges of the
    press's touches that have a factor, and `creases`, circles and polylines of shape (point, 2).
    All are in m. Edges along circles are arcs. size: the longest edge asked for [m]; edges are
    shorter where something small is near. A mesh that a file brings keeps its own size, and is cut
    where it does not conform.

    Raises InputError where a mesh file does not serve, or gmsh cannot be loaded.
    """
    if scene.skin.mesh is not None:
        return imported(scene, press, creases)
    return drawn(scene, press, size, creases)


def every_press(scene: Scene) -> list[Press]:
    """The skin at rest, then every pixel alone that has a part of the skin in it, row by row."""
    presses = pixel_by_pixel(scene)
    if scene.skin.outline is None and scene.skin.mesh is None:
        return presses
    there = np.unique(domain(scene, Press(), max(scene.skin.sides)).pixel)
    return [presses[0], *(presses[1 + number] for number in there if number >= 0)]
