"""Polygons on the unrolled skin, compiled: hulls, their part on the skin, and discs over it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from ..press.cell_kernel import covered_fraction

ROUNDING = 1e-9
PER_SIDE, MOST_PER_SIDE = 6, 24
"""Discs along the longer side of a polygon: at least, and at most if it is narrow."""
CORNERS = 32
"""Corners of a polygon in place of a circle."""
SAMPLES = 24
"""Samples along the sides of a patch where the skin is no rectangle."""


class SkinArea(NamedTuple):
    """Region of the unrolled skin: a rectangle from (0, 0), and samples of what it has of it.

    length, width: m. mask: True where there is skin, at the middles of cells, shape (row, column);
    empty if the skin is all of the rectangle.
    """

    length: float
    width: float
    mask: NDArray[np.bool_]


@compiled()
def on_area(area: SkinArea, x: float, y: float) -> bool:
    """True if there is skin at a place, m."""
    if not (0.0 <= x <= area.length and 0.0 <= y <= area.width):
        return False
    rows, columns = area.mask.shape
    if rows == 0:
        return True
    row, column = int(y / area.width * rows), int(x / area.length * columns)
    return area.mask[min(row, rows - 1), min(column, columns - 1)]


@compiled()
def hull_of(points: NDArray) -> NDArray:
    """Corners of the convex hull of points, m, (n, 2), counter-clockwise, by wrapping."""
    count, first = len(points), 0
    for k in range(1, count):
        lower = points[k, 1] < points[first, 1]
        if lower or (points[k, 1] == points[first, 1] and points[k, 0] < points[first, 0]):
            first = k
    corners, found, at = np.empty((count, 2)), 0, first
    while found < count:
        corners[found, 0], corners[found, 1] = points[at, 0], points[at, 1]
        found += 1
        best = first if at != first else (first + 1) % count
        for k in range(count):
            ux, uy = points[best, 0] - points[at, 0], points[best, 1] - points[at, 1]
            vx, vy = points[k, 0] - points[at, 0], points[k, 1] - points[at, 1]
            turn, far = ux * vy - uy * vx, vx * vx + vy * vy
            if far > 0.0 and (turn < 0.0 or (turn == 0.0 and far > ux * ux + uy * uy)):
                best = k
        at = best
        if at == first:
            break
    return corners[:found]


@compiled()
def circle_of(x: float, y: float, radius: float) -> NDArray:
    """Corners of a polygon with the area of a disc, m, (CORNERS, 2)."""
    corners, turn = np.empty((CORNERS, 2)), 2 * np.pi / CORNERS
    out = radius * np.sqrt(turn / np.sin(turn))
    for k in range(CORNERS):
        corners[k, 0] = x + out * np.cos((k + 0.5) * turn)
        corners[k, 1] = y + out * np.sin((k + 0.5) * turn)
    return corners


@compiled()
def area_of(corners: NDArray) -> float:
    """Area of a polygon whose corners are counter-clockwise, m²."""
    twice, count = 0.0, len(corners)
    for k in range(count):
        m = (k + 1) % count
        ax, ay = corners[k, 0] - corners[0, 0], corners[k, 1] - corners[0, 1]
        bx, by = corners[m, 0] - corners[0, 0], corners[m, 1] - corners[0, 1]
        twice += ax * by - ay * bx
    return twice / 2


@compiled()
def within_rectangle(corners: NDArray, length: float, width: float) -> NDArray:
    """Part of a convex polygon within 0..length and 0..width, cut side by side.

    Source: I. E. Sutherland, G. W. Hodgman, Reentrant polygon clipping, CACM 17 (1974).
    """
    own = corners
    for side in range(4):
        axis, limit = side // 2, (length, width)[side // 2] if side % 2 else 0.0
        sign = -1.0 if side % 2 else 1.0
        cut, found, count = np.empty((len(own) + 1, 2)), 0, len(own)
        for k in range(count):
            m = (k + 1) % count
            here, there = sign * (own[k, axis] - limit), sign * (own[m, axis] - limit)
            if here >= 0.0:
                cut[found, 0], cut[found, 1] = own[k, 0], own[k, 1]
                found += 1
            if (here > 0.0 > there) or (here < 0.0 < there):
                part = here / (here - there)
                cut[found, 0] = own[k, 0] + part * (own[m, 0] - own[k, 0])
                cut[found, 1] = own[k, 1] + part * (own[m, 1] - own[k, 1])
                cut[found, axis] = limit
                found += 1
        own = cut[:found]
        if found < 3:
            return own[:0]
    return own


@compiled()
def holds(corners: NDArray, x: float, y: float) -> bool:
    """True if a place lies in a convex polygon whose corners are counter-clockwise."""
    count = len(corners)
    for k in range(count):
        m = (k + 1) % count
        ux, uy = corners[m, 0] - corners[k, 0], corners[m, 1] - corners[k, 1]
        if ux * (y - corners[k, 1]) - uy * (x - corners[k, 0]) < 0.0:
            return False
    return True


@compiled()
def skin_under(corners: NDArray, area: SkinArea) -> float:
    """Part of a convex polygon within the skin's rectangle that there is skin under."""
    if area.mask.size == 0:
        return 1.0
    grid, own, there = _grid_over(corners, SAMPLES, SAMPLES), 0, 0
    for k in range(len(grid)):
        if holds(corners, grid[k, 0], grid[k, 1]):
            own += 1
            there += on_area(area, grid[k, 0], grid[k, 1])
    return there / own if own else 0.0


