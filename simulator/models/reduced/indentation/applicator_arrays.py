"""Arrays of applicators in the file of a reduced model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...mechanics.depth_series import DepthSeries
from ..reduced_model import Reduced
from .applicator_tables import Tables
from .applicators import PixelApplicators
from .indentation_model import IndentationModel

OF_PIXELS = {name: f"applied_{name}" for name in ("of_pixel", "turn", "shift", "far")}
OF_TABLES = {
    "bases": "table_bases",
    "parts": "table_parts",
    "matrices": "table_matrices",
    "uncertainties": "table_doubts",
}
OF_SERIES = {
    "p": "p",
    "nodes": "nodes",
    "depth": "depth",
    "count": "count",
    "w": "w",
    "uncertainty": "unsure",
    "force": "force",
}
"""Name in the file of each attribute that is stored; those of series have a prefix, see `_name`."""


def arrays_of(model: IndentationModel) -> dict[str, NDArray]:
    """Arrays of a model's applicators and tables, by their names in the file."""
    known, own = model.applicators, model.tables
    assert known is not None and own is not None
    found = {stored: np.asarray(getattr(known, name)) for name, stored in OF_PIXELS.items()}
    found |= {stored: getattr(own, name) for name, stored in OF_TABLES.items()}
    for number, series in enumerate(known.all_series):
        found |= {
            _name(number, stored): np.asarray(getattr(series, name))
            for name, stored in OF_SERIES.items()
        }
    return found


def _name(number: int, stored: str) -> str:
    """Name in the file of an array of one depth series."""
    return f"course_{number}_{stored}"


StoredArrays = tuple[dict[str, Any], Tables, tuple[DepthSeries, ...]]


def arrays_from(archive: Mapping[str, NDArray]) -> StoredArrays | None:
    """Applicators and tables from a file; None if it has none.

    Raises KeyError if some of the arrays are missing.
    """
    if "table_bases" not in archive:
        return None
    count = int(archive["applied_of_pixel"].max()) + 1
    all_series = []
    for number in range(count):
        own: dict[str, Any] = {
            name: archive[_name(number, stored)] for name, stored in OF_SERIES.items()
        }
        own["count"] = int(own["count"])
        all_series.append(DepthSeries(**own))
    of_pixels: dict[str, Any] = {name: archive[stored] for name, stored in OF_PIXELS.items()}
    of_pixels["far"] = float(of_pixels["far"])
    of_tables = {name: archive[stored] for name, stored in OF_TABLES.items()}
    return of_pixels, Tables(**of_tables), tuple(all_series)


def with_arrays(model: Reduced, stored: StoredArrays) -> IndentationModel:
    """Model with the applicators and tables of its file."""
    of_pixels, tables, all_series = stored
    known = PixelApplicators(skin=model.parts.skin, all_series=all_series, **of_pixels)
    own = {name: getattr(model, name) for name in Reduced.__dataclass_fields__}
    return IndentationModel(**own, applicators=known, tables=tables)
