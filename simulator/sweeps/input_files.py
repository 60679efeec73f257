"""Reads sweeps by file ending; units and the order of dimensions may be those of other programs."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import InputError
from .formats import ENDINGS, FORMATS
from .importing.columns import spelled, unit_factor
from .inputs import FOREIGN, check_file_kind
from .reading_quantities import DESCRIBED
from .schema import DIMENSIONS, check

if TYPE_CHECKING:
    import xarray as xr

UNITS = {"frequency": "Hz", **{name: each.units for name, each in DESCRIBED.items()}}


def sizes_text(sizes: Mapping[Any, int]) -> str:
    """Sizes of a data set in words: `13 sweeps x 20 frequencies`, with interfaces if several."""
    named = {"sweep": "sweeps", "interface": "interfaces", "frequency": "frequencies"}
    parts = [
        f"{sizes[name]} {name if sizes[name] == 1 else named[name]}"
        for name in DIMENSIONS
        if name != "interface" or sizes[name] > 1
    ]
    return " x ".join(parts)


def read(path: str | Path) -> xr.Dataset:
    """Reads sweeps from a file written by `write`, or from a CSV with named columns (`read_csv`).

    Raises InputError naming the file if it is absent, of another kind, or violates the schema.
    """
    path = Path(path)
    if path.suffix not in FORMATS:
        check_file_kind(path, "sweeps")
        given = f"got {path.suffix!r}" if path.suffix else "got no ending"
        raise InputError(f"{path}: sweeps are read from {', '.join(ENDINGS)}, {given}; {FOREIGN}")
    try:
        return check(_conventional(FORMATS[path.suffix].read(path), path))
    except OSError as error:
        raise InputError(f"{path}: cannot be read as {path.suffix}: {error}") from error
    except InputError as error:
        named = str(error) if str(error).startswith(str(path)) else f"{path}: {error}"
        raise InputError(named) from error


def _conventional(sweeps: xr.Dataset, path: Path) -> xr.Dataset:
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
