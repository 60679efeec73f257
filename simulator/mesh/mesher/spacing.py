"""Edge lengths that resolve points and pieces that lie close together."""

from __future__ import annotations

import numpy as np

from ...arrays import Integer, Real
from ...scene.planar import Points, distance

ASPECT = 2.0
"""Edge length over the width of the strip between two pieces."""
DEEPEST = 40
"""Largest number of times that a piece is halved."""


def spacings(points: Points, pieces: Integer) -> tuple[Points, Real]:
    """Places in m, shape (place, 2), and the requested edge length there, m.

    points, pieces: an arrangement. At an end of pieces the length is that of the shortest piece
    there; along a piece it is ASPECT times the distance to the nearest piece that it does not meet,
    at most the length of the piece.
    """
    ends = points[pieces]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    shortest = np.full(len(points), np.inf)
    np.minimum.at(shortest, pieces.ravel(), np.repeat(length, 2))
    used = np.isfinite(shortest)
    places, sizes = [points[used]], [shortest[used]]
    whole, part = np.arange(len(pieces)), ends
    for _ in range(DEEPEST):
        middle = part.mean(axis=1)
        distances = _to_others(middle, whole, ends, pieces)
        places.append(middle)
        sizes.append(np.minimum(ASPECT * distances, length[whole]))
        coarse = np.linalg.norm(part[:, 1] - part[:, 0], axis=1) > 2 * ASPECT * distances
        if not coarse.any():
            break
        halves = [(part[coarse, 0], middle[coarse]), (middle[coarse], part[coarse, 1])]
        part = np.concatenate([np.stack(half, axis=1) for half in halves])
        whole = np.tile(whole[coarse], 2)
    return np.concatenate(places), np.concatenate(sizes)


def _to_others(middle: Points, whole: Integer, ends: Points, pieces: Integer) -> Real:
    """Distance from places on pieces to the nearest piece that theirs does not meet."""
    found = distance(middle, ends)
    for end in pieces[whole].T:
        for other in pieces.T:
            found[end[:, None] == other] = np.inf
    return found.min(axis=1)
