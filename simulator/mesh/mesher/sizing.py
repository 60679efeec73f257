"""Requested length of the edges of triangles at any place."""

from __future__ import annotations

import numpy as np

from ...arrays import Integer, Real
from ...scene.planar import Points
from .spacing import spacings

GROWTH = 0.7
"""Increase of the edge length with the distance from where edges are short."""
STEPS = 2
"""Number of steps in which the edge length changes by a factor of 2."""


class Sizing:
    """Edge length in steps.

    It is size / 2^(k / STEPS) where pieces need that or less, and longer elsewhere.
    """

    def __init__(self, points: Points, pieces: Integer, size: float) -> None:
        """Collects the places of each step.

        points, pieces: an arrangement; size: the longest edge, m.
        """
        from scipy.spatial import KDTree

        places, sizes = spacings(points, pieces)
        step = np.floor(STEPS * np.log2(size / np.minimum(sizes, size))).astype(int)
        self._size = size
        self._near = {
            size / 2 ** (k / STEPS): KDTree(places[step == k])
            for k in np.unique(step[step > 0]).tolist()
        }

    def __call__(self, places: Points) -> Real:
        """Lengths in m at places in m, shape (place, 2) to (place,)."""
        least = np.full(len(places), self._size)
        for short, near in self._near.items():
            reach = short + (self._size - short) / GROWTH
            off, _ = near.query(places, distance_upper_bound=reach)
            least = np.minimum(least, short + GROWTH * np.maximum(off - short, 0.0))
        return least
