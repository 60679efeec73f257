"""A skin as triangles, and what each of them is part of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..press.capacitance import pixel_lines, touched_box
from ..press.press import Press
from ..press.touch import Disc, Place, Polygon, Rectangle, Touch
from ..scene.planar import Circle, inside, regular, sides
from ..scene.scene import Scene
from .arcs import NO_ARCS, Arcs, beside_chords, mapped
from .triangles import edges_of

Points = NDArray[np.float64]
Numbers = NDArray[np.int64]
Angular = Touch | Rectangle | Polygon
NO_EDGES = np.zeros((2, 0), dtype=np.int64)


@dataclass(frozen=True)
class Domain:
    """Triangles that meet edge to edge.

    p: points in m, shape (2 or 3, point). t: numbers of points, ascending in each column, shape
    (3, triangle). pixel: row * columns + column, both from 0, -1 where there is none, shape
    (triangle,). covered: whether each of `sharp_touches` covers a triangle, shape (touch,
    triangle). foils: for each contact the numbers of points of its facets, ascending in each
    column, shape (2, facet). seams: likewise of the edges that were asked for, across which
    something may jump. arcs: the edges that are not straight; none in space. out_of_round: what
    touches gain or lose of their effect by not being round, at most.
    """

    p: Points
    t: Numbers
    pixel: Numbers
    covered: NDArray[np.bool_]
    foils: dict[str, Numbers]
    seams: Numbers
    arcs: Arcs = NO_ARCS
    out_of_round: float = 0.0

    @property
    def curvature(self) -> NDArray[np.float64]:
        """Of the edges of each triangle from points 0 to 1, 1 to 2 and 0 to 2, in 1/m.

        Positive where the edge bends to the left, shape (3, triangle).
        """
        edges, of_triangle = edges_of(self.t)
        return self.arcs.of(edges)[of_triangle]

    @property
    def middles(self) -> Points:
        """A place within each triangle, m, shape (2, triangle)."""
        third = np.full((2, 1), 1 / 3)
        return mapped(self.p[:2], self.t, self.curvature, third)[0][:, :, 0]

    @property
    def areas(self) -> NDArray[np.float64]:
        """Of the triangles, m², shape (triangle,)."""
        return areas(self.p, self.t) + beside_chords(self.p, self.t, self.curvature).sum(axis=0)

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


def shape_of(scene: Scene, place: Place) -> Circle | Points:
    """The circle that a place is, or the corners of its polygon, shape (corner, 2)."""
    if isinstance(place, Disc):
        return Circle(place.x, place.y, place.radius)
    return polygon_of(scene, place)


def polygon_of(scene: Scene, place: Angular) -> Points:
    """The corners of a place that is no disc, shape (corner, 2)."""
    if isinstance(place, Polygon):
        return np.array(place.points, dtype=float)
    left, right, bottom, top = touched_box(scene, place)
    return np.array([(left, bottom), (right, bottom), (right, top), (left, top)])


def polygonal(place: Place, sides: int) -> Angular:
    """The same place; a disc as the regular polygon of so many sides and the same area."""
    if not isinstance(place, Disc):
        return place
    corners = regular(place.x, place.y, place.radius, sides)
    return Polygon(tuple((x, y) for x, y in corners.tolist()), place.factor)


def closed(shape: Circle | Points) -> Circle | Points:
    """A circle as it is; of corners (corner, 2) the sides between them, (segment, 2, 2)."""
    return shape if isinstance(shape, Circle) else sides(shape)


def edges_of_touches(
    scene: Scene, press: Press, creases: Sequence[Circle | Points]
) -> list[Circle | Points]:
    """Circles, and segments (segment, 2, 2), of touches with a factor and of creases; m."""
    return [
        *(closed(shape_of(scene, touch)) for touch in sharp_touches(press)),
        *(
            crease if isinstance(crease, Circle) else np.stack([crease[:-1], crease[1:]], axis=1)
            for crease in creases
        ),
    ]


def labelled(scene: Scene, press: Press, mesh: Domain) -> Domain:
    """Triangles that conform to pixels and touches, labelled by their middles."""
    middle = mesh.middles
    shapes = [shape_of(scene, touch) for touch in sharp_touches(press)]
    of_touches = [
        shape.holds(middle) if isinstance(shape, Circle) else inside(shape, middle)
        for shape in shapes
    ]
    covered = np.array(of_touches, dtype=bool).reshape(-1, mesh.t.shape[1])
    return replace(mesh, pixel=pixels(scene, middle), covered=covered)


def unlabelled(
    p: Points,
    t: Numbers,
    foils: dict[str, Numbers],
    seams: Numbers = NO_EDGES,
    arcs: Arcs = NO_ARCS,
) -> Domain:
    """Triangles before it is known what they are part of."""
    t = np.sort(t, axis=0)
    pixel, covered = np.full(t.shape[1], -1), np.zeros((0, t.shape[1]), dtype=bool)
    foils = {name: np.sort(facets, axis=0) for name, facets in foils.items()}
    return Domain(p, t, pixel, covered, foils, seams, arcs)


def pixels(scene: Scene, x: Points) -> Numbers:
    """The pixel at positions x in m, shape (2, point) to (point,); -1 beyond the grid."""
    column, row = (
        np.searchsorted(pixel_lines(scene, axis), x[axis], side="right") - 1 for axis in (0, 1)
    )
    rows, columns = scene.pixels.shape
    within = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
    return np.where(within, row * columns + column, -1)
