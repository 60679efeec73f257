"""Sweeps of files that other programs wrote: units other than SI, dimensions in another order."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .errors import InputError
from .optional_packages import require_packages
from .reading_quantities import DESCRIBED
from .sweep_table import DIMENSIONS

if TYPE_CHECKING:
    import xarray as xr

UNITS = {"frequency": "Hz", **{name: each.units for name, each in DESCRIBED.items()}}
OHM = re.compile(r"ohms?|Ω|Ω", re.IGNORECASE)


def conventional(sweeps: xr.Dataset, path: Path) -> xr.Dataset:
    """The sweeps in SI units, with the dimensions of quantities in the order of DIMENSIONS.

    Raises InputError for a unit that is none of the quantity, or if the library that converts
    units is not installed.
    """
    for name, unit in UNITS.items():
        if name not in sweeps.variables:
            continue
        given = OHM.sub("ohm", str(sweeps[name].attrs.get("units", unit)))
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
    require_packages(f"{path}: `{name}` in {given}", "formats", "pint")
    import pint

    try:
        return float(pint.UnitRegistry().Quantity(1.0, given).to(unit).magnitude)
    except Exception as error:
        reason = " ".join(str(error).split())[:120]
        raise InputError(f"{path}: `{name}` must be in {unit}, got {given!r}: {reason}") from error
