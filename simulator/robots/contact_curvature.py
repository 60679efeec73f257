"""Curvature of touching geoms and of the skin at a contact, as tensors, compiled."""

from __future__ import annotations

from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from .skin_surface_in_space import FLAT, TRIANGLES, SurfaceNumbers

PatchName = Literal["hertz", "applicator", "image"]
PATCHES = get_args(PatchName)
HERTZ, APPLICATOR, IMAGE, FIXED = range(4)
PLANE, HEIGHT_FIELD, SPHERE, CAPSULE, ELLIPSOID, CYLINDER, BOX, MESH, OTHER = range(9)
"""Kinds of geoms, by their numbers in MuJoCo."""
UPRIGHT = 0.9
"""Smallest cosine between a cylinder's axis and the skin's normal for a contact by its flat end."""
TILTED = 0.1
"""Largest cosine between them for a contact by the cylinder's side."""
LONG = 0.05
"""Smaller over larger curvature below which a contact at one point is that of a sphere of the
larger one."""
AT_EDGE = 0.25
"""Distance from a box's edge over the foam's thickness up to which its edge presses."""
POINT = 4
"""First of a contact point's columns with its place in the frame of the mount."""


class PatchRule(NamedTuple):
    """Rule that gives contacts their patches.

    kind: HERTZ for the geom's own curvature; APPLICATOR for a flat end as wide as the geom; FIXED
    for discs of a `radius` in m; IMAGE as HERTZ, where the curvature only shares the force.
    """

    kind: int
    radius: float


class GeomNumbers(NamedTuple):
    """Geoms of a model at a moment, in the world, as MuJoCo has them.

    kind, size [m], place [m], axes: see `mjModel.geom_type`, `geom_size`, `mjData.geom_xpos`,
    `geom_xmat`. curvature: radius of those whose it is given, m, else NaN. own: True for those that
    carry the skin.
    """

    kind: NDArray[np.int32]
    size: NDArray[np.float64]
    place: NDArray[np.float64]
    axes: NDArray[np.float64]
    curvature: NDArray[np.float64]
    own: NDArray[np.bool_]


@compiled()
def is_upright(
    other: int, normal: NDArray, geoms: GeomNumbers, pose: tuple[NDArray, NDArray]
) -> bool:
    """True for a cylinder that stands on the skin."""
    if other >= len(geoms.kind) or geoms.kind[other] != CYLINDER:
        return False
    return abs(cosine_to(other, normal, geoms, pose)) > UPRIGHT


@compiled()
def cosine_to(
    other: int, normal: NDArray, geoms: GeomNumbers, pose: tuple[NDArray, NDArray]
) -> float:
    """Cosine between the last axis of a geom and a normal in the frame of the mount."""
    found = 0.0
    for i in range(3):
        for k in range(3):
            found += geoms.axes[other, 3 * i + 2] * pose[1][i, k] * normal[k]
    return found


@compiled()
def bending_of(surface: SurfaceNumbers, normal: NDArray, triangle: int) -> NDArray:
    """Curvature of the skin at a place as a tensor in the frame of its mount, 1/m, (3, 3)."""
    bent = np.zeros((3, 3))
    if surface.kind == TRIANGLES:
        for i in range(3):
            for j in range(3):
                bent[i, j] = surface.bending[triangle, i, j]
    elif surface.kind != FLAT:
        straight = (1, 0, -1)[surface.kind - 1]
        for i in range(3):
            for j in range(3):
                if straight not in (i, j):
                    bent[i, j] = ((i == j) - normal[i] * normal[j]) / surface.radius
    return bent


