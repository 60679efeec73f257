"""Patches on the unrolled skin under the contacts of touching geoms, compiled.

The points of one geom lie on an area, on a line, or are one. The area is their hull. The width of a
line, and the disc under one point, follow from the force, the foam's law, and the curvature of the
geom against that of the skin. What lies beside the skin is cut off, with its share of the force.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from ..models.mechanics.foam_law import (
    FoamTables,
    indenter_force,
    indenter_strain,
    patch_radius,
    stress,
)
from ..sensor.contacts.patch_kernel import CURVATURE, RADIUS, RINGS, stack_of_discs
from .contact_curvature import (
    CAPSULE,
    CYLINDER,
    FIXED,
    POINT,
    GeomNumbers,
    PatchRule,
    add_bending,
    bending_of,
    cosine_to,
    end_of,
    is_upright,
    radius_across,
)
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
from .skin_surface_in_space import SurfaceNumbers, place_of

SAME = 0.01
"""Largest distance of contact points at one place, over the foam's thickness."""
THIN = 0.05
"""Width over length of several contact points below which they lie on a line."""
SAMPLES, HALVINGS = 16, 40
BOTTOMED = 100.0
"""Force on a patch that is deeper than the foam, over that which compresses it to the end."""
GRAZING = 1e-3
"""Part of a force below which the skin does not feel it."""
MOST_DISCS = 40
"""Largest number of discs under the area of one geom."""
X, Y, FORCE, DEPTH, NORMAL, TRIANGLE = 0, 1, 2, 3, 7, 10
POINT_COLUMNS = 11
"""Columns of a contact point: place [m], force [N], depth in the engine [m], point on the skin and
normal in the frame of the mount, triangle of the skin."""


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
    carrier: int,
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

    points: (n, POINT_COLUMNS). carrier: number of the geom that carries the skin. other: number of
    the touching one, beyond all for soft bodies. pose: origin and axes of the mount. patches: x, y,
    force, radius and curvature radius, (patch, 5).
    """
    deep = points[0, DEPTH] >= foam.thickness
    if len(points) == 1 and (deep or geoms.kind[carrier] in (CAPSULE, CYLINDER)):
        points = _along_axis(points, carrier, other, geoms, pose, surface, SAME * foam.thickness)
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
                points[k : k + 1],
                points[k, X],
                points[k, Y],
                (rule.radius, np.inf),
                bottomed,
                area,
                foam,
                patches,
                found,
            )
            found, total, area_sum = one.found, total + one.force, area_sum + one.area
            at_x, at_y = at_x + one.force * one.x, at_y + one.force * one.y
        if total == 0.0:
            return Pressed(found, 0.0, 0.0, x, y)
        return Pressed(found, total, area_sum, at_x / total, at_y / total)
    (along, width, direction), corners = _spread(points), points[:0, :2]
    wide = count > 2 and width > THIN * along and along > SAME * foam.thickness
    if wide:
        corners = hull_of(points[:, :2])
    if is_upright(other, normal, geoms, pose):
        side = -1.0 if cosine_to(other, normal, geoms, pose) > 0 else 1.0
        end_at = _end_of_axis(other, side, geoms, pose)
        at = place_of(surface, end_at[0], end_at[1], end_at[2])
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
    limit = add_bending(bent, other, middle, normal, geoms, pose, rule, foam.thickness)
    if along <= SAME * foam.thickness:
        end = end_of(bent, limit, foam.thickness)
        return _disc(points, x, y, end, bottomed, area, foam, patches, found)
    wide = 2 * limit
    if limit == 0.0:
        radius = radius_across(bent, points, foam.thickness)
        wide = 2 * strip_half_width(foam, radius, force / max(along, radius))
    if along < wide:
        end = max(np.sqrt(along * wide / np.pi), wide / 2), np.inf
        return _disc(points, x, y, end, bottomed, area, foam, patches, found)
    corners = _rectangle(points, direction, wide)
    return _polygon(points, corners, bottomed, area, foam, patches, found)


@compiled()
def _end_of_axis(
    other: int, side: float, geoms: GeomNumbers, pose: tuple[NDArray, NDArray]
) -> NDArray:
    """A place on a cylinder's or capsule's axis in the frame of the mount, m. side: -1..1."""
    (origin, axes), at = pose, np.zeros(3)
    for i in range(3):
        for j in range(3):
            along = side * geoms.size[other, 1] * geoms.axes[other, 3 * j + 2]
            at[i] += axes[j, i] * (geoms.place[other, j] + along - origin[j])
    return at


@compiled()
def _side_on_carrier(carrier: int, other: int, side: float, geoms: GeomNumbers) -> float:
    """Part of half an axis, -1..1, up to an end of it or of a cylinder beside that carries it."""
    if geoms.kind[carrier] not in (CAPSULE, CYLINDER):
        return side
    along, away = 0.0, 0.0
    for i in range(3):
        own, axis = geoms.axes[carrier, 3 * i + 2], geoms.axes[other, 3 * i + 2]
        along += own * axis * geoms.size[other, 1]
        away += own * (geoms.place[other, i] - geoms.place[carrier, i])
    half = geoms.size[carrier, 1]
    beyond = away + side * along
    if abs(beyond) <= half or along == 0.0:
        return side
    return min(max((np.sign(beyond) * half - away) / along, -1.0), 1.0)


@compiled()
def _along_axis(
    points: NDArray,
    carrier: int,
    other: int,
    geoms: GeomNumbers,
    pose: tuple[NDArray, NDArray],
    surface: SurfaceNumbers,
    near: float,
) -> NDArray:
    """The one point of a geom, or both ends of a capsule or cylinder that lies on the skin.

    The engine gives one point of it on another cylinder, and if its axis is below the surface of
    the other geom. near: largest height of its ends above the skin, m.
    """
    if other >= len(geoms.kind) or geoms.kind[other] not in (CAPSULE, CYLINDER):
        return points
    ends = np.empty((2, points.shape[1]))
    for k in range(2):
        side = _side_on_carrier(carrier, other, 2.0 * k - 1, geoms)
        at = _end_of_axis(other, side, geoms, pose)
        place = place_of(surface, at[0], at[1], at[2])
        if place.height > geoms.size[other, 0] + near:
            return points
        for column in range(points.shape[1]):
            ends[k, column] = points[0, column]
        ends[k, X], ends[k, Y], ends[k, FORCE] = place.x, place.y, points[0, FORCE] / 2
        for i in range(3):
            ends[k, POINT + i] = at[i] - place.height * place.normal[i]
    return ends


@compiled()
def _middle(points: NDArray) -> tuple[float, float]:
    """Mean place of points on the skin, m."""
    x, y = 0.0, 0.0
    for k in range(len(points)):
        x, y = x + points[k, X] / len(points), y + points[k, Y] / len(points)
    return x, y


@compiled()
def _spread(points: NDArray) -> tuple[float, float, tuple[float, float]]:
    """Length and width of points, m, and the direction of the length, by their moments."""
    count, (mean_x, mean_y) = len(points), _middle(points)
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
    count, (x, y) = len(points), _middle(points)
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