@compiled()
def to_whole(part: float) -> float:
    """A part that is at most 1, and 1 but for rounding."""
    return part if part < 1 - ROUNDING else 1.0


@compiled()
def disc_on_skin(x: float, y: float, radius: float, area: SkinArea) -> float:
    """Part of a disc that lies on the skin."""
    box = x - radius, x + radius, y - radius, y + radius
    if area.mask.size == 0:
        whole = area.length * area.width
        sides = 0.0, area.length, 0.0, area.width
        return to_whole(covered_fraction(box, radius, sides) * whole / (np.pi * radius**2))
    own, there = 0, 0
    for i in range(SAMPLES):
        v = (2 * i + 1) / SAMPLES - 1
        for j in range(SAMPLES):
            u = (2 * j + 1) / SAMPLES - 1
            if u * u + v * v <= 1.0:
                own += 1
                there += on_area(area, x + radius * u, y + radius * v)
    return there / own


@compiled()
def _grid_over(corners: NDArray, along: int, across: int) -> NDArray:
    """Middles of equal rectangles around a polygon, along its longest side, m, (n, 2)."""
    origin, u, v = _frame_of(corners)
    grid = np.empty((along * across, 2))
    for i in range(across):
        for j in range(along):
            a, b = (j + 0.5) / along, (i + 0.5) / across
            grid[i * along + j, 0] = origin[0] + a * u[0] + b * v[0]
            grid[i * along + j, 1] = origin[1] + a * u[1] + b * v[1]
    return grid


@compiled()
def _frame_of(
    corners: NDArray,
) -> tuple[tuple[float, float], tuple[float, float], tuple[float, float]]:
    """Corner and two sides of a rectangle around a polygon, the first along its longest side."""
    longest, ux, uy, count = 0.0, 1.0, 0.0, len(corners)
    for k in range(count):
        m = (k + 1) % count
        x, y = corners[m, 0] - corners[k, 0], corners[m, 1] - corners[k, 1]
        side = np.sqrt(x * x + y * y)
        if side > longest * (1 + 1e-9):
            longest, ux, uy = side, x / side, y / side
    low, high, down, up = np.inf, -np.inf, np.inf, -np.inf
    for k in range(count):
        a = corners[k, 0] * ux + corners[k, 1] * uy
        b = corners[k, 1] * ux - corners[k, 0] * uy
        low, high, down, up = min(low, a), max(high, a), min(down, b), max(up, b)
    origin = low * ux - down * uy, low * uy + down * ux
    along, across = high - low, up - down
    return origin, (along * ux, along * uy), (-across * uy, across * ux)


@compiled()
def discs_over(corners: NDArray, area: SkinArea, anywhere: bool) -> NDArray:
    """Middles of discs over a convex polygon, m, (n, 2), on the skin or anywhere."""
    _, u, v = _frame_of(corners)
    one, two = np.sqrt(u[0] ** 2 + u[1] ** 2), np.sqrt(v[0] ** 2 + v[1] ** 2)
    long, short = max(one, two), min(one, two)
    most = PER_SIDE
    if short * MOST_PER_SIDE > long:
        most = max(PER_SIDE, int(np.round(long / short)))
    elif long > 0.0:
        most = MOST_PER_SIDE
    step = long / most
    along, across = max(int(np.round(one / step)), 1), max(int(np.round(two / step)), 1)
    grid, found = _grid_over(corners, along, across), 0
    for k in range(len(grid)):
        x, y = grid[k, 0], grid[k, 1]
        if holds(corners, x, y) and (anywhere or on_area(area, x, y)):
            grid[found, 0], grid[found, 1] = x, y
            found += 1
    return grid[:found] if found else _middle_on_skin(corners, area)


@compiled()
def _middle_on_skin(corners: NDArray, area: SkinArea) -> NDArray:
    """The place on the skin, in a polygon, that is nearest to the polygon's middle, m, (1, 2)."""
    middle, count = np.zeros((1, 2)), len(corners)
    for k in range(count):
        middle[0, 0] += corners[k, 0] / count
        middle[0, 1] += corners[k, 1] / count
    if on_area(area, middle[0, 0], middle[0, 1]):
        return middle
    grid, best, nearest = _grid_over(corners, SAMPLES, SAMPLES), -1, np.inf
    for k in range(len(grid)):
        if holds(corners, grid[k, 0], grid[k, 1]) and on_area(area, grid[k, 0], grid[k, 1]):
            far = (grid[k, 0] - middle[0, 0]) ** 2 + (grid[k, 1] - middle[0, 1]) ** 2
            if far < nearest:
                best, nearest = k, far
    return grid[best : best + 1].copy() if best >= 0 else middle[:0]
