"""Arrays of applicators in the file of a reduced model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...mechanics.depth_series import DepthSeries
from ..reduced_model import Reduced
from .applicator_tables import Tables
from .applicators import Applicators
from .indentation_model import Indented

OF_PIXELS = ("of_pixel", "turn", "shift", "far")
OF_TABLES = tuple(each.name for each in fields(Tables))
OF_COURSE = tuple(each.name for each in fields(DepthSeries))


def arrays_of(model: Indented) -> dict[str, NDArray]:
    """Arrays of a model's applicators and tables, by their names in the file."""
    known, own = model.applicators, model.tables
    assert known is not None and own is not None
    found = {f"applied_{name}": np.asarray(getattr(known, name)) for name in OF_PIXELS}
    found |= {f"table_{name}": getattr(own, name) for name in OF_TABLES}
    for number, course in enumerate(known.courses):
        found |= {
            f"course_{number}_{name}": np.asarray(getattr(course, name)) for name in OF_COURSE
        }
    return found


Beside = tuple[dict[str, Any], Tables, tuple[DepthSeries, ...]]


def beside_from(archive: Mapping[str, NDArray]) -> Beside | None:
    """Applicators and tables from a file; None if it has none.

    Raises KeyError if some of the arrays are missing.
    """
    if "table_bases" not in archive:
        return None
    count = int(archive["applied_of_pixel"].max()) + 1
    courses = []
    for number in range(count):
        own: dict[str, Any] = {name: archive[f"course_{number}_{name}"] for name in OF_COURSE}
        own["count"] = int(own["count"])
        courses.append(DepthSeries(**own))
    of_pixels: dict[str, Any] = {name: archive[f"applied_{name}"] for name in OF_PIXELS}
    of_pixels["far"] = float(of_pixels["far"])
    return of_pixels, Tables(**{k: archive[f"table_{k}"] for k in OF_TABLES}), tuple(courses)


def with_beside(model: Reduced, beside: Beside) -> Indented:
    """Model with the applicators and tables of its file."""
    of_pixels, tables, courses = beside
    known = Applicators(scene=model.scene, courses=courses, **of_pixels)
    own = {name: getattr(model, name) for name in Reduced.__dataclass_fields__}
    return Indented(**own, applicators=known, tables=tables)
