"""Sweeps as NetCDF 4: a checksum for each chunk of numbers, and a digest of the whole file.

HDF5 has no checksum of texts, attributes and much of its own structure, and a flipped bit there may
end the process. Therefore the digest behind its end is checked before the file is opened. A file
can be written from plain arrays, because importing xarray takes longer than simulating the sweeps;
the result equals that of `xarray.Dataset.to_netcdf`.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Hashable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import inputs
from ..digests import check_binary, seal_binary
from ..errors import InputError
from ..sweep_table import DIMENSIONS, SweepTable

if TYPE_CHECKING:
    import xarray as xr

LOCK = threading.RLock()
"""Lock for any open NetCDF file: the libraries below crash if two threads read or write at once,
even different files."""
SHORTEST_TEXT = 57
"""Bytes of an empty text and of its reference in Python."""
DAMAGED = (OSError, RuntimeError, ValueError, LookupError, TypeError, AttributeError, MemoryError)
"""Exceptions that libraries raise for corrupt files without a digest."""


def write_table(sweeps: SweepTable, path: Path) -> None:
    """Writes sweeps as NetCDF 4; texts as strings, numbers to the last bit."""
    from netCDF4 import Dataset

    indices = {name for name in sweeps.coordinates if name in DIMENSIONS}
    named = " ".join(sorted(set(sweeps.coordinates) - indices))
    with LOCK, Dataset(path, "w", format="NETCDF4") as file:
        file.setncatts({name: _attribute(value) for name, value in sweeps.attrs.items()})
        for name, size in sweeps.sizes.items():
            file.createDimension(name, size)
        for name, each in sweeps.variables.items():
            variable = create_variable(file, name, each.values.dtype, each.dims)
            attributes = {
                **each.attrs,
                **({"coordinates": named} if name in sweeps.quantities else {}),
            }
            variable.setncatts(attributes)
            variable[:] = each.values
    seal_binary(path)


def create_variable(file: Any, name: str, dtype: np.dtype, dims: tuple[Hashable, ...]) -> Any:
    """Creates a variable in an open file; numbers get a checksum of each chunk."""
    text = dtype.kind in "OUT"
    fill = np.nan if dtype.kind == "f" else None
    kind = str if text else dtype.newbyteorder("=")
    return file.createVariable(name, kind, dims, fill_value=fill, fletcher32=not text)


def write_dataset(sweeps: xr.Dataset, path: Path) -> None:
    """Writes any `xarray.Dataset` as NetCDF 4, in the same way as `write_table`."""
    encoding: Mapping[Hashable, dict[str, bool]] = {
        name: {"fletcher32": True}
        for name, variable in sweeps.variables.items()
        if variable.dtype.kind not in "OUT" and variable.ndim
    }
    with LOCK:
        sweeps.to_netcdf(path, engine="netcdf4", encoding=encoding)
    seal_binary(path)


def read_dataset(path: Path) -> xr.Dataset:
    """Reads the data set of a file into memory.

    Raises InputError if the file does not match its digest or cannot be read.
    """
    check_binary(inputs.check_input(path, inputs.SWEEPS))
    import xarray as xr

    try:
        with LOCK:
            inputs.check_memory(path, _declared(path))
            return xr.load_dataset(path, engine="netcdf4")
    except InputError:
        raise
    except DAMAGED as error:
        reason = " ".join(str(error).split())
        raise InputError(f"{path}: cannot be read as .nc: {reason}") from error


def _declared(path: Path) -> int:
    """Bytes that all arrays of a file take in memory; texts count as empty."""
    from netCDF4 import Dataset

    with Dataset(path) as file:
        return sum(
            math.prod(each.shape) * getattr(each.dtype, "itemsize", SHORTEST_TEXT)
            for each in file.variables.values()
        )


def _attribute(value: object) -> object:
    return np.asarray(value) if isinstance(value, int | float) else value
