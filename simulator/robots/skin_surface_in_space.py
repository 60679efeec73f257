"""Surface of a mounted skin: from points in space to places on the unrolled skin, and back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ..arrays import Mask, Real
from ..compiled import compiled
from ..scene.form import Cylinder
from ..scene.skin import SheetsAndFoam
from ..scene.skin_region import on_skin

FLAT, BENT_ALONG_X, BENT_ALONG_Y, BALL, TRIANGLES = range(5)
BESIDE, SAME = 0.5, 1e-5
"""Largest distance of a point beside the nearest triangle over its height, and that at height 0, m.

Points above an edge between two triangles are beside both."""
NO_CORNERS, NO_FLAT, NO_BENDING = np.zeros((3, 3, 0)), np.zeros((3, 2, 0)), np.zeros((0, 3, 3))


class SurfaceNumbers(NamedTuple):
    """A surface in the frame of its mount, as kernels take it.

    kind: one of FLAT .. TRIANGLES. radius: of a cylinder or sphere, m. middle: of the stretched
    skin, m, (2,). stretch: ratios (2,). corners, flat: see `TriangleSurface`. bending: curvature of
    each triangle as a tensor, 1/m, (triangle, 3, 3).
    """

    kind: int
    radius: float
    middle: NDArray[np.float64]
    stretch: NDArray[np.float64]
    corners: NDArray[np.float64]
    flat: NDArray[np.float64]
    bending: NDArray[np.float64]


class PlaceOnSkin(NamedTuple):
    """The place on a skin that is nearest to a point in space.

    x, y: on the unrolled skin, m; beside it they go on as the surface does. height: distance of the
    point outward from the skin, m. normal: outward. triangle: its number, or 0. above: False for a
    point beside the triangles of a mesh.
    """

    x: float
    y: float
    height: float
    normal: tuple[float, float, float]
    triangle: int
    above: bool


class MountedSurface(Protocol):
    """Surface of a skin in the frame of its mount."""

    def points(self, x: Real) -> tuple[Real, Real, Mask]:
        """Points and outward normals, both (3, n), at places x, m, (2, n); True if on the skin."""
        ...

    def holds(self, x: Real) -> Mask:
        """True where places x, m, (2, n), are on the skin."""
        ...

    @property
    def numbers(self) -> SurfaceNumbers:
        """The surface as kernels take it."""
        ...


@dataclass(frozen=True)
class ShapedSurface:
    """A skin that is flat or bent to the scene's own shape, in the frame of a site.

    The site is at the middle of the skin: x along its length, y along its width, z outward.
    """

    skin: SheetsAndFoam

    @property
    def _middle(self) -> Real:
        return np.array([*self.skin.stretched_sides, 0.0]) / 2

    @property
    def _stretch(self) -> Real:
        ratios = self.skin.stretch.ratios if self.skin.stretch else (1.0, 1.0)
        return np.array(ratios)[:, None]

    def holds(self, x: Real) -> Mask:
        """Places on the skin, see `MountedSurface`."""
        return on_skin(self.skin, x)

    @property
    def numbers(self) -> SurfaceNumbers:
        """The surface, see `MountedSurface`."""
        shape, kind, radius = self.skin.shape, FLAT, np.inf
        if shape is not None:
            radius, kind = float(shape.radius), BALL
            if isinstance(shape, Cylinder):
                kind = BENT_ALONG_X if shape.axis == "y" else BENT_ALONG_Y
        flat = self._middle[:2], self._stretch[:, 0]
        return SurfaceNumbers(kind, radius, *flat, NO_CORNERS, NO_FLAT, NO_BENDING)

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

    def holds(self, x: Real) -> Mask:
        """Places on the skin, see `MountedSurface`."""
        found = np.zeros(x.shape[1], dtype=bool)
        for corners in self.flat.transpose(2, 0, 1):
            low, high = corners.min(axis=0)[:, None], corners.max(axis=0)[:, None]
            near = np.flatnonzero(((x >= low) & (x <= high)).all(axis=0))
            found[near] |= _within(corners, x[:, near])
        return found

    @property
    def numbers(self) -> SurfaceNumbers:
        """The surface, see `MountedSurface`."""
        plain = np.zeros(2), np.ones(2)
        corners, flat = np.ascontiguousarray(self.corners), np.ascontiguousarray(self.flat)
        return SurfaceNumbers(TRIANGLES, np.inf, *plain, corners, flat, self._bending)

    @property
    def _bending(self) -> Real:
        """Curvature of each triangle, 1/m, (triangle, 3, 3), from the normals at its corners.

        Source: S. Rusinkiewicz, Estimating curvatures and their derivatives on triangle meshes
        (2004): along its sides, the normal changes by the curvature times the side.
        """
        a, b, c = self.corners
        weighted = np.cross(b - a, c - a, axis=0)
        _, where = np.unique(
            self.corners.transpose(0, 2, 1).reshape(-1, 3).round(9), axis=0, return_inverse=True
        )
        total = np.zeros((where.max() + 1, 3))
        np.add.at(total, where.ravel(), np.tile(weighted.T, (3, 1)))
        total /= np.linalg.norm(total, axis=1, keepdims=True)
        normals = total[where.ravel()].reshape(3, -1, 3)
        bending = np.zeros((a.shape[1], 3, 3))
        for t in range(len(bending)):
            frame = np.linalg.svd(np.stack([(b - a)[:, t], (c - a)[:, t]]))[2][:2]
            sides = (self.corners[[1, 2, 0], :, t] - self.corners[..., t]) @ frame.T
            turns = (normals[[1, 2, 0], t] - normals[:, t]) @ frame.T
            (u, v), none = sides.T, np.zeros(3)
            rows = np.concatenate([np.stack([u, v, none], 1), np.stack([none, u, v], 1)])
            xx, xy, yy = np.linalg.lstsq(rows, turns.T.ravel(), rcond=None)[0]
            bending[t] = frame.T @ np.array([[xx, xy], [xy, yy]]) @ frame
        return bending

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


@compiled()
def place_of(surface: SurfaceNumbers, px: float, py: float, pz: float) -> PlaceOnSkin:
    """Nearest place of a point in the frame of the mount, m."""
    if surface.kind == TRIANGLES:
        return _place_on_triangles(surface, px, py, pz)
    radius, up = surface.radius, pz + surface.radius
    x, y, height, normal = px, py, pz, (0.0, 0.0, 1.0)
    if surface.kind == BENT_ALONG_X:
        far = np.sqrt(px * px + up * up)
        x, height, normal = radius * np.arctan2(px, up), far - radius, (px / far, 0.0, up / far)
    elif surface.kind == BENT_ALONG_Y:
        far = np.sqrt(py * py + up * up)
        y, height, normal = radius * np.arctan2(py, up), far - radius, (0.0, py / far, up / far)
    elif surface.kind == BALL:
        away = np.sqrt(px * px + py * py)
        far, longer = np.sqrt(away * away + up * up), radius * np.arctan2(away, up)
        if away > 0.0:
            x, y = longer * px / away, longer * py / away
        height, normal = far - radius, (px / far, py / far, up / far)
    x = (x + surface.middle[0]) / surface.stretch[0]
    y = (y + surface.middle[1]) / surface.stretch[1]
    return PlaceOnSkin(x, y, height, normal, 0, True)


@compiled()
def _place_on_triangles(surface: SurfaceNumbers, px: float, py: float, pz: float) -> PlaceOnSkin:
    """Nearest place on triangles; a point beside them goes on in the plane of the nearest one."""
    corners, flat = surface.corners, surface.flat
    triangle, nearest, weights = 0, np.inf, (1.0, 0.0, 0.0)
    for t in range(corners.shape[2]):
        own = _nearest(corners, t, px, py, pz)
        far = 0.0
        for axis in range(3):
            at = own[0] * corners[0, axis, t] + own[1] * corners[1, axis, t]
            away = (px, py, pz)[axis] - at - own[2] * corners[2, axis, t]
            far += away * away
        if far < nearest:
            triangle, nearest, weights = t, far, own
    ux, uy, uz, vx, vy, vz, wx, wy, wz = _sides(corners, triangle, px, py, pz)
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    size = np.sqrt(nx * nx + ny * ny + nz * nz)
    normal = nx / size, ny / size, nz / size
    height = wx * normal[0] + wy * normal[1] + wz * normal[2]
    beside = np.sqrt(max(nearest - height * height, 0.0))
    above = beside <= BESIDE * abs(height) + SAME
    if not above:
        weights = _weights(corners, triangle, px, py, pz)
    x, y = 0.0, 0.0
    for corner in range(3):
        x += weights[corner] * flat[corner, 0, triangle]
        y += weights[corner] * flat[corner, 1, triangle]
    return PlaceOnSkin(x, y, height, normal, triangle, above)


@compiled()
def _sides(
    corners: NDArray, t: int, px: float, py: float, pz: float
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """Two sides of a triangle and the way to a point, from its first corner, m."""
    ax, ay, az = corners[0, 0, t], corners[0, 1, t], corners[0, 2, t]
    return (
        *(corners[1, 0, t] - ax, corners[1, 1, t] - ay, corners[1, 2, t] - az),
        *(corners[2, 0, t] - ax, corners[2, 1, t] - ay, corners[2, 2, t] - az),
        *(px - ax, py - ay, pz - az),
    )


@compiled()
def _weights(
    corners: NDArray, t: int, px: float, py: float, pz: float
) -> tuple[float, float, float]:
    """Barycentric weights of a point's projection into the plane of a triangle."""
    ux, uy, uz, vx, vy, vz, wx, wy, wz = _sides(corners, t, px, py, pz)
    uu, uv = ux * ux + uy * uy + uz * uz, ux * vx + uy * vy + uz * vz
    vv = vx * vx + vy * vy + vz * vz
    wu, wv = wx * ux + wy * uy + wz * uz, wx * vx + wy * vy + wz * vz
    area = uu * vv - uv * uv
    second, third = (vv * wu - uv * wv) / area, (uu * wv - uv * wu) / area
    return 1 - second - third, second, third


