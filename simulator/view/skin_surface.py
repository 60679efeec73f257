"""Skin as drawn: a surface in space, flat or wrapped, with exaggerated deflection."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Integer, Mask, Real

if TYPE_CHECKING:
    import pyvista as pv
    from scipy.spatial import KDTree

    from ..models.solution import SolutionFields

SAME_PLACE = 1.234e-7
"""Distance over the skin's extent up to which points are at one place."""
EDGE_STEP = 1e-3
"""Distance from an edge, over the skin's size, at which the skin is looked for."""
AROUND = 24
"""Number of points whose normals are averaged where a line is raised."""
SHOWN_DEPTH = 0.08
"""Depth of the deepest place as drawn, over the skin's size."""


@dataclass(frozen=True)
class SkinSurface:
    """Points in space (3, point) and unit normals, at flat places x (2, point), m.

    cells: (corner, cell), counter-clockwise as seen from the side of the normals. same: for each
    point the number of the first one at its place, since cells need not share points. exaggeration:
    factor on the deflection.
    """

    x: Real
    points: Real
    normals: Real
    cells: Integer
    same: Integer
    exaggeration: float

    @property
    def size(self) -> float:
        """Diagonal of the flat skin, m."""
        return float(np.hypot(*np.ptp(self.x, axis=1)))

    @cached_property
    def mesh(self) -> pv.PolyData:
        """Surface for pyvista."""
        return polygons(self.points, self.cells)

    @cached_property
    def _flat(self) -> pv.PolyData:
        flat = polygons(np.vstack([self.x, np.zeros_like(self.x[:1])]), self.cells)
        flat.point_data["points"] = self.points.T
        flat.point_data["normals"] = self.normals.T
        return flat

    def carry(self, x: Real) -> tuple[Real, Real, Mask]:
        """Places (3, n) in space of flat places x (2, n), and normals there.

        The third result is True for places on the skin, (n,). Off it, values of the nearest point
        are given.
        """
        from pyvista import PolyData

        probe = PolyData(np.vstack([x, np.zeros_like(x[:1])]).T)
        found = probe.sample(self._flat, tolerance=1e-9 * self.size, snap_to_closest_point=True)
        on_skin = found.point_data["vtkValidPointMask"].astype(bool)
        return (
            np.asarray(found.point_data["points"]).T,
            np.asarray(found.point_data["normals"]).T,
            on_skin,
        )

    def at(self, x: Real, values: Real) -> Real:
        """Values (k, point) at flat places (2, n) on the skin, (k, n)."""
        from pyvista import PolyData

        flat = self._flat.copy(deep=False)
        flat.point_data["values"] = values.T
        probe = PolyData(np.vstack([x, np.zeros_like(x[:1])]).T)
        found = probe.sample(flat, tolerance=1e-6 * self.size)
        return np.asarray(found.point_data["values"]).T

    def covers(self, x: Real) -> Mask:
        """True for flat places (2, n) that lie on the skin."""
        from pyvista import PolyData

        probe = PolyData(np.vstack([x, np.zeros_like(x[:1])]).T)
        found = probe.sample(self._flat, tolerance=1e-6 * self.size)
        return found.point_data["vtkValidPointMask"].astype(bool)

    def nearest(self, places: Real) -> Integer:
        """Numbers of the points that are nearest to places (3, n) in space."""
        return np.asarray(self._tree.query(places.T)[1])

    def normals_near(self, places: Real) -> Real:
        """Unit normals (3, n) near places (3, n), equal on both sides of a crease."""
        near = self._tree.query(places.T, k=min(AROUND, self.points.shape[1]))[1]
        mean = self.normals[:, near].mean(axis=-1)
        return mean / np.linalg.norm(mean, axis=0)

    @cached_property
    def _tree(self) -> KDTree:
        from scipy.spatial import KDTree

        return KDTree(self.points.T)

    @cached_property
    def rim(self) -> Integer:
        """Edges (2, edge) that only one cell has, in the direction of that cell."""
        corners = self.same[self.cells]
        edges = np.stack([corners, np.roll(corners, -1, axis=0)]).reshape(2, -1)
        _, back, counts = np.unique(
            np.sort(edges, axis=0), axis=1, return_inverse=True, return_counts=True
        )
        return edges[:, counts[back.ravel()] == 1]

    def outward(self, x: Real) -> Real:
        """Flat unit vectors (2, n) off the skin, across a path x (2, n) on its edge."""
        along = np.gradient(x, axis=1)
        across = np.stack([along[1], -along[0]]) / np.linalg.norm(along, axis=0)
        within = self.covers(x + EDGE_STEP * self.size * across)
        return across * (1.0 if within.mean() < 0.5 else -1.0)


