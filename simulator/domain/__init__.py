"""Meshes of triangles for skins of any outline, and those that mesh files bring."""

from __future__ import annotations

from collections.abc import Sequence

from simulator.domain.drawn import drawn
from simulator.domain.imported import imported
from simulator.domain.refinement import refined
from simulator.domain.region import DISC_SIDES, Domain, Points, sharp_touches
from simulator.press import Press
from simulator.scene import Scene

__all__ = ["DISC_SIDES", "Domain", "domain", "refined", "sharp_touches"]


def domain(scene: Scene, press: Press, size: float, creases: Sequence[Points] = ()) -> Domain:
    """The skin of a scene as triangles that conform to all at which something jumps.

    These are its outline and holes, the lines of pixels, the ends of foils, the edges of the
    press's touches that have a factor, and `creases`, polylines of shape (point, 2). All are in m.
    A disc is a polygon of DISC_SIDES sides, a circle of an outline one of CIRCLE_SIDES, of the same
    area. size: the longest edge asked for [m]; edges are shorter where something small is near. A
    mesh that a file brings keeps its own size, and is cut where it does not conform.

    Raises InputError where a mesh file does not serve, or gmsh cannot be loaded.
    """
    if scene.skin.mesh is not None:
        return imported(scene, press, creases)
    return drawn(scene, press, size, creases)
