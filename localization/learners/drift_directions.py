"""Baseline of a drifting skin, from the opening and the latest baseline sweeps.

Few baseline sweeps come shortly before a touch, and their noise is in its change. A skin drifts
along the few directions in which skins differ most: as a whole it gets stiffer, or conducts less.
Along these directions only the latest baseline sweeps count. Across them the opening sweeps, which
are more, count too, as long as the difference there is no larger than noise.
"""

from __future__ import annotations

import numpy as np

from ...simulator.arrays import Real
from ..parts.normal_densities import BaselineCorrection

FOLLOWED = 2
"""Number of directions in which skins differ most and drift is followed: foam and sheets."""
NOISE_QUANTILE = 0.99
"""Share of the training sweeps, which do not drift, whose squared length is within `noise`."""


def fitted_correction(opening: Real, recent: Real, count: int = FOLLOWED) -> BaselineCorrection:
    """The correction of `normal_densities`, with the directions of skins that do not drift.

    opening, recent: means of the opening and of the latest baseline sweeps, each of shape
    (sweep, feature). count: maximum number of directions.
    """
    differences = opening - opening.mean(axis=0)
    power, axes = np.linalg.eigh(differences.T @ differences)
    ways = np.asarray(axes[:, np.argsort(power)[::-1][:count]], np.float64)
    across = BaselineCorrection(ways, 0.0).across(recent - opening)
    squares = np.square(across).sum(axis=1)
    return BaselineCorrection(ways, float(np.quantile(squares, NOISE_QUANTILE)))
