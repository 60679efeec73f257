"""Surface of a mounted skin: from points in space to places on the unrolled skin, and back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from ..arrays import Mask, Real
from ..scene.form.shape import Cylinder
from ..scene.skin import Skin
from ..scene.skin_region import on_skin

BESIDE, SAME = 0.5, 1e-5
"""Largest distance of a point beside the nearest triangle over its height, and that at height 0, m.

Points above an edge between two triangles are beside both."""


class PlacesOnSkin(NamedTuple):
    """Places on the skin that are nearest to points in space.

    x: on the unrolled skin, m, (2, n). height: distance of the point outward from the skin, m,
    (n,). normals: outward unit normals there, (3, n). on: True where the place is on the skin.
    """

    x: Real
    height: Real
    normals: Real
    on: Mask


class MountedSurface(Protocol):
    """Surface of a skin in the frame of its mount."""

    def places(self, points: Real) -> PlacesOnSkin:
        """Places on the skin nearest to points, m, shape (3, n)."""
        ...

    def points(self, x: Real) -> tuple[Real, Real, Mask]:
        """Points and outward normals, both (3, n), at places x, m, (2, n); True if on the skin."""
        ...


@dataclass(frozen=True)
class ShapedSurface:
    """A skin that is flat or bent to the scene's own shape, in the frame of a site.

    The site is at the middle of the skin: x along its length, y along its width, z outward.
    """

    skin: Skin

    @property
    def _middle(self) -> Real:
        return np.array([*self.skin.stretched_sides, 0.0]) / 2

    @property
    def _stretch(self) -> Real:
        ratios = self.skin.stretch.ratios if self.skin.stretch else (1.0, 1.0)
        return np.array(ratios)[:, None]

    def places(self, points: Real) -> PlacesOnSkin:
        """Nearest places, see `MountedSurface`."""
        x, height = self._unrolled(points)
        flat = (x + self._middle[:2, None]) / self._stretch
        normals = self.points(flat)[1]
        return PlacesOnSkin(flat, height, normals, on_skin(self.skin, flat))

    def points(self, x: Real) -> tuple[Real, Real, Mask]:
        """Points at places, see `MountedSurface`."""
        shape, sides, stretched = self.skin.shape, self.skin.stretched_sides, x * self._stretch
        on = on_skin(self.skin, x)
        if shape is None:
            flat = np.vstack([stretched, np.zeros_like(stretched[:1])])
            up = np.tile([[0.0], [0.0], [1.0]], x.shape[1])
            return flat - self._middle[:, None], up, on
        tangents = shape.tangents(stretched, sides)
        normals = np.cross(tangents[:, 0], tangents[:, 1], axis=0)
        normals /= np.linalg.norm(normals, axis=0)
        return shape.position(stretched, sides) - self._middle[:, None], normals, on

    def _unrolled(self, points: Real) -> tuple[Real, Real]:
        """Lengths along the skin from its middle, m, (2, n), and heights above it, m, (n,)."""
        shape = self.skin.shape
        if shape is None:
            return points[:2], points[2]
        if isinstance(shape, Cylinder):
            bent = 0 if shape.axis == "y" else 1
            x, up = points[:2].copy(), points[2] + shape.radius
            x[bent] = shape.radius * np.arctan2(points[bent], up)
            return x, np.hypot(points[bent], up) - shape.radius
        up, away = points[2] + shape.radius, np.hypot(*points[:2])
        angle = np.arctan2(away, up)
        direction = points[:2] / np.where(away > 0, away, 1.0)
        return shape.radius * angle * direction, np.hypot(away, up) - shape.radius


@dataclass(frozen=True)
class TriangleSurface:
    """A skin on triangles in space.

    corners: in space, m, (corner, 3, triangle), counter-clockwise as seen from outside. flat: the
    same on the unrolled skin, m, (corner, 2, triangle).
    """

    corners: Real
    flat: Real

    @property
    def _normals(self) -> Real:
        a, b, c = self.corners
        normals = np.cross(b - a, c - a, axis=0)
        return normals / np.linalg.norm(normals, axis=0)

    @property
    def area(self) -> float:
        """Area of all triangles in space, m²."""
        a, b, c = self.corners
        return float(np.linalg.norm(np.cross(b - a, c - a, axis=0), axis=0).sum() / 2)

    def places(self, points: Real) -> PlacesOnSkin:
        """Nearest places, see `MountedSurface`; all of them are on the skin or at its edge."""
        n = points.shape[1]
        x, height, normals, on = np.empty((2, n)), np.empty(n), np.empty((3, n)), np.empty(n, bool)
        all_normals = self._normals
        for k, point in enumerate(points.T):
            weights = _nearest(self.corners, point)
            offsets = point[:, None] - np.einsum("ct,cat->at", weights, self.corners)
            distance = np.linalg.norm(offsets, axis=0)
            t = int(distance.argmin())
            x[:, k] = weights[:, t] @ self.flat[..., t]
            normals[:, k] = all_normals[:, t]
            height[k] = offsets[:, t] @ normals[:, k]
            beside = np.linalg.norm(offsets[:, t] - height[k] * normals[:, k])
            on[k] = beside <= BESIDE * abs(height[k]) + SAME
        return PlacesOnSkin(x, height, normals, on)

    def points(self, x: Real) -> tuple[Real, Real, Mask]:
        """Points at places, see `MountedSurface`."""
        a, b, c = self.flat
        (ux, uy), (vx, vy) = b - a, c - a
        area = ux * vy - uy * vx
        n = x.shape[1]
        points, normals, on = np.zeros((3, n)), np.zeros((3, n)), np.zeros(n, bool)
        all_normals = self._normals
        for k, (px, py) in enumerate(x.T):
            dx, dy = px - a[0], py - a[1]
            second, third = (dx * vy - dy * vx) / area, (ux * dy - uy * dx) / area
            weights = np.stack([1 - second - third, second, third])
            t = int(weights.min(axis=0).argmax())
            on[k] = weights[:, t].min() >= -1e-9
            points[:, k] = weights[:, t] @ self.corners[..., t]
            normals[:, k] = all_normals[:, t]
        return points, normals, on


def _nearest(corners: Real, point: Real) -> Real:
    """Barycentric weights of the point of each triangle nearest to a point, (corner, triangle).

    Source: C. Ericson, Real-Time Collision Detection (2005), 5.1.5: the projection into the plane,
    or the best point of the three edges where it lies outside.
    """
    a, b, c = corners
    u, v, w = b - a, c - a, point[:, None] - a
    uu, uv, vv = (np.einsum("at,at->t", p, q) for p, q in ((u, u), (u, v), (v, v)))
    wu, wv = (np.einsum("at,at->t", w, p) for p in (u, v))
    area = uu * vv - uv * uv
    second, third = (vv * wu - uv * wv) / area, (uu * wv - uv * wu) / area
    best = np.stack([1 - second - third, second, third])
    outside = best.min(axis=0) < 0
    least = np.full(outside.shape, np.inf)
    for first, last in ((0, 1), (1, 2), (2, 0)):
        run = corners[last] - corners[first]
        along = np.einsum("at,at->t", point[:, None] - corners[first], run)
        along = np.clip(along / np.einsum("at,at->t", run, run), 0.0, 1.0)
        off = np.linalg.norm(point[:, None] - corners[first] - along * run, axis=0)
        nearer = outside & (off < least)
        least = np.where(nearer, off, least)
        edge = np.zeros_like(best)
        edge[first], edge[last] = 1 - along, along
        best = np.where(nearer, edge, best)
    return best
