"""Potential and field of uniformly charged flat panels, in closed form.

They are sums over the edges of each polygon, exact at any distance and on the panel itself: D. R.
Wilton et al., IEEE Trans. Antennas Propagat. 32 (1984) 276-281, equations 5 and 11.
"""

from __future__ import annotations

from math import atan, log, sqrt

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled

IN_PLANE = 1e-9
"""Distance from a panel's plane, or an edge's line, below which a point is on it.

It is over the length of an edge. The field across the panel is then the mean of both sides.
"""


@compiled()
def fill_influence(
    points: NDArray,
    normals: NDArray,
    corners: NDArray,
    images: NDArray,
    potential: NDArray,
    slope: NDArray,
) -> None:  # pragma: no cover
    """Adds to `potential` the integral of 1/r, m, and to `slope` its slope.

    slope: derivative along normals. points, normals: shape (point, 3). corners: those of panels,
    shape (panel, 4, 3), of which two may coincide. images: three signs, three shifts in m and a
    weight each, shape (image, 7): a panel's image has the potential that the panel has at the place
    sign x + shift. potential, slope: shape (point, panel).
    """
    for panel in range(len(corners)):
        edges = _edges(corners[panel])
        for image in images:
            sx, sy, sz, weight = image[0], image[1], image[2], image[6]
            for k in range(len(points)):
                x, y, z = sx * points[k, 0], sy * points[k, 1], sz * points[k, 2]
                found = _of_panel(edges, x + image[3], y + image[4], z + image[5])
                nx, ny, nz = sx * normals[k, 0], sy * normals[k, 1], sz * normals[k, 2]
                potential[k, panel] += weight * found[0]
                slope[k, panel] += weight * (nx * found[1] + ny * found[2] + nz * found[3])


@compiled()
def fill_far_influence(
    points: NDArray,
    normals: NDArray,
    areas: NDArray,
    moments: NDArray,
    images: NDArray,
    potential: NDArray,
    slope: NDArray,
) -> None:  # pragma: no cover
    """Like `fill_influence` for images some times farther than panels are wide, by multipoles.

    points: middles of the panels, shape (panel, 3). areas: m². moments: integrals of products of
    distances from the middle, m⁴, shape (panel, 3, 3).
    """
    for panel in range(len(areas)):
        a, b, c = points[panel, 0], points[panel, 1], points[panel, 2]
        own = moments[panel]
        trace = own[0, 0] + own[1, 1] + own[2, 2]
        for image in images:
            sx, sy, sz, weight = image[0], image[1], image[2], image[6]
            for k in range(len(points)):
                x = sx * points[k, 0] + image[3] - a
                y = sy * points[k, 1] + image[4] - b
                z = sz * points[k, 2] + image[5] - c
                mx = own[0, 0] * x + own[0, 1] * y + own[0, 2] * z
                my = own[1, 0] * x + own[1, 1] * y + own[1, 2] * z
                mz = own[2, 0] * x + own[2, 1] * y + own[2, 2] * z
                inverse = 1 / (x * x + y * y + z * z)
                scale = weight * sqrt(inverse)
                twice = 1.5 * inverse * inverse * (mx * x + my * y + mz * z)
                spread = 0.5 * inverse * trace
                potential[k, panel] += scale * (areas[panel] + twice - spread)
                nx, ny, nz = sx * normals[k, 0], sy * normals[k, 1], sz * normals[k, 2]
                along, turned = nx * x + ny * y + nz * z, nx * mx + ny * my + nz * mz
                towards = (areas[panel] + 5 * twice - 3 * spread) * along - 3 * inverse * turned
                slope[k, panel] -= scale * inverse * towards


@compiled()
def _edges(corners: NDArray) -> NDArray:  # pragma: no cover
    """Data of each edge, shape (4, 13).

    Start, direction, direction out of the panel, the panel's normal, and length.
    """
    edges = np.zeros((4, 13))
    normal = _normal(corners)
    for edge in range(4):
        start, stop = corners[edge], corners[(edge + 1) % 4]
        x, y, z = stop[0] - start[0], stop[1] - start[1], stop[2] - start[2]
        length = sqrt(x * x + y * y + z * z)
        if length > 0:
            x, y, z = x / length, y / length, z / length
        edges[edge, 0], edges[edge, 1], edges[edge, 2] = start[0], start[1], start[2]
        edges[edge, 3], edges[edge, 4], edges[edge, 5] = x, y, z
        edges[edge, 6] = y * normal[2] - z * normal[1]
        edges[edge, 7] = z * normal[0] - x * normal[2]
        edges[edge, 8] = x * normal[1] - y * normal[0]
        edges[edge, 9], edges[edge, 10], edges[edge, 11] = normal
        edges[edge, 12] = length
    return edges


@compiled()
def _normal(corners: NDArray) -> tuple[float, float, float]:  # pragma: no cover
    """Unit vector across both diagonals; seen along it the corners run anticlockwise."""
    a, b, c, d = corners[0], corners[1], corners[2], corners[3]
    ux, uy, uz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    vx, vy, vz = d[0] - b[0], d[1] - b[1], d[2] - b[2]
    x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    length = sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length


@compiled()
def _of_panel(
    edges: NDArray, x: float, y: float, z: float
) -> tuple[float, float, float, float]:  # pragma: no cover
    """Integral of 1/r over a panel at a point, m, and its gradient."""
    potential = gx = gy = gz = turned = 0.0
    e = edges[0]
    height = e[9] * (x - e[0]) + e[10] * (y - e[1]) + e[11] * (z - e[2])
    if abs(height) < IN_PLANE * (e[12] + edges[1, 12]):
        height = 0.0
    away = abs(height)
    for k in range(4):
        e = edges[k]
        wx, wy, wz = e[0] - x, e[1] - y, e[2] - z
        low = e[3] * wx + e[4] * wy + e[5] * wz
        high = low + e[12]
        off = e[6] * wx + e[7] * wy + e[8] * wz
        square = off * off + height * height
        if square <= (IN_PLANE * e[12]) ** 2 and low * high <= 0:
            continue  # no edge, or the point is on it: its part of the potential is 0
        to_low, to_high = sqrt(square + low * low), sqrt(square + high * high)
        if low + high > 0:
            grown = log((to_high + high) / (to_low + low))
        else:
            grown = log((to_low - low) / (to_high - high))
        angle = atan(off * high / (square + away * to_high)) if away else 0.0
        angle -= atan(off * low / (square + away * to_low)) if away else 0.0
        potential += off * grown - away * angle
        gx, gy, gz = gx - e[6] * grown, gy - e[7] * grown, gz - e[8] * grown
        turned += angle
    if height < 0:
        turned = -turned
    e = edges[0]
    return potential, gx - e[9] * turned, gy - e[10] * turned, gz - e[11] * turned