@compiled()
def add_bending(
    bent: NDArray,
    other: int,
    point: NDArray,
    normal: NDArray,
    geoms: GeomNumbers,
    pose: tuple[NDArray, NDArray],
    rule: PatchRule,
    thickness: float,
) -> float:
    """Add a geom's curvature at a point of the skin; returns the radius of a flat end, or 0, m.

    Edges, corners and shapes whose curvature is not known are as round as the foam is thick; planes
    and height fields are flat.
    """
    if other >= len(geoms.kind):
        _add_sphere(bent, normal, thickness)
        return 0.0
    origin, axes = pose
    kind, size = geoms.kind[other], geoms.size[other]
    own, place, upward = np.zeros((3, 3)), np.zeros(3), np.zeros(3)
    for i in range(3):
        for j in range(3):
            for k in range(3):  # axes of the geom in the frame of the mount
                own[i, j] += axes[k, i] * geoms.axes[other, 3 * k + j]
    for j in range(3):
        for i in range(3):
            at = point[i]
            for k in range(3):
                at -= axes[k, i] * (geoms.place[other, k] - origin[k])
            place[j] += own[i, j] * at
            upward[j] += own[i, j] * normal[i]
    flat = 0.0
    if geoms.curvature[other] > 0.0:
        flat = geoms.curvature[other]
        _add_sphere(bent, normal, flat)
    elif kind == SPHERE or (kind == CAPSULE and abs(place[2]) > size[1]):
        flat = size[0]
        _add_sphere(bent, normal, flat)
    elif kind == CAPSULE or kind == CYLINDER:
        flat = size[0]
        _add_sphere(bent, normal, flat)
        if kind == CAPSULE or abs(upward[2]) < TILTED:
            level = np.sqrt(max(1 - upward[2] ** 2, 1e-12))
            for i in range(3):
                for j in range(3):
                    one, two = own[i, 2] - upward[2] * normal[i], own[j, 2] - upward[2] * normal[j]
                    bent[i, j] -= one * two / (level * level * flat)
    elif kind == ELLIPSOID:
        flat = _add_ellipsoid(bent, upward, size, own)
    elif kind == BOX:
        sides = 0
        for k in range(3):
            sides += abs(place[k]) >= size[k] - AT_EDGE * thickness
        if sides > 1:
            _add_sphere(bent, normal, thickness)
    elif kind != PLANE and kind != HEIGHT_FIELD:
        _add_sphere(bent, normal, thickness)
    return flat if rule.kind == APPLICATOR else 0.0


@compiled()
def _add_sphere(bent: NDArray, normal: NDArray, radius: float) -> None:
    """Add the curvature of a sphere of a radius, m."""
    for i in range(3):
        for j in range(3):
            bent[i, j] += ((i == j) - normal[i] * normal[j]) / radius


@compiled()
def _add_ellipsoid(bent: NDArray, upward: NDArray, size: NDArray, own: NDArray) -> float:
    """Add the curvature of an ellipsoid where its normal is the skin's.

    upward: the skin's normal in its own frame with the axes `own`. Returns the radius of its shadow
    along that normal, m. Its curvature is that of x²/a² + ... = 1 in the plane of the contact, over
    the size of the gradient there.
    """
    steep, shadow = 0.0, 0.0
    for k in range(3):
        steep += (size[k] * upward[k]) ** 2
        shadow += (upward[k] / size[k]) ** 2
    steep = np.sqrt(steep)
    for i in range(3):
        for j in range(3):
            for a in range(3):
                for b in range(3):
                    for k in range(3):
                        level = ((a == k) - upward[a] * upward[k]) * (
                            (b == k) - upward[b] * upward[k]
                        )
                        bent[i, j] += own[i, a] * own[j, b] * level * steep / size[k] ** 2
    return np.sqrt(np.sqrt(shadow) * size[0] * size[1] * size[2])


@compiled()
def end_of(bent: NDArray, limit: float, thickness: float) -> tuple[float, float]:
    """Limit of the patch at one point and its curvature radius, m, by curvatures of both bodies.

    A Winkler foundation bears a paraboloid of two curvatures as a sphere of their geometric mean:
    the areas at each depth are equal.
    """
    if limit > 0.0:
        return limit, np.inf
    trace, square = 0.0, 0.0
    for i in range(3):
        trace += bent[i, i]
        for j in range(3):
            square += bent[i, j] * bent[i, j]
    product = (trace * trace - square) / 2
    away = np.sqrt(max(trace * trace / 4 - product, 0.0))
    most, least = trace / 2 + away, trace / 2 - away
    if most <= 1e-9 / thickness:
        return thickness, thickness
    radius = 1 / most if least < LONG * most else 1 / np.sqrt(most * least)
    return radius, radius


@compiled()
def radius_across(bent: NDArray, points: NDArray, thickness: float) -> float:
    """Radius of curvature across the line of contact points, m."""
    last, trace, along, length = len(points) - 1, 0.0, 0.0, 0.0
    for i in range(3):
        trace += bent[i, i]
        one = points[last, POINT + i] - points[0, POINT + i]
        length += one * one
        for j in range(3):
            along += one * bent[i, j] * (points[last, POINT + j] - points[0, POINT + j])
    across = trace - along / length if length > 0.0 else trace
    return 1 / across if across > 1e-9 / thickness else thickness
