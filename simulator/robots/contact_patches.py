"""Patches on the unrolled skin under the contacts of touching geoms, compiled.

The points of one geom lie on an area, on a line, or are one. The area is their hull. The width of a
line, and the disc under one point, follow from the force, the foam's law, and the curvature of the
geom against that of the skin. What lies beside the skin is cut off, with its share of the force.
"""

from __future__ import annotations

from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from ..sensor.contacts.foam_kernel import indenter_force, indenter_strain, patch_radius, stress
from ..sensor.contacts.foam_tables import FoamTables
from ..sensor.contacts.patch_kernel import CURVATURE, RADIUS
from ..sensor.contacts.winkler_kernel import RINGS, stack_of_discs
from .skin_polygons import (
    SkinArea,
    area_of,
    circle_of,
    disc_on_skin,
    discs_over,
    holds,
    hull_of,
    on_area,
    skin_under,
    to_whole,
    within_rectangle,
)
from .skin_surface_in_space import FLAT, TRIANGLES, PlaceOnSkin, SurfaceNumbers, place_of

PatchName = Literal["hertz", "applicator", "image"]
PATCHES = get_args(PatchName)
HERTZ, APPLICATOR, IMAGE, FIXED = range(4)
PLANE, HEIGHT_FIELD, SPHERE, CAPSULE, ELLIPSOID, CYLINDER, BOX, MESH, OTHER = range(9)
"""Kinds of geoms, by their numbers in MuJoCo."""
UPRIGHT = 0.9
"""Smallest cosine between a cylinder's axis and the skin's normal for a contact by its flat end."""
TILTED = 0.1
"""Largest cosine between them for a contact by the cylinder's side."""
SAME = 0.01
"""Largest distance of contact points at one place, over the foam's thickness."""
THIN = 0.05
"""Width over length of several contact points below which they lie on a line."""
LONG = 0.05
"""Smaller over larger curvature below which a contact at one point is that of a sphere of the
larger one."""
AT_EDGE = 0.25
"""Distance from a box's edge over the foam's thickness up to which its edge presses."""
SAMPLES, HALVINGS = 16, 40
BOTTOMED = 100.0
"""Force on a patch that is deeper than the foam, over that which compresses it to the end."""
GRAZING = 1e-3
"""Part of a force below which the skin does not feel it."""
MOST_DISCS = 40
"""Largest number of discs under the area of one geom."""
X, Y, FORCE, DEPTH, POINT, NORMAL, TRIANGLE = 0, 1, 2, 3, 4, 7, 10
POINT_COLUMNS = 11
"""Columns of a contact point: place [m], force [N], depth in the engine [m], point on the skin and
normal in the frame of the mount, triangle of the skin."""


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


class Pressed(NamedTuple):
    """What one touching geom does to the skin.

    found: number of patches so far. force: felt, N. area: under it, m². x, y: middle, m.
    """

    found: int
    force: float
    area: float
    x: float
    y: float


