"""Geometry of points, lines, polygons and circles in the plane, and the parts of cells covered."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Mask, Real

Points = Real


class Circle(NamedTuple):
    """A circle around (x, y); all in m."""

    x: float
    y: float
    radius: float

    @property
    def centre(self) -> Real:
        """(x, y) in m, shape (2,)."""
        return np.array([self.x, self.y])

    def at(self, angle: Real) -> Points:
        """Points at angles [rad] anticlockwise from x, shape (...) to (..., 2)."""
        return self.centre + self.radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)

    def angle(self, points: Points) -> Real:
        """Polar angles of points (..., 2) around the centre, 0 to 2 pi rad, shape (...)."""
        x, y = np.moveaxis(points - self.centre, -1, 0)
        return np.arctan2(y, x) % (2 * np.pi)

    def beyond(self, points: Points) -> Real:
        """Distances of points (..., 2) from the circle, negative inside, m, shape (...)."""
        return np.linalg.norm(points - self.centre, axis=-1) - self.radius

    def holds(self, x: Real) -> Mask:
        """True where positions x, shape (2, ...), lie within the circle, shape (...)."""
        return self.beyond(np.moveaxis(x, 0, -1)) < 0

    def passes(self, low: Points, high: Points) -> bool:
        """True if the circle runs through the rectangle between two corners (x, y)."""
        nearest = np.clip(self.centre, low, high)
        farthest = np.where(2 * self.centre > low + high, low, high)
        return bool(self.beyond(nearest) < 0 < self.beyond(farthest))

    def gap(self, other: Circle | Points) -> float:
        """Distance to another circle or to the sides of a polygon, m; 0 if they meet."""
        if isinstance(other, Circle):
            far = float(np.linalg.norm(other.centre - self.centre))
            separation = max(far - other.radius, other.radius - far) - self.radius
            return max(separation, self.radius - other.radius - far, 0.0)
        nearest = float(distance(self.centre[None], sides(other)).min()) - self.radius
        return max(nearest, float(-self.beyond(other).max()), 0.0)


def regular(x: float, y: float, radius: float, sides: int) -> Points:
    """Regular polygon with the area of a disc around (x, y), shape (sides, 2).

    It runs anticlockwise from the corner at angle 0. Its circumference exceeds that of the circle
    by (pi / sides)² / 6 of it.
    """
    angle = 2 * np.pi * np.arange(sides) / sides
    corner = radius * np.sqrt(2 * np.pi / sides / np.sin(2 * np.pi / sides))
    return np.stack([x + corner * np.cos(angle), y + corner * np.sin(angle)], axis=1)


def area(polygon: Points) -> float:
    """Area of a simple polygon, m²; negative if the polygon runs clockwise."""
    x, y = (polygon - polygon[0]).T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2)


def sides(polygon: Points) -> Points:
    """Sides of a closed polygon in order, shape (side, end, 2)."""
    return np.stack([polygon, np.roll(polygon, -1, axis=0)], axis=1)


def ring(polygon: Points) -> Points:
    """Corners of a polygon with the first one repeated at the end, shape (corner + 1, 2)."""
    return np.vstack([polygon, polygon[:1]])


def inside(polygon: Points, x: Real) -> Mask:
    """True where positions x, shape (2, ...), lie within a simple polygon, shape (...)."""
    crossed = np.zeros(np.shape(x)[1:], dtype=bool)
    for (x0, y0), (x1, y1) in sides(polygon):
        if y0 != y1:
            between = (y0 > x[1]) != (y1 > x[1])
            crossed ^= between & (x[0] < x0 + (x[1] - y0) * ((x1 - x0) / (y1 - y0)))
    return crossed


def nearest(points: Points, segments: Points) -> tuple[Points, Points]:
    """Closest point of each segment to each point: position along it, 0..1, and distance, m.

    Both have the shape (point, segment).
    """
    x, y = (points[:, axis, None] - segments[:, 0, axis] for axis in (0, 1))
    run_x, run_y = (segments[:, 1] - segments[:, 0]).T
    along = np.clip((x * run_x + y * run_y) / (run_x**2 + run_y**2), 0, 1)
    x -= along * run_x
    y -= along * run_y
    return along, np.sqrt(x**2 + y**2)


def distance(points: Points, segments: Points) -> Real:
    """Distance from each point to each segment, m, shape (point, segment)."""
    return nearest(points, segments)[1]


def crossings(first: Points, second: Points) -> Real:
    """Position along each segment of `first`, 0..1, where each segment of `second` crosses it.

    Shape (first, second); NaN if they do not cross. Parallel segments do not cross.
    """
    (run_x, run_y), (other_x, other_y) = ((each[:, 1] - each[:, 0]).T for each in (first, second))
    x, y = (second[:, 0, axis] - first[:, 0, axis, None] for axis in (0, 1))
    across = np.outer(run_x, other_y) - np.outer(run_y, other_x)
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (x * other_y - y * other_x) / across
        u = (x * run_y[:, None] - y * run_x[:, None]) / across
    meet = (across != 0) & (t >= 0) & (t <= 1) & (u >= 0) & (u <= 1)
    return np.where(meet, t, np.nan)


def gap(first: ArrayLike, second: ArrayLike) -> Real:
    """Distances between segments, m, shape (first, second); 0 where they cross."""
    a, b = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    ends_of_a = [distance(a[:, end], b) for end in (0, 1)]
    ends_of_b = [distance(b[:, end], a).T for end in (0, 1)]
    separation = np.min([*ends_of_a, *ends_of_b], axis=0)
    return np.where(np.isnan(crossings(a, b)), separation, 0.0)


def reach_into(parts: Points, low: Points, high: Points) -> bool:
    """True if any segment or convex polygon, shape (part, corner, 2), reaches into a rectangle.

    low, high: corners (x, y) of the rectangle. A part that only touches the rectangle does not
    count. A part reaches into it if no line separates the two (separating axis theorem).
    """
    (left, bottom), (right, top) = low, high
    corners = np.array([(left, bottom), (right, bottom), (right, top), (left, top)])
    run = np.roll(parts, -1, axis=1) - parts
    across = np.stack([-run[..., 1], run[..., 0]], axis=-1)
    axes = np.concatenate([across, np.broadcast_to(np.eye(2), (len(parts), 2, 2))], axis=1)
    own, other = parts @ axes.swapaxes(1, 2), corners @ axes.swapaxes(1, 2)
    separated = (own.max(axis=1) <= other.min(axis=1)) | (other.max(axis=1) <= own.min(axis=1))
    return bool((~separated.any(axis=1)).any())


def shared(spans: Real, cells: Real) -> Real:
    """Fraction of each interval of `cells` within each interval of `spans`, shape (span, cell).

    spans, cells: ascending limits of the intervals, m.
    """
    return covered(spans[:-1], spans[1:], cells)


def covered(start: ArrayLike, stop: ArrayLike, cells: Real) -> Real:
    """Fraction of each interval of `cells` from start to stop, shape (..., cell); all in m."""
    first = np.maximum(np.asarray(start)[..., None], cells[:-1])
    last = np.minimum(np.asarray(stop)[..., None], cells[1:])
    return np.maximum(last - first, 0.0) / np.diff(cells)


SAME_LINE = 1e-9
SAME_EDGE = 1e-8
"""Distance, over the skin's side, below which edges of touches count as equal: in thinner elements
rounding errors would matter."""

Lines = tuple[tuple[float, ...], tuple[float, ...]]
"""Positions of lines across x, and of lines across y, m."""

NO_LINES: Lines = ((), ())


def distinct(lines: Sequence[float], same: float = SAME_LINE) -> Real:
    """Positions in ascending order, without duplicates.

    A position no further than `same` times the largest one from its predecessor is a duplicate.
    """
    ascending = np.sort(np.asarray(lines))
    separated = np.diff(ascending) > same * ascending[-1]
    return ascending[np.append(True, separated)]
