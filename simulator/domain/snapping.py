"""Inner points of a flat mesh moved onto lines that pass close by: cuts then leave no slivers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simulator.domain.region import Numbers, Points, areas
from simulator.domain.triangles import rim_points
from simulator.planar import nearest

REACH = 0.35
"""How far a point is moved, over the least height of the triangles around it: none turns over."""


def snapped(p: Points, t: Numbers, fixed: Numbers, corners: Points, segments: Points) -> Points:
    """Points of a mesh in the plane, shape (2, point), the nearest moved onto corners and segments.

    fixed: points that stay, beside those of the boundary. corners: shape (corner, 2). segments:
    shape (segment, end, 2); they meet at corners only.
    """
    p, reach = p.copy(), _reach(p, t)
    reach[rim_points(t)] = 0.0
    reach[fixed] = 0.0
    for number, place in _nearest(p, reach, corners):
        p[:, number], reach[number] = corners[place], 0.0
    free = np.flatnonzero(reach)
    along, away = nearest(p[:, free].T, segments)
    segment = away.argmin(axis=1)
    near = np.flatnonzero(away[np.arange(len(free)), segment] < reach[free])
    free, segment = free[near], segment[near]
    at = along[near, segment][:, None]
    segment = segments[segment]
    p[:, free] = ((1 - at) * segment[:, 0] + at * segment[:, 1]).T
    return p


def _reach(p: Points, t: Numbers) -> NDArray[np.float64]:
    """How far each point may be moved, m."""
    a, b, c = (p[:, corner] for corner in t)
    longest = np.linalg.norm([a - b, b - c, c - a], axis=1).max(axis=0)
    reach = np.full(p.shape[1], np.inf)
    np.minimum.at(reach, t.ravel(), np.tile(REACH * 2 * areas(p, t) / longest, 3))
    return reach


def _nearest(p: Points, reach: NDArray[np.float64], places: Points) -> list[tuple[int, int]]:
    """The points within reach of a place, each with the place: one each, the nearest."""
    from scipy.spatial import KDTree

    away, number = map(np.asarray, KDTree(p.T).query(places))
    found: dict[int, tuple[float, int]] = {}
    for place in np.flatnonzero(away < reach[number]).tolist():
        point = int(number[place])
        found[point] = min(found.get(point, (np.inf, 0)), (float(away[place]), place))
    return [(point, place) for point, (_, place) in found.items()]
