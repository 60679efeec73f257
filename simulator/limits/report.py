"""Bounds as numbers: a CSV line for each position, and a summary of each variant."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Real
from ..report.files import write_rows
from .survey import Variant

UNRESOLVED = "not resolved"
HEADER = (
    "comparison",
    "variant",
    "x_mm",
    "y_mm",
    "deviation_x_mm",
    "deviation_y_mm",
    "deviation_strength",
)


def rounded(value: float, unit: float = 1.0, digits: int = 4) -> float | str:
    """A rounded number in other units, or UNRESOLVED where it is infinite."""
    return float(f"{unit * value:.{digits}g}") if math.isfinite(value) else UNRESOLVED


def write_places(variants: Sequence[Variant], path: Path) -> None:
    """Writes a CSV line for every position of every variant."""
    write_rows(
        path,
        HEADER,
        (
            [
                variant.comparison,
                variant.name,
                *(rounded(each, 1e3) for each in place),
                rounded(strength),
            ]
            for variant in variants
            for *place, strength in np.column_stack(
                [variant.bounds.places, variant.bounds.x, variant.bounds.y, variant.bounds.strength]
            )
        ),
    )


def write_distances(separation: Real, names: Sequence[str], path: Path) -> None:
    """Writes the distance between the sweeps of each pair of pixels as a CSV line."""
    pairs = itertools.combinations(range(len(names)), 2)
    rows = ([names[i], names[j], rounded(separation[i, j])] for i, j in pairs)
    write_rows(path, ["pixel", "other", "distance_errors"], rows)


def summary(variant: Variant) -> dict[str, Any]:
    """Summary of one variant; medians are over the sheet."""
    own = variant.bounds
    return {
        "comparison": variant.comparison,
        "variant": variant.name,
        "frequencies_Hz": variant.frequency.tolist(),
        "median_deviation_x_mm": rounded(float(np.median(own.x)), 1e3),
        "median_deviation_y_mm": rounded(float(np.median(own.y)), 1e3),
        "median_deviation_strength": rounded(float(np.median(own.strength))),
        "largest_deviation_x_mm": rounded(float(own.x.max()), 1e3),
        "largest_deviation_y_mm": rounded(float(own.y.max()), 1e3),
        "places_where_x_is_told": float(np.isfinite(own.x).mean()),
        "places_where_y_is_told": float(np.isfinite(own.y).mean()),
        "median_error_mm": rounded(own.median_error(), 1e3),
    }
