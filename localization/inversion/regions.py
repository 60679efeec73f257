"""Smallest 95 % regions of touches, for any localizer of positions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Real
from ..trust.fitted import Regressor
from .adapted import AdaptedPosition
from .position import ModelBasedPosition
from .region import MAX_DEVIATIONS, PlaceDistribution, Region, region_of

if TYPE_CHECKING:
    from ...simulator.scene.parts import Skin

PROBABILITY = 0.95
INVERTING_POSITIONS = ModelBasedPosition | AdaptedPosition
MIN_DEVIATION = 1e-3
"""Minimum deviation, mm."""


def places_of(learned: Regressor, X: Real, skin: Skin | None) -> list[PlaceDistribution]:
    """The posterior of each sweep's place.

    For a regressor without a posterior it is normal with its deviations. X: shape (n, feature).
    skin: its sides bound the places; None if unknown.
    """
    if isinstance(own := learned.predictor, INVERTING_POSITIONS):
        return own.places(X)
    positions, deviation = (each[:, :2] for each in learned.positions(X))
    deviation = np.maximum(deviation, MIN_DEVIATION)
    bounds = _reach(positions, deviation) if skin is None else sides_of(skin)
    positions = np.clip(positions, *bounds.T)
    pairs = zip(positions, deviation, strict=True)
    return [
        PlaceDistribution(np.ones(1), at[None], np.diag(off**2)[None], bounds) for at, off in pairs
    ]


def regions_of(learned: Regressor, X: Real, skin: Skin | None) -> list[Region]:
    """The smallest region with PROBABILITY for each sweep; arguments: see `places_of`."""
    return [region_of(each, PROBABILITY) for each in places_of(learned, X, skin)]


def sides_of(skin: Skin) -> Real:
    """Lowest and highest x and y on a skin in mm, shape (2, 2)."""
    return 1e3 * np.array([[0.0, skin.length], [0.0, skin.width]])


def _reach(places: NDArray, deviation: NDArray) -> Real:
    """Bounds of the search for places: lowest and highest x and y in mm, shape (2, 2)."""
    reach = MAX_DEVIATIONS * deviation
    return np.stack([(places - reach).min(axis=0), (places + reach).max(axis=0)], axis=1)
