"""Sweeps of files that other programs wrote: units other than SI, dimensions in another order."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .errors import InputError
from .importing.tables.columns import spelled, unit_factor
from .reading_quantities import DESCRIBED
from .sweep_table import DIMENSIONS

if TYPE_CHECKING:
    import xarray as xr

UNITS = {"frequency": "Hz", **{name: each.units for name, each in DESCRIBED.items()}}


def conventional(sweeps: xr.Dataset, path: Path) -> xr.Dataset:
    """The sweeps in SI units, with the dimensions of quantities in the order of DIMENSIONS.

    Raises InputError for a unit that is none of the quantity's in `importing.tables.columns`.
    """
    for name, unit in UNITS.items():
        if name not in sweeps.variables:
            continue
        given = spelled(str(sweeps[name].attrs.get("units", unit)))
        if given != unit:
            values = sweeps[name].values * _factor(name, given, unit, path)
            if name == "frequency":
                values = np.array([float(f"{each:.12g}") for each in values])
            attributes = {**sweeps[name].attrs, "units": unit}
            sweeps = sweeps.assign({name: (sweeps[name].dims, values, attributes)})
    ordered = {
        name: each.transpose(*DIMENSIONS)
        for name, each in sweeps.data_vars.items()
        if set(each.dims) == set(DIMENSIONS) and each.dims != DIMENSIONS
    }
    return sweeps.assign(ordered)


def _factor(name: str, given: str, unit: str, path: Path) -> float:
    """The factor from a given unit to another; raises InputError if there is none."""
    quantity = name.removesuffix("_error").replace("_", " ")
    factor = None if _may_be_milli_or_mega(given, unit) else unit_factor(quantity, given)
    if factor is None:
        raise InputError(f"{path}: `{name}` must be in {unit}, got {given[:40]!r}")
    return factor


def _may_be_milli_or_mega(given: str, unit: str) -> bool:
    """Whether a unit begins with m or M but ignores case: `mhz`, `MOHM`."""
    plain = unit.lower() if given.islower() else unit.upper() if given.isupper() else unit
    return given[:1] in ("m", "M") and plain != unit
