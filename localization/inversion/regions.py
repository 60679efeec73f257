"""Where a touch may be, by any localizer of positions: the smallest regions that hold 95 %."""

from __future__ import annotations

import tomllib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...simulator.sweeps import inputs
from ..trust.fitted import Regressor
from .region import FARTHEST, Places, Region, region_of

PROBABILITY = 0.95
LEAST = 1e-3
"""mm: deviations are no smaller."""


def places_of(learned: Regressor, X: NDArray[np.float64], scene: str) -> list[Places]:
    """The posterior of each sweep's place; of a regressor without one, normal by its deviations.

    X: shape (n, feature). scene: TOML text of the skin, whose sides bound the places where it tells
    them.
    """
    last: Any = learned.pipeline[-1]
    if hasattr(last, "places"):
        return last.places(X)
    told, deviation = (each[:, :2] for each in learned.positions(X))
    deviation = np.maximum(deviation, LEAST)
    bounds = _bounds(scene, told, deviation)
    told = np.clip(told, *bounds.T)
    pairs = zip(told, deviation, strict=True)
    return [Places(np.ones(1), at[None], np.diag(off**2)[None], bounds) for at, off in pairs]


def regions_of(learned: Regressor, X: NDArray[np.float64], scene: str) -> list[Region]:
    """Of each sweep, the smallest region that holds PROBABILITY; arguments as of `places_of`."""
    return [region_of(each, PROBABILITY) for each in places_of(learned, X, scene)]


def _bounds(scene: str, told: NDArray, deviation: NDArray) -> NDArray[np.float64]:
    """Lowest and highest x and y in mm, shape (2, 2)."""
    try:
        skin = inputs.tables(scene)["skin"]
        return np.array([[0.0, 1e3 * skin["length"]], [0.0, 1e3 * skin["width"]]])
    except (tomllib.TOMLDecodeError, KeyError, TypeError):
        reach = FARTHEST * deviation
        return np.stack([(told - reach).min(axis=0), (told + reach).max(axis=0)], axis=1)