def polygons(points: Real, cells: Integer) -> pv.PolyData:
    """Surface of points (3, point) and cells (corner, cell) for pyvista."""
    from pyvista import PolyData

    corners = np.full((1, cells.shape[1]), len(cells))
    return PolyData(np.ascontiguousarray(points.T), faces=np.vstack([corners, cells]).T.ravel())


def triangles(cells: Integer) -> Integer:
    """Cells (corner, cell) as triangles (3, n)."""
    return np.hstack([cells[[0, k, k + 1]] for k in range(1, len(cells) - 1)])


def surface(
    fields: SolutionFields, wrapped: bool = False, exaggeration: float = 0.0
) -> SkinSurface:
    """Skin, flat or where it is in space, deflected against its normals."""
    base = fields.position if wrapped else np.vstack([fields.x, np.zeros_like(fields.x[:1])])
    cells = _counter_clockwise(fields)
    same = _first_at_place(np.vstack([fields.x, base]))
    normals = _normals(polygons(base, same[cells]))[:, same]
    depth = np.full(len(same), np.inf)
    np.minimum.at(depth, same, fields.deflection)  # walls of foam without tension lie in its cells
    points = base - exaggeration * depth[same] * normals
    if exaggeration:
        normals = _normals(polygons(points, same[cells]))[:, same]
    return SkinSurface(fields.x, points, normals, cells, same, exaggeration)


def _first_at_place(places: Real) -> Integer:
    """Number of the first place that each place (k, point) equals, up to rounding."""
    grid = np.round(places / (SAME_PLACE * np.ptp(places[:2])))
    _, first, back = np.unique(grid, axis=1, return_index=True, return_inverse=True)
    return first[back.ravel()]


def is_curved(fields: SolutionFields) -> bool:
    """True if the skin lies anywhere but in the plane of its flat places."""
    flat = np.vstack([fields.x, np.zeros_like(fields.x[:1])])
    return not np.allclose(fields.position, flat, atol=1e-9 * np.ptp(fields.x), rtol=0.0)


def readable_exaggeration(fields: SolutionFields) -> float:
    """Factor that shows the deepest place: 1, 2 or 5 times a power of 10, >= 1."""
    size = np.hypot(*np.ptp(fields.x, axis=1))
    deepest = np.max(np.abs(fields.deflection), initial=0.0)
    wanted = float(SHOWN_DEPTH * size / deepest) if deepest > 0 else 1.0
    power = 10.0 ** math.floor(math.log10(wanted))
    return max(1.0, max(step * power for step in (1, 2, 5) if step * power <= wanted))


def _counter_clockwise(fields: SolutionFields) -> Integer:
    """Cells; those that go clockwise on the flat skin are reversed."""
    x, y = fields.x[:, fields.cells]
    area = (x * np.roll(y, -1, axis=0) - y * np.roll(x, -1, axis=0)).sum(axis=0)
    return np.where(area < 0, fields.cells[::-1], fields.cells)


def _normals(mesh: pv.PolyData) -> Real:
    with_normals = mesh.compute_normals(
        cell_normals=False,
        point_normals=True,
        split_vertices=False,
        consistent_normals=False,
        auto_orient_normals=False,
    )
    return np.asarray(with_normals.point_data["Normals"], dtype=float).T
