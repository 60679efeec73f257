"""Segments that cross, touch or overlap, as the pieces between the points where they do."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simulator.planar import Points, crossings, nearest

Numbers = NDArray[np.int64]
NO_MARKS = np.empty((0, 2))


class Arrangement(NamedTuple):
    """Points in m, shape (point, 2); pieces by numbers of their ends, shape (piece, 2); and for
    each the first segment that it is part of, shape (piece,), by which and along which they are in
    order."""

    points: Points
    pieces: Numbers
    segment: Numbers


def arranged(segments: Points, same: float, marks: Points = NO_MARKS) -> Arrangement:
    """The arrangement of segments, shape (segment, end, 2), and of points `marks` on them.

    Points nearer to each other or to a segment than `same` [m] are one, or lie on it; those of
    earlier segments stay where they are.
    """
    if not len(segments):
        return Arrangement(marks, np.empty((0, 2), np.int64), np.empty(0, np.int64))
    start, run = segments[:, 0], segments[:, 1] - segments[:, 0]
    t = crossings(segments, segments)
    first, second = np.nonzero(~np.isnan(np.triu(t)) & ~np.eye(len(t), dtype=bool))
    upper = first < second
    first, second = first[upper], second[upper]
    met = start[first] + t[first, second, None] * run[first]
    points = _merged(np.concatenate([segments.reshape(-1, 2), marks, met]), same)
    where, off = nearest(points, segments)
    on = off <= same
    pieces, owner = [], []
    for number in range(len(segments)):
        there = np.flatnonzero(on[:, number])
        there = there[np.argsort(where[there, number], kind="stable")]
        pieces.append(np.stack([there[:-1], there[1:]], axis=1))
        owner.append(np.full(len(there) - 1, number))
    every = np.concatenate(pieces)
    first_time = np.unique(np.sort(every, axis=1), axis=0, return_index=True)[1]
    kept = np.sort(first_time)
    return Arrangement(points, every[kept], np.concatenate(owner)[kept])


def _merged(points: Points, same: float) -> Points:
    """Points without those nearer than `same` to an earlier one."""
    from scipy.spatial import KDTree

    kept = np.ones(len(points), dtype=bool)
    pairs = KDTree(points).query_pairs(same, output_type="ndarray")
    for early, late in pairs[np.lexsort(pairs.T[::-1])]:
        if kept[early]:
            kept[late] = False
    return points[kept]
