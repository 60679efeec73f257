"""Sweeps as NetCDF 4: numbers with a checksum of each chunk, and a digest of the whole file.

HDF5 has no checksum of texts, attributes and much of its own structure, and a bit flipped there
may end the process: the digest behind its end is compared before it is opened. A file is written
from plain arrays where xarray is not imported yet, which takes longer than to simulate them; it
is what `xarray.Dataset.to_netcdf` makes of the same sweeps.
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
"""Held wherever a NetCDF file is open: the libraries below end the process where two threads read
or write at once, also different files."""
SHORTEST_TEXT = 57
"""Bytes of a text without characters and of what refers to it, in Python."""
DAMAGED = (OSError, RuntimeError, ValueError, LookupError, TypeError, AttributeError, MemoryError)
"""What libraries raise of files without a digest that are spoilt."""


def write_table(sweeps: SweepTable, path: Path) -> None:
    """Write sweeps as NetCDF 4; texts as strings, numbers to the same bits."""
    from netCDF4 import Dataset

    indices = {name for name in sweeps.coordinates if name in DIMENSIONS}
    named = " ".join(sorted(set(sweeps.coordinates) - indices))
    with LOCK, Dataset(path, "w", format="NETCDF4") as file:
        file.setncatts({name: _attribute(value) for name, value in sweeps.attrs.items()})
        for name, size in sweeps.sizes.items():
            file.createDimension(name, size)
        for name, each in sweeps.variables.items():
            variable = created(file, name, each.values.dtype, each.dims)
            told = {**each.attrs, **({"coordinates": named} if name in sweeps.quantities else {})}
            variable.setncatts(told)
            variable[:] = each.values
    seal_binary(path)


def created(file: Any, name: str, dtype: np.dtype, dims: tuple[Hashable, ...]) -> Any:
    """A new variable of an open file, with a checksum of each chunk where it holds numbers."""
    text = dtype.kind in "OUT"
    fill = np.nan if dtype.kind == "f" else None
    kind = str if text else dtype.newbyteorder("=")
    return file.createVariable(name, kind, dims, fill_value=fill, fletcher32=not text)


def write_dataset(sweeps: xr.Dataset, path: Path) -> None:
    """Write any data set as NetCDF 4, as `write_table` does."""
    encoding: Mapping[Hashable, dict[str, bool]] = {
        name: {"fletcher32": True}
        for name, variable in sweeps.variables.items()
        if variable.dtype.kind not in "OUT" and variable.ndim
    }
    with LOCK:
        sweeps.to_netcdf(path, engine="netcdf4", encoding=encoding)
    seal_binary(path)


def read_dataset(path: Path) -> xr.Dataset:
    """The data set in a file, in memory.

    Raises InputError where the file is not what its digest says, or cannot be read.
    """
    import xarray as xr

    check_binary(inputs.check_input(path, inputs.SWEEPS))
    try:
        with LOCK:
            inputs.check_memory(path, _declared(path))
            return xr.load_dataset(path, engine="netcdf4")
    except InputError:
        raise
    except DAMAGED as error:
        told = " ".join(str(error).split())
        raise InputError(f"{path}: cannot be read as .nc: {told}") from error


def _declared(path: Path) -> int:
    """Bytes of all arrays of a file in memory, texts by their shortest."""
    from netCDF4 import Dataset

    with Dataset(path) as file:
        return sum(
            math.prod(each.shape) * getattr(each.dtype, "itemsize", SHORTEST_TEXT)
            for each in file.variables.values()
        )


def _attribute(value: object) -> object:
    return np.asarray(value) if isinstance(value, int | float) else value
