"""Reads sweeps from NetCDF, Zarr and CSV by file ending."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import inputs
from .digests import check_store
from .errors import InputError
from .file_kinds import FOREIGN, check_file_kind
from .formats.csv import read_csv
from .formats.netcdf import DAMAGED, read_dataset
from .optional_packages import require_packages
from .reading_quantities import kind_of
from .schema import check
from .stored_units import conventional
from .sweep_table import DIMENSIONS
from .writing import present

if TYPE_CHECKING:
    import xarray as xr

ENDINGS = (".nc", ".csv", ".zarr")


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
    readers = {".nc": read_dataset, ".zarr": _read_zarr, ".csv": read_csv}
    if path.suffix not in readers:
        check_file_kind(path, "sweeps")
        given = f"got {path.suffix!r}" if path.suffix else "got no ending"
        raise InputError(f"{path}: sweeps are read from {', '.join(ENDINGS)}, {given}; {FOREIGN}")
    try:
        return check(conventional(readers[path.suffix](path), path))
    except OSError as error:
        raise InputError(f"{path}: cannot be read as {path.suffix}: {error}") from error
    except InputError as error:
        named = str(error) if str(error).startswith(str(path)) else f"{path}: {error}"
        raise InputError(named) from error


def _read_zarr(path: Path) -> xr.Dataset:
    sweeps = loaded(open_zarr(path), path)
    texts = [name for name, variable in sweeps.variables.items() if variable.dtype.kind == "T"]
    return sweeps.assign_coords({name: sweeps[name].astype(object) for name in texts})


def open_zarr(path: Path) -> xr.Dataset:
    """Opens the sweeps of a `.zarr` without checking the schema; arrays are read lazily in chunks.

    Raises InputError if it cannot be read or the required extra is not installed.
    """
    if not present(path):
        raise InputError(f"{path}: no such file")
    if not path.is_dir():
        raise InputError(f"{path}: is a file; a .zarr is a folder")
    check_zarr(path)
    import xarray as xr

    try:
        inputs.check_folder(path)
        sealed = check_store(path)
        _check_codecs(path)
        inputs.check_arrays(path, _declared(path))
        stored = xr.open_zarr(path)
        _check_whole(path, [*map(str, stored.variables)] if sealed else kind_of(stored).names)
    except InputError:
        raise
    except DAMAGED as error:
        raise InputError(f"{path}: cannot be read as .zarr: {error}") from error
    return stored


def loaded(stored: xr.Dataset, path: Path) -> xr.Dataset:
    """Loads sweeps of `open_zarr` into memory. Raises InputError naming a damaged file."""
    inputs.check_memory(path, stored.nbytes)
    try:
        return stored.load()
    except DAMAGED as error:
        reason = " ".join(str(error).split())
        raise InputError(
            f"{path}: damaged, cannot be read as .zarr: {reason}; use another copy"
        ) from error


def _check_whole(path: Path, names: Iterable[str]) -> None:
    """Raises InputError if chunks of these arrays are missing; Zarr would read them as zeros."""
    for name, array in _arrays(path):
        if name in names and array.nchunks_initialized < array.nchunks:
            present = f"{array.nchunks_initialized} of {array.nchunks} parts of `{name}`"
            raise InputError(f"{path}: cut off, holds {present}")


def _check_codecs(path: Path) -> None:
    """Raises InputError if an array is a pickle, which some versions of numcodecs would run."""
    for name, array in _arrays(path):
        codecs = (*array.filters, *array.compressors)
        if any(getattr(codec, "codec_id", None) == "pickle" for codec in codecs):
            raise InputError(f"{path}: `{name}` is a pickle, which may run anything; not read")


def _declared(path: Path) -> Iterator[tuple[str, int, int, int]]:
    """Name, number of dimensions, bytes of a chunk and number of chunks of each array."""
    for name, each in _arrays(path):
        yield name, each.ndim, math.prod(each.chunks) * each.dtype.itemsize, each.nchunks


def _arrays(path: Path) -> list[tuple[str, Any]]:
    """The arrays of a `.zarr` sorted by name, not read yet."""
    import zarr

    return sorted(zarr.open_group(path, mode="r").arrays())


def check_zarr(path: Path) -> None:
    """Raises InputError if the extra that reads and writes `.zarr` is not installed."""
    require_packages(path, "scale", "zarr", "dask")