@compiled()
def _nearest(
    corners: NDArray, t: int, px: float, py: float, pz: float
) -> tuple[float, float, float]:
    """Barycentric weights of the point of a triangle nearest to a point.

    Source: C. Ericson, Real-Time Collision Detection (2005), 5.1.5: the projection into the plane,
    or the best point of the three edges where it lies outside.
    """
    best = _weights(corners, t, px, py, pz)
    if min(best[0], best[1], best[2]) >= 0.0:
        return best
    least = np.inf
    for first in range(3):
        last, along, run, far = (first + 1) % 3, 0.0, 0.0, 0.0
        for axis in range(3):
            side = corners[last, axis, t] - corners[first, axis, t]
            along += ((px, py, pz)[axis] - corners[first, axis, t]) * side
            run += side * side
        part = min(max(along / run, 0.0), 1.0)
        for axis in range(3):
            side = corners[last, axis, t] - corners[first, axis, t]
            away = (px, py, pz)[axis] - corners[first, axis, t] - part * side
            far += away * away
        if far < least:
            least = far
            one, two = 1 - part, part
            best = (one, two, 0.0) if first == 0 else (0.0, one, two)
            if first == 2:
                best = (two, 0.0, one)
    return best


def _within(corners: Real, x: Real) -> Mask:
    """True where places x, m, (2, n), are in a triangle or on its sides. corners: m, (3, 2)."""
    (ux, uy), (vx, vy), (dx, dy) = (
        corners[1] - corners[0],
        corners[2] - corners[0],
        x - corners[:1].T,
    )
    area = ux * vy - uy * vx
    if area == 0.0:
        return np.zeros(x.shape[1], dtype=bool)
    second, third = (dx * vy - dy * vx) / area, (ux * dy - uy * dx) / area
    return np.minimum(np.minimum(second, third), 1 - second - third) >= -1e-9
