"""How far a skin at rest has moved since its opening, told by all of its sweeps at rest.

Few sweeps at rest come shortly before a touch, and their noise is in its change. A skin that drifts
moves along the few ways in which skins differ most: as a whole it gets stiffer, or conducts less.
So along these the latest sweeps at rest count, and across them those of the opening beside, which
are more, as long as the skin has moved no farther there than noise would let it seem.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

FOLLOWED = 2
"""Ways in which skins differ most, along which drift is followed: of foam, and of sheets."""
OPENING = 0.65
"""Part that the opening has in what is known of the skin across them."""
SHARE = 0.99
"""Of the sweeps of the training, which do not drift, that have moved no farther."""

Array = NDArray[np.float64]


class DriftDirections(NamedTuple):
    """ways: orthonormal, shape (feature, way). noise: squared length across them."""

    ways: Array
    noise: float

    @classmethod
    def learned(cls, opening: Array, recent: Array, count: int) -> DriftDirections:
        """From sweeps at rest of skins that do not drift: means of the opening and the latest.

        Shape (sweep, feature) each. count: of ways, at most.
        """
        apart = opening - opening.mean(axis=0)
        power, axes = np.linalg.eigh(apart.T @ apart)
        ways = np.asarray(axes[:, np.argsort(power)[::-1][:count]], np.float64)
        across = np.square(_across(recent - opening, ways)).sum(axis=1)
        return cls(ways, float(np.quantile(across, SHARE)))

    def settled(self, moved: Array) -> Array:
        """What is to be added to changes from the latest sweeps at rest, shape (sweep, feature).

        moved: the latest at rest less those of the opening. Across the ways OPENING of it counts;
        the less, the farther it is beyond noise, as W. James and C. Stein (1961) shrink.
        """
        across = _across(moved, self.ways)
        size = np.square(across).sum(axis=1, keepdims=True)
        believed = np.minimum(self.noise / np.maximum(size, np.finfo(float).tiny), 1.0)
        return OPENING * believed * across


def _across(moved: Array, ways: Array) -> Array:
    return moved - moved @ ways @ ways.T