@compiled()
def press_of_geom(
    points: NDArray,
    other: int,
    geoms: GeomNumbers,
    pose: tuple[NDArray, NDArray],
    surface: SurfaceNumbers,
    area: SkinArea,
    rule: PatchRule,
    foam: FoamTables,
    patches: NDArray,
    found: int,
) -> Pressed:
    """Patches of the contact points of one geom, into `patches` behind the `found` first ones.

    points: (n, POINT_COLUMNS). other: number of the geom, beyond all for soft bodies. pose: origin
    and axes of the mount. patches: x, y, force, radius and curvature radius, (patch, 5).
    """
    if len(points) == 1 and points[0, DEPTH] >= foam.thickness:
        points = _along_axis(points, other, geoms, pose, surface)
    count, bottomed = len(points), False
    force, x, y, normal = 0.0, 0.0, 0.0, np.zeros(3)
    for k in range(count):
        bottomed |= points[k, DEPTH] >= foam.thickness
        force += points[k, FORCE]
        x += points[k, FORCE] * points[k, X]
        y += points[k, FORCE] * points[k, Y]
        for axis in range(3):
            normal[axis] += points[k, NORMAL + axis] / count
    x, y = x / force, y / force
    if rule.kind == FIXED:
        total, area_sum, at_x, at_y = 0.0, 0.0, 0.0, 0.0
        for k in range(count):
            one = _disc(
                points[k : k + 1], points[k, X], points[k, Y], (rule.radius, np.inf), bottomed,
                area, foam, patches, found,
            )  # fmt: skip
            found, total, area_sum = one.found, total + one.force, area_sum + one.area
            at_x, at_y = at_x + one.force * one.x, at_y + one.force * one.y
        if total == 0.0:
            return Pressed(found, 0.0, 0.0, x, y)
        return Pressed(found, total, area_sum, at_x / total, at_y / total)
    (along, width, direction), corners = _spread(points), points[:0, :2]
    wide = count > 2 and width > THIN * along and along > SAME * foam.thickness
    if wide:
        corners = hull_of(points[:, :2])
    if _is_upright(other, normal, geoms, pose):
        at = _end_of_axis(other, normal, geoms, pose, surface)
        if not wide or holds(corners, at.x, at.y):
            x, y = (at.x, at.y) if wide else (x, y)
            end = geoms.size[other, 0], np.inf
            return _disc(points, x, y, end, bottomed, area, foam, patches, found)
    if wide:
        return _polygon(points, corners, bottomed, area, foam, patches, found)
    middle = np.zeros(3)
    for k in range(count):
        for axis in range(3):
            middle[axis] += points[k, POINT + axis] / count
    bent = bending_of(surface, normal, int(points[0, TRIANGLE]))
    limit = _add_bending(bent, other, middle, normal, geoms, pose, rule, foam.thickness)
    if along <= SAME * foam.thickness:
        end = _end(bent, limit, foam.thickness)
        return _disc(points, x, y, end, bottomed, area, foam, patches, found)
    wide = 2 * limit
    if limit == 0.0:
        radius = _radius_across(bent, points, foam.thickness)
        wide = 2 * strip_half_width(foam, radius, force / max(along, radius))
    if along < wide:
        end = max(np.sqrt(along * wide / np.pi), wide / 2), np.inf
        return _disc(points, x, y, end, bottomed, area, foam, patches, found)
    corners = _rectangle(points, direction, wide)
    return _polygon(points, corners, bottomed, area, foam, patches, found)


@compiled()
def _is_upright(
    other: int, normal: NDArray, geoms: GeomNumbers, pose: tuple[NDArray, NDArray]
) -> bool:
    """True for a cylinder that stands on the skin."""
    if other >= len(geoms.kind) or geoms.kind[other] != CYLINDER:
        return False
    return abs(_cosine(other, normal, geoms, pose)) > UPRIGHT


@compiled()
def _cosine(
    other: int, normal: NDArray, geoms: GeomNumbers, pose: tuple[NDArray, NDArray]
) -> float:
    """Cosine between the last axis of a geom and a normal in the frame of the mount."""
    found = 0.0
    for i in range(3):
        for k in range(3):
            found += geoms.axes[other, 3 * i + 2] * pose[1][i, k] * normal[k]
    return found


@compiled()
def _end_of_axis(
    other: int,
    normal: NDArray,
    geoms: GeomNumbers,
    pose: tuple[NDArray, NDArray],
    surface: SurfaceNumbers,
) -> PlaceOnSkin:
    """Place of the end of a cylinder's axis that is next to the skin."""
    (origin, axes), at = pose, np.zeros(3)
    half = geoms.size[other, 1] * (-1 if _cosine(other, normal, geoms, pose) > 0 else 1)
    for i in range(3):
        for j in range(3):
            end = geoms.place[other, j] + half * geoms.axes[other, 3 * j + 2]
            at[i] += axes[j, i] * (end - origin[j])
    return place_of(surface, at[0], at[1], at[2])


@compiled()
def _along_axis(
    points: NDArray,
    other: int,
    geoms: GeomNumbers,
    pose: tuple[NDArray, NDArray],
    surface: SurfaceNumbers,
) -> NDArray:
    """The one point of a geom, or both ends of a capsule or cylinder that is below the skin.

    The engine gives one point of it if its axis is below the surface of the other geom.
    """
    if other >= len(geoms.kind) or geoms.kind[other] not in (CAPSULE, CYLINDER):
        return points
    ends, (origin, axes) = np.empty((2, POINT_COLUMNS)), pose
    for k in range(2):
        at, half = np.zeros(3), (2 * k - 1) * geoms.size[other, 1]
        for i in range(3):
            for j in range(3):
                end = geoms.place[other, j] + half * geoms.axes[other, 3 * j + 2]
                at[i] += axes[j, i] * (end - origin[j])
        place = place_of(surface, at[0], at[1], at[2])
        if place.height > geoms.size[other, 0]:
            return points
        for column in range(POINT_COLUMNS):
            ends[k, column] = points[0, column]
        ends[k, X], ends[k, Y], ends[k, FORCE] = place.x, place.y, points[0, FORCE] / 2
        for i in range(3):
            ends[k, POINT + i] = at[i] - place.height * place.normal[i]
    return ends


