"""Sweeps as Zarr: a folder of chunks, each with a checksum, and a digest of what describes them."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Iterator
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import inputs
from ..digests import check_store, seal_store
from ..errors import InputError
from ..optional_packages import require_packages
from ..reading_quantities import kind_of
from ..schema import SweepTable
from ..writing import present

if TYPE_CHECKING:
    import xarray as xr


def write_zarr(sweeps: xr.Dataset | SweepTable, path: Path) -> None:
    """Writes sweeps into a folder."""
    from zarr.codecs import Crc32cCodec, ZstdCodec

    checked = {"compressors": (ZstdCodec(), Crc32cCodec())}
    whole = sweeps.dataset() if isinstance(sweeps, SweepTable) else sweeps
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Consolidated metadata is currently not part")
        whole.to_zarr(
            path,
            mode="w",
            zarr_format=3,
            consolidated=True,
            encoding=dict.fromkeys(whole.variables, checked),
            write_empty_chunks=True,
        )
    seal_store(path)


def read_zarr(path: Path) -> xr.Dataset:
    """Reads the sweeps of a folder into memory. Raises InputError as `open_zarr` and `loaded`."""
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

    with inputs.named_damage(path, "cannot be read as .zarr"):
        inputs.check_folder(path)
        sealed = check_store(path)
        _check_codecs(path)
        inputs.check_arrays(path, _declared(path))
        stored = xr.open_zarr(path)
        _check_whole(path, [*map(str, stored.variables)] if sealed else kind_of(stored).names)
        return stored


def loaded(stored: xr.Dataset, path: Path) -> xr.Dataset:
    """Loads sweeps of `open_zarr` into memory. Raises InputError naming a damaged file."""
    inputs.check_memory(path, stored.nbytes)
    with inputs.named_damage(path, "damaged, cannot be read as .zarr", inputs.ANOTHER_COPY):
        return stored.load()


def zarr_marks(path: Path) -> tuple[set[str], dict[str, Any]]:
    """Names of the arrays in a folder, and its attributes; both empty if it is no Zarr.

    Raises any exception if it is damaged.
    """
    if not any(chain(path.rglob("zarr.json*"), path.rglob(".z*"))):
        return set(), {}
    import zarr

    check_store(path)
    group = zarr.open_group(path, mode="r")
    return {*group.keys()}, group.attrs.asdict()


def _check_whole(path: Path, names: Iterable[str]) -> None:
    """Raises InputError if chunks of these arrays are missing; Zarr would read them as zeros."""
    for name, array in _arrays(path):
        if name in names and array.nchunks_initialized < array.nchunks:
            held = f"{array.nchunks_initialized} of {array.nchunks} parts of `{name}`"
            raise InputError(f"{path}: cut off, holds {held}")


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
