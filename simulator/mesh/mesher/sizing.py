"""How long the edges of triangles shall be at any place."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...scene.planar import Points
from .spacing import spacings

GROWTH = 0.7
"""Rise of the length of edges with the distance from where they are short."""
STEPS = 2
"""Lengths of edges told apart within a factor of 2."""


class Sizing:
    """By steps: size / 2^(k / STEPS) where pieces ask for that or less, longer elsewhere."""

    def __init__(self, points: Points, pieces: NDArray[np.int64], size: float) -> None:
        """points, pieces: an arrangement; size: the longest edge, m."""
        from scipy.spatial import KDTree

        places, sizes = spacings(points, pieces)
        step = np.floor(STEPS * np.log2(size / np.minimum(sizes, size))).astype(int)
        self._size = size
        self._near = {
            size / 2 ** (k / STEPS): KDTree(places[step == k])
            for k in np.unique(step[step > 0]).tolist()
        }

    def __call__(self, places: Points) -> NDArray[np.float64]:
        """Lengths in m at places in m, shape (place, 2) to (place,)."""
        least = np.full(len(places), self._size)
        for short, near in self._near.items():
            reach = short + (self._size - short) / GROWTH
            off, _ = near.query(places, distance_upper_bound=reach)
            least = np.minimum(least, short + GROWTH * np.maximum(off - short, 0.0))
        return least
