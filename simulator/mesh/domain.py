"""Triangle mesh of a skin, with the pixel and the touches of each triangle."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from skfem import MeshTri

from ..arrays import Integer, Mask, Real
from ..scene.planar import Circle, inside
from .arcs import NO_ARCS, Arcs, areas_beside_chords, edges_of, mapped
from .drawing import Drawing

Points = Real
NO_EDGES = np.zeros((2, 0), dtype=np.int64)


@dataclass(frozen=True)
class Domain:
    """Triangles that meet edge to edge.

    p: points in m, shape (2 or 3, point). t: numbers of points, ascending in each column, shape (3,
    triangle). pixel: row * columns + column, both from 0, -1 where there is none, shape
    (triangle,). covered: True where a touch of the drawing covers a triangle, shape (touch,
    triangle). foils: for each contact the numbers of points of its facets, ascending in each
    column, shape (2, facet). seams: likewise the edges along requested lines, across which
    something may jump. arcs: the edges that are not straight; none in space. out_of_round: largest
    fraction of its effect that a touch gains or loses by not being round.
    """

    p: Points
    t: Integer
    pixel: Integer
    covered: Mask
    foils: dict[str, Integer]
    seams: Integer
    arcs: Arcs = NO_ARCS
    out_of_round: float = 0.0

    @cached_property
    def flat(self) -> MeshTri:
        """Triangles for scikit-fem, straight and as seen along z."""
        p, t = np.ascontiguousarray(self.p[:2]), np.ascontiguousarray(self.t)
        return MeshTri(p, t, sort_t=False)

    @cached_property
    def curvature(self) -> Real:
        """Curvature of each triangle's edges 0 to 1, 1 to 2 and 0 to 2, 1/m.

        Positive where the edge bends to the left, shape (3, triangle).
        """
        edges, of_triangle = edges_of(self.t)
        return self.arcs.of(edges)[of_triangle]

    @property
    def middles(self) -> Points:
        """Place within each triangle, m, shape (2, triangle)."""
        third = np.full((2, 1), 1 / 3)
        return mapped(self.p[:2], self.t, self.curvature, third)[0][:, :, 0]

    @property
    def areas(self) -> Real:
        """Areas of the triangles, m², shape (triangle,)."""
        return areas(self.p, self.t) + areas_beside_chords(self.p, self.t, self.curvature).sum(
            axis=0
        )

    @property
    def lengths(self) -> Real:
        """Length of the longest edge of each triangle, m, shape (triangle,)."""
        a, b, c = (self.p[:, corner] for corner in self.t)
        return np.linalg.norm([a - b, b - c, c - a], axis=1).max(axis=0)


def areas(p: Points, t: Integer) -> Real:
    """Areas of triangles in the plane or in space, m², shape (triangle,)."""
    a, b, c = (p[:, corner] for corner in t)
    u, v = b - a, c - a
    squared = (u**2).sum(axis=0) * (v**2).sum(axis=0) - (u * v).sum(axis=0) ** 2
    if len(p) == 2:
        return np.abs(u[0] * v[1] - u[1] * v[0]) / 2
    return np.sqrt(np.maximum(squared, 0.0)) / 2


def labelled(drawing: Drawing, mesh: Domain) -> Domain:
    """Mesh that conforms to pixels and touches, with labels by triangles' middles."""
    middle = mesh.middles
    of_touches = [
        shape.holds(middle) if isinstance(shape, Circle) else inside(shape, middle)
        for shape in drawing.touches
    ]
    covered = np.array(of_touches, dtype=bool).reshape(-1, mesh.t.shape[1])
    return replace(mesh, pixel=drawing.pixel_at(middle), covered=covered)


def unlabelled(
    p: Points,
    t: Integer,
    foils: dict[str, Integer],
    seams: Integer = NO_EDGES,
    arcs: Arcs = NO_ARCS,
) -> Domain:
    """Mesh whose triangles have no pixel and no touches yet."""
    t = np.sort(t, axis=0)
    pixel, covered = np.full(t.shape[1], -1), np.zeros((0, t.shape[1]), dtype=bool)
    foils = {name: np.sort(facets, axis=0) for name, facets in foils.items()}
    return Domain(p, t, pixel, covered, foils, seams, arcs)
