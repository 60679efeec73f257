"""Baseline of a drifting skin, from the opening and the latest baseline sweeps.

Few baseline sweeps come shortly before a touch, and their noise is in its change. A skin drifts
along the few directions in which skins differ most: as a whole it gets stiffer, or conducts less.
Along these directions only the latest baseline sweeps count. Across them the opening sweeps, which
are more, count too, as long as the difference there is no larger than noise.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...simulator.arrays import Real

FOLLOWED = 2
"""Number of directions in which skins differ most and drift is followed: foam and sheets."""
OPENING = 0.65
"""Weight of the opening sweeps in the baseline across the directions."""
NOISE_QUANTILE = 0.99
"""Share of the training sweeps, which do not drift, whose squared length is within `noise`."""


class DriftDirections(NamedTuple):
    """Directions of drift, and the noise across them.

    directions: orthonormal, shape (feature, direction). noise: squared length of the noise across
    them.
    """

    directions: Real
    noise: float

    @classmethod
    def fitted(cls, opening: Real, recent: Real, count: int) -> DriftDirections:
        """Fit the directions to skins that do not drift.

        opening, recent: means of the opening and of the latest baseline sweeps, each of shape
        (sweep, feature). count: maximum number of directions.
        """
        differences = opening - opening.mean(axis=0)
        power, axes = np.linalg.eigh(differences.T @ differences)
        ways = np.asarray(axes[:, np.argsort(power)[::-1][:count]], np.float64)
        across = np.square(_across(recent - opening, ways)).sum(axis=1)
        return cls(ways, float(np.quantile(across, NOISE_QUANTILE)))

    def correction(self, moved: Real) -> Real:
        """Correction to add to changes from the latest baseline, shape (sweep, feature).

        moved: latest baseline less the opening one. The correction is its part across the
        directions times OPENING. It is smaller the more that part exceeds the noise, by the
        shrinkage of W. James and C. Stein (1961).
        """
        across = _across(moved, self.directions)
        size = np.square(across).sum(axis=1, keepdims=True)
        believed = np.minimum(self.noise / np.maximum(size, np.finfo(float).tiny), 1.0)
        return OPENING * believed * across


def _across(moved: Real, ways: Real) -> Real:
    return moved - moved @ ways @ ways.T
