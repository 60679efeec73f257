"""Adds points between lines until triangles are as small as requested.

Every triangle that is too large requests a point where that makes an equilateral triangle with its
shortest edge, or at its circumcentre if that is nearer (S. Rebay, Journal of Computational Physics
106 (1993) 125-138). Points are added in rounds, first those of the triangles that are largest for
their place, and only where there is room: so the rounds end, and lines are never divided again.
"""

from __future__ import annotations

import numpy as np

from ...arrays import Integer, Mask, Real
from ...scene.planar import Points
from .sizing import Sizing
from .triangulation import triangulated

WIDEST = 1.05 / np.sqrt(3)
"""Largest circumradius of a triangle over the requested length.

It is 1 / sqrt(3) for an equilateral triangle.
"""
POINT_CLEARANCE = 0.57
"""Smallest distance of a new point from all others over the requested length."""
LINE_CLEARANCE = 0.35
"""Smallest distance of a new point from the middle of a line over its length."""
NEAREST = 3
"""Number of lines that are checked; a drawing has at least as many."""


def filled(
    points: Points, lines: Integer, curve: Integer, sizing: Sizing
) -> tuple[Points, Integer]:
    """Points, the given ones first, shape (point, 2), and their triangles.

    points, lines, curve and the triangles are as for `triangulated`. Some of the new points may be
    part of no triangle.
    """
    while True:
        t = triangulated(points, lines, curve)
        new, urgency = _new_points(points, t, sizing)
        free = _within_box(new, points) & _clear_of_lines(new, points, lines)
        new, urgency = new[free], urgency[free]
        reach = POINT_CLEARANCE * sizing(new)
        free = _clear_of_points(new, points, reach)
        new = _chosen(new[free], reach[free], urgency[free])
        if not len(new):
            return points, t
        points = np.concatenate([points, new])


def _new_points(points: Points, t: Integer, sizing: Sizing) -> tuple[Points, Real]:
    """New place for each triangle that is too large, and its urgency."""
    centre, radius = _circles(points, t)
    urgency = radius / sizing(points[t].mean(axis=0))
    large = (urgency > WIDEST) & np.isfinite(centre).all(axis=1)
    return _fronts(points, t[:, large], centre[large], sizing), urgency[large]


def _circles(points: Points, t: Integer) -> tuple[Points, Real]:
    """Circumcentres, shape (triangle, 2), and circumradii of triangles, m."""
    origin, first, second = points[t]
    u, v = first - origin, second - origin
    across = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    turned = (u**2).sum(axis=1)[:, None] * v - (v**2).sum(axis=1)[:, None] * u
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        to_centre = np.stack([turned[:, 1], -turned[:, 0]], axis=1) / (2 * across)[:, None]
        return origin + to_centre, np.linalg.norm(to_centre, axis=1)


def _fronts(points: Points, t: Integer, centre: Points, sizing: Sizing) -> Points:
    """Apexes over the shortest edges of triangles, or circumcentres where nearer."""
    corners = points[t]
    sides = np.roll(corners, -1, axis=0) - corners
    length = np.linalg.norm(sides, axis=2)
    shortest, every = length.argmin(axis=0), np.arange(t.shape[1])
    side, length = sides[shortest, every], length[shortest, every]
    middle = corners[shortest, every] + side / 2
    inward = np.stack([-side[:, 1], side[:, 0]], axis=1) / length[:, None]
    radius = np.maximum(sizing(middle) / np.sqrt(3), length / 2)
    height = radius + np.sqrt(np.maximum(radius**2 - length**2 / 4, 0.0))
    beyond = ((centre - middle) * inward).sum(axis=1) > height
    return np.where(beyond[:, None], middle + height[:, None] * inward, centre)


def _within_box(new: Points, points: Points) -> Mask:
    return ((new > points.min(axis=0)) & (new < points.max(axis=0))).all(axis=1)


def _clear_of_lines(new: Points, points: Points, lines: Integer) -> Mask:
    """True for places that keep off the middles of lines."""
    from scipy.spatial import KDTree

    start, stop = points[lines]
    length = np.linalg.norm(stop - start, axis=1)
    off, line = KDTree((start + stop) / 2).query(new, k=NEAREST)
    return (off >= LINE_CLEARANCE * length[line]).all(axis=1)


def _clear_of_points(new: Points, points: Points, reach: Real) -> Mask:
    """True for places that are at least `reach` away from all points."""
    from scipy.spatial import KDTree

    return KDTree(points).query(new)[0] >= reach


def _chosen(new: Points, reach: Real, urgency: Real) -> Points:
    """The most urgent places among those within reach of each other."""
    from scipy.spatial import KDTree

    if not len(new):
        return new
    order = np.lexsort((new[:, 1], new[:, 0], -urgency))
    new = new[order]
    left, chosen = np.ones(len(new), dtype=bool), []
    for number, around in enumerate(KDTree(new).query_ball_point(new, reach[order])):
        if left[number]:
            chosen.append(number)
            left[around] = False
    return new[chosen]
