"""Triangles of the skin that conform to applicators, and the triangles under each applicator."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from skfem import MeshTri

from ...arrays import Integer, Mask, Real
from ...mesh.domain import Domain
from ...mesh.drawing import polygon_of, polygonal, shape_of
from ...mesh.refinement import refined
from ...mesh.skin_mesh import domain
from ...press.press import Press
from ...press.touch import Disc, Place, Touch
from ...scene.form import Curve
from ...scene.parts import Skin
from ...scene.planar import Circle, regular
from ...sweeps import InputError
from .deformation import check_plane

COARSEST = 8
"""Number of triangles along the longer side of the skin before refinement."""
RIM_SIDES = 512
"""Sides of the polygon that replaces a circle of the outline, where deflections are small."""


@dataclass(frozen=True)
class ContactMesh:
    """Triangles of the skin under applicators.

    pixel: number of the pixel under each applicator, shape (applicator,); -1 for one that is a
    touch of the domain, in order. sharp: (2, corner) corners of applicators, m. edges: total
    perimeter, m.
    """

    domain: Domain
    pixel: Integer
    sharp: Real
    edges: float

    @cached_property
    def mesh(self) -> MeshTri:
        """The mesh of scikit-fem."""
        return MeshTri(np.ascontiguousarray(self.domain.p), np.ascontiguousarray(self.domain.t))

    @cached_property
    def covered(self) -> Mask:
        """True where an applicator covers a triangle, shape (applicator, triangle)."""
        found = np.equal.outer(self.pixel, self.domain.pixel)
        found[self.pixel < 0] = self.domain.covered
        return found

    @cached_property
    def cornered(self) -> Mask:
        """True for triangles with a corner of an applicator as a point, shape (triangle,)."""
        from scipy.spatial import KDTree

        if not self.sharp.size:
            return np.zeros(self.domain.t.shape[1], bool)
        points = KDTree(self.domain.p.T).query(self.sharp.T)[1]
        return np.any(np.isin(self.domain.t, points), axis=0)

    def refined(self, marked: Mask) -> ContactMesh:
        """Mesh with the marked triangles halved each way."""
        return replace(self, domain=refined(self.domain, np.flatnonzero(marked)))


def contact_mesh(
    skin: Skin, places: Sequence[Place], named: Sequence[Place] | None = None
) -> ContactMesh:
    """Mesh of a scene's skin under applicators of the shapes of `places`.

    named: places whose names messages use, by default `places`. Raises InputError if the skin is no
    plane, or a place lies outside it.
    """
    check_plane(skin)
    size = max(skin.length, skin.width) / COARSEST
    drawn = tuple(place for place in places if not isinstance(place, Touch))
    found = domain(skin, Press(drawn), size)
    columns = skin.pixels.columns
    pixel = [(p.row - 1) * columns + p.column - 1 if isinstance(p, Touch) else -1 for p in places]
    shapes = [shape_of(skin, place) for place in places]
    angular = [shape for shape in shapes if not isinstance(shape, Circle)]
    sharp = np.concatenate([np.zeros((0, 2)), *angular]).T
    meshed = ContactMesh(found, np.array(pixel), sharp, sum(map(_around, shapes)))
    for place, covered in zip(named or places, meshed.covered, strict=True):
        if not covered.any():
            raise InputError(f"press {place.where}: must touch the skin of {skin.name}")
    return meshed


def straight_contact_mesh(skin: Skin, places: Sequence[Place], sides: int) -> ContactMesh:
    """Mesh of straight triangles: a disc becomes a polygon of that many sides and of the same area.

    Its corners are so blunt that they count as none.
    """
    meshed = contact_mesh(_angular(skin), [polygonal(place, sides) for place in places], places)
    angular = [polygon_of(skin, place) for place in places if not isinstance(place, Disc)]
    return replace(meshed, sharp=np.concatenate([np.zeros((0, 2)), *angular]).T)


def _angular(skin: Skin) -> Skin:
    """Skin with polygons for the circles of its outline."""
    outline = skin.outline
    if outline is None:
        return skin
    holes = tuple(Curve(points=_sides(hole)) for hole in outline.holes)
    changed = {"points": _sides(outline), "circle": None, "holes": holes}
    return replace(skin, outline=outline.model_copy(update=changed))


def _sides(curve: Curve) -> tuple[tuple[float, float], ...] | None:
    if curve.circle is None:
        return curve.points
    return tuple((x, y) for x, y in regular(*curve.circle, RIM_SIDES).tolist())


def _around(shape: Circle | Real) -> float:
    if isinstance(shape, Circle):
        return 2 * np.pi * shape.radius
    return float(np.linalg.norm(shape - np.roll(shape, 1, axis=0), axis=1).sum())
