"""Triangles of a skin that contain given points, and places within them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import Integer, Mask, Real
from ..mesh.arcs import mapped
from ..mesh.domain import Domain

EDGE_TOLERANCE = 1e-6
"""Distance beyond a triangle, over its size, up to which a point is still in it."""
NEWTON_STEPS = 5
"""Steps from the straight triangle to the one with arcs for edges."""


class LocatedPoints(NamedTuple):
    """Triangles of points, and places (a, b) in the unit triangle.

    Points off the skin are moved onto it, and on_skin is False for them. triangle, on_skin: shape
    (point,). places: shape (2, point).
    """

    triangle: Integer
    places: Real
    on_skin: Mask


def locate_points(domain: Domain, points: Real) -> LocatedPoints:
    """Places on the mesh of points as seen along z, m, shape (2, point)."""
    each = [_nearest(domain, x) for x in points.T]
    triangle = np.array([number for number, _ in each])
    bends = domain.curvature
    places = np.stack([place for _, place in each], axis=1)
    for k in np.flatnonzero(bends[:, triangle].any(axis=0)):
        here = domain.p[:2], domain.t[:, triangle[[k]]], bends[:, triangle[[k]]]
        places[:, k] = _newton_place(*here, places[:, k], points[:, k])
    corners = np.vstack([places, 1 - places.sum(axis=0)])
    inside = np.maximum(corners, 0.0)
    return LocatedPoints(
        triangle, (inside / inside.sum(axis=0))[:2], corners.min(axis=0) >= -EDGE_TOLERANCE
    )


def _nearest(domain: Domain, x: Real) -> tuple[int, Real]:
    """Triangle that contains x or is nearest, and (a, b) in it, by its corners alone."""
    origin, along, across = domain.p[:2, domain.t].transpose(1, 0, 2)
    along, across, off = along - origin, across - origin, x[:, None] - origin
    area = along[0] * across[1] - along[1] * across[0]
    a = (off[0] * across[1] - off[1] * across[0]) / area
    b = (along[0] * off[1] - along[1] * off[0]) / area
    beyond = -np.minimum(np.minimum(a, b), 1 - a - b) * domain.lengths
    nearest = int(np.argmin(beyond))
    return nearest, np.array([a[nearest], b[nearest]])


def _newton_place(p: Real, t: Integer, bends: Real, place: Real, x: Real) -> Real:
    """Newton's method for (a, b) at x in a triangle with arcs.

    p, t, bends: as for `mapped`.
    """
    for _ in range(NEWTON_STEPS):
        at, along, across = (each[:, 0, 0] for each in mapped(p, t, bends, place[:, None]))
        place = place + np.linalg.solve(np.stack([along, across], axis=1), x - at)
    return place
