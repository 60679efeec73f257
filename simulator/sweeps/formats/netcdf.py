"""Sweeps as NetCDF 4: a checksum for each chunk of numbers, and a digest of the whole file.

HDF5 has no checksum of texts, attributes and much of its own structure, and a flipped bit there may
end the process. Therefore the digest behind its end is checked before the file is opened.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import inputs
from ..digests import check_binary, seal_binary

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from ..schema import SweepTable

LOCK = threading.RLock()
"""Lock for any open NetCDF file: the libraries below crash if two threads read or write at once,
even different files."""
SHORTEST_TEXT = 57
"""Bytes of an empty text and of its reference in Python."""


def _whole(variable: Any) -> Iterable[tuple[Any, NDArray[Any]]]:
    return [(..., variable.values)]


def write_netcdf(
    sweeps: xr.Dataset | SweepTable,
    path: Path,
    parts: Callable[[Any], Iterable[tuple[Any, NDArray[Any]]]] = _whole,
) -> None:
    """Writes sweeps, or any data set, as xarray reads them: texts as strings, numbers to the bit.

    parts: the places and the values of the parts of a variable, for arrays that are not in memory.
    """
    from netCDF4 import Dataset

    variables: Any = sweeps.variables
    labels = {*sweeps.coords} - {*sweeps.sizes}
    of_each = {
        name: {label for label in labels if {*variables[label].dims} <= {*each.dims}}
        for name, each in variables.items()
        if name not in sweeps.coords
    }
    of_none = labels.difference(*of_each.values())
    with LOCK, Dataset(path, "w", format="NETCDF4") as file:
        file.setncatts(_attributes(sweeps.attrs, of_none))
        for name, size in sweeps.sizes.items():
            file.createDimension(str(name), size)
        for name, each in variables.items():
            _write_variable(file, str(name), each, of_each.get(name, ()), parts)
    seal_binary(path)


def _write_variable(file: Any, name: str, variable: Any, labels: Iterable[Any], parts: Any) -> None:
    if variable.dtype.kind in "bmM":  # NetCDF has no truth values and no dates
        from xarray.conventions import encode_cf_variable

        variable = encode_cf_variable(variable)
    text = variable.dtype.kind in "OUST"
    target = file.createVariable(
        name,
        str if text else variable.dtype.newbyteorder("="),
        variable.dims,
        fill_value=np.nan if variable.dtype.kind == "f" else None,
        fletcher32=not text and bool(variable.dims),
    )
    target.setncatts(_attributes(variable.attrs, labels))
    for place, values in parts(variable):
        target[place] = values.astype(object) if text else values


def _attributes(attributes: Any, labels: Iterable[Any]) -> dict[str, Any]:
    """Attributes with the names of coordinates that are no dimensions."""
    named = {"coordinates": " ".join(sorted(map(str, labels)))} if labels else {}
    return {str(name): value for name, value in attributes.items()} | named


def read_netcdf(path: Path) -> xr.Dataset:
    """Reads the data set of a file into memory.

    Raises InputError if the file does not match its digest or cannot be read.
    """
    check_binary(inputs.check_input(path, inputs.SWEEPS))
    import xarray as xr

    with inputs.named_damage(path, "cannot be read as .nc"), LOCK:
        inputs.check_memory(path, _declared(path))
        return xr.load_dataset(path, engine="netcdf4")


def _declared(path: Path) -> int:
    """Bytes that all arrays of a file take in memory; texts count as empty."""
    from netCDF4 import Dataset

    with Dataset(path) as file:
        return sum(
            math.prod(each.shape) * getattr(each.dtype, "itemsize", SHORTEST_TEXT)
            for each in file.variables.values()
        )


def netcdf_marks(path: Path) -> tuple[set[str], dict[str, Any]]:
    """Names of the variables in a file, and its attributes; both empty if it is no NetCDF.

    Raises any exception if it is damaged.
    """
    from netCDF4 import Dataset

    check_binary(path)
    if _is_text(path):
        return set(), {}
    with LOCK, Dataset(path) as file:
        return {*file.variables}, {name: file.getncattr(name) for name in file.ncattrs()}


def _is_text(path: Path) -> bool:
    """True if a file begins with text, as no NetCDF file does, or is empty."""
    with path.open("rb") as file:
        beginning = file.read(2**16)
    try:
        return "\0" not in beginning.decode()
    except UnicodeDecodeError:
        return False