@compiled()
def _spread(points: NDArray) -> tuple[float, float, tuple[float, float]]:
    """Length and width of points, m, and the direction of the length, by their moments."""
    count, mean_x, mean_y = len(points), 0.0, 0.0
    for k in range(count):
        mean_x, mean_y = mean_x + points[k, X] / count, mean_y + points[k, Y] / count
    xx, xy, yy = 0.0, 0.0, 0.0
    for k in range(count):
        u, v = points[k, X] - mean_x, points[k, Y] - mean_y
        xx, xy, yy = xx + u * u, xy + u * v, yy + v * v
    angle = np.arctan2(2 * xy, xx - yy) / 2
    ux, uy = np.cos(angle), np.sin(angle)
    low, high, down, up = np.inf, -np.inf, np.inf, -np.inf
    for k in range(count):
        u, v = points[k, X] - mean_x, points[k, Y] - mean_y
        along, across = u * ux + v * uy, v * ux - u * uy
        low, high, down, up = min(low, along), max(high, along), min(down, across), max(up, across)
    return high - low, up - down, (ux, uy)


@compiled()
def _rectangle(points: NDArray, direction: tuple[float, float], wide: float) -> NDArray:
    """Corners of a strip of a width along points, m, (4, 2)."""
    count, x, y = len(points), 0.0, 0.0
    for k in range(count):
        x, y = x + points[k, X] / count, y + points[k, Y] / count
    (ux, uy), low, high = direction, np.inf, -np.inf
    for k in range(count):
        along = (points[k, X] - x) * ux + (points[k, Y] - y) * uy
        low, high = min(low, along), max(high, along)
    corners = np.empty((4, 2))
    for k in range(4):
        along, across = low if k in (0, 3) else high, wide / 2 if k > 1 else -wide / 2
        corners[k, 0], corners[k, 1] = x + along * ux - across * uy, y + along * uy + across * ux
    return corners


@compiled()
def _disc(
    points: NDArray,
    x: float,
    y: float,
    end: tuple[float, float],
    bottomed: bool,
    area: SkinArea,
    foam: FoamTables,
    patches: NDArray,
    found: int,
) -> Pressed:
    """Patch of a round end: its radius or limit, and its curvature radius, m."""
    force, (limit, curvature) = 0.0, end
    for k in range(len(points)):
        force += points[k, FORCE]
    radius, most, strain = limit, foam.closed * np.pi * limit * limit, foam.greatest
    if curvature < np.inf:
        most = indenter_force(foam, strain, limit, curvature)
        if not bottomed:
            strain = indenter_strain(foam, force, limit, curvature)
        radius = patch_radius(foam, strain, limit, curvature)
    part = disc_on_skin(x, y, radius, area)
    size = np.pi * radius * radius * part
    if curvature < np.inf and part < 1.0:
        part = _sphere_on_skin(x, y, end, strain, foam, area)
    if part < GRAZING:
        return Pressed(found, 0.0, 0.0, x, y)
    if not on_area(area, x, y):
        corners = within_rectangle(circle_of(x, y, radius), area.length, area.width)
        if len(corners) == 0:
            return Pressed(found, 0.0, 0.0, x, y)
        return _fill(points, corners, corners, part, size, bottomed, area, foam, patches, found)
    pressing = max(force, BOTTOMED * most) if bottomed else force
    row = patches[found]
    row[0], row[1], row[2], row[3], row[4] = x, y, pressing * part, limit, curvature
    return Pressed(found + 1, force * part, size, x, y)


@compiled()
def _sphere_on_skin(
    x: float,
    y: float,
    end: tuple[float, float],
    strain: float,
    foam: FoamTables,
    area: SkinArea,
) -> float:
    """Part of a sphere's force that the foam under a skin bears, with a strain in the middle."""
    radii, rises, pressures = np.zeros(RINGS), np.zeros(RINGS), np.zeros(RINGS)
    contact, felt, whole = np.zeros(7), 0.0, 0.0
    contact[RADIUS], contact[CURVATURE] = end
    for k in range(stack_of_discs(contact, strain, foam, radii, rises, pressures)):
        force = pressures[k] * radii[k] * radii[k]
        whole, felt = whole + force, felt + force * disc_on_skin(x, y, radii[k], area)
    return felt / whole if whole > 0.0 else 0.0


@compiled()
def _polygon(
    points: NDArray,
    corners: NDArray,
    bottomed: bool,
    area: SkinArea,
    foam: FoamTables,
    patches: NDArray,
    found: int,
) -> Pressed:
    """Patches over a convex polygon that is pressed at points in it."""
    cut, whole = within_rectangle(corners, area.length, area.width), area_of(corners)
    part = area_of(cut) / whole * skin_under(cut, area) if len(cut) else 0.0
    if not part > GRAZING:
        return Pressed(found, 0.0, 0.0, 0.0, 0.0)
    part = to_whole(part)
    return _fill(points, corners, cut, part, whole * part, bottomed, area, foam, patches, found)


@compiled()
def _fill(
    points: NDArray,
    corners: NDArray,
    cut: NDArray,
    part: float,
    size: float,
    bottomed: bool,
    area: SkinArea,
    foam: FoamTables,
    patches: NDArray,
    found: int,
) -> Pressed:
    """Discs over the part of a polygon that is on the skin, of an area `size`, m².

    Over the whole polygon their forces have the sum of those of the points, and nearly their
    moments: they are linear in the place; negative ones become 0. part: of the force that is felt.
    """
    at, middle, slopes = discs_over(cut, area, False), np.zeros(2), np.zeros(2)
    grid, force, moments, spread = discs_over(corners, area, True), 0.0, np.zeros(2), np.zeros(3)
    count = len(grid)
    for k in range(count):
        middle[0], middle[1] = middle[0] + grid[k, 0] / count, middle[1] + grid[k, 1] / count
    for k in range(count):
        u, v = grid[k, 0] - middle[0], grid[k, 1] - middle[1]
        spread[0], spread[1], spread[2] = spread[0] + u * u, spread[1] + u * v, spread[2] + v * v
    for k in range(len(points)):
        force += points[k, FORCE]
        moments[0] += (points[k, X] - middle[0]) * points[k, FORCE]
        moments[1] += (points[k, Y] - middle[1]) * points[k, FORCE]
    (xx, xy, yy), square = spread, (spread[0] + spread[2]) ** 2
    whole = xx * yy - xy * xy
    if whole > 1e-9 * square:
        slopes[0] = (yy * moments[0] - xy * moments[1]) / whole
        slopes[1] = (xx * moments[1] - xy * moments[0]) / whole
    elif square > 0.0:  # on a line, along which alone there is a slope
        slopes[0] = (xx * moments[0] + xy * moments[1]) / square
        slopes[1] = (xy * moments[0] + yy * moments[1]) / square
    sum_, x, y, first = 0.0, 0.0, 0.0, found
    radius = np.sqrt(size / max(len(at), 1) / np.pi)
    for k in range(len(at)):
        u, v = at[k, 0] - middle[0], at[k, 1] - middle[1]
        own = max(force / count + slopes[0] * u + slopes[1] * v, 0.0)
        row = patches[found]
        row[0], row[1], row[2], row[3], row[4] = at[k, 0], at[k, 1], own, radius, np.inf
        sum_, found = sum_ + own, found + 1
    for k in range(first, found):
        own = 1 / (found - first)
        if sum_ > 0.0:
            own = patches[k, 2] / sum_
        patches[k, 2] = own * force * part
        x, y = x + own * patches[k, 0], y + own * patches[k, 1]
        if bottomed:
            closing = BOTTOMED * foam.closed * np.pi * radius * radius
            patches[k, 2] = max(patches[k, 2], closing)
    return Pressed(found, force * part if found > first else 0.0, size, x, y)


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
def _add_bending(
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
def _end(bent: NDArray, limit: float, thickness: float) -> tuple[float, float]:
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
def _radius_across(bent: NDArray, points: NDArray, thickness: float) -> float:
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


@compiled()
def strip_half_width(foam: FoamTables, radius: float, load: float) -> float:
    """Half of the width of the contact with a long cylinder, m.

    Columns of foam that do not hold each other bear it: load = 2 int p((d - x²/2R)/h) dx over
    x = 0..a, a² = 2 R d. radius: of the cylinder, m. load: N/m.
    """
    low, high, thickness = 0.0, foam.greatest, foam.thickness
    for _ in range(HALVINGS):
        strain, pressure = (low + high) / 2, 0.0
        for k in range(SAMPLES):
            part = (k + 0.5) / SAMPLES
            pressure += stress(foam, strain * (1 - part * part)) / SAMPLES
        if 2 * np.sqrt(2 * radius * strain * thickness) * pressure > load:
            high = strain
        else:
            low = strain
    return min(np.sqrt(2 * radius * high * thickness), radius)
