"""Sweeps as Zarr: a folder of chunks, each with a checksum, and a digest of what describes them."""

from __future__ import annotations

import math
import warnings
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

MAX_CHUNK_BYTES = inputs.GIB
"""Largest chunk of an array; chunks are decoded whole."""
MAX_CHUNKS = 10**6


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
    return loaded(open_zarr(path), path)


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
        _check_arrays(path, sealed=check_store(path))
        return xr.open_zarr(path)


def loaded(stored: xr.Dataset, path: Path) -> xr.Dataset:
    """Loads sweeps of `open_zarr` into memory. Raises InputError naming a damaged file."""
    inputs.check_memory(path, stored.nbytes)
    with inputs.named_damage(path, "damaged, cannot be read as .zarr", inputs.ANOTHER_COPY):
        whole = stored.load()
    texts = [name for name, variable in whole.variables.items() if variable.dtype.kind == "T"]
    return whole.assign_coords({name: whole[name].astype(object) for name in texts})


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


def _check_arrays(path: Path, *, sealed: bool) -> None:
    """Raises InputError if an array cannot be read safely or is not whole.

    Some versions of numcodecs run what is in a pickle. Zarr reads missing chunks as zeros; in a
    folder that other programs wrote, those of readings must be there.
    """
    import zarr

    arrays = sorted(zarr.open_group(path, mode="r").arrays())
    needed = kind_of([name for name, _ in arrays]).names
    for name, array in arrays:
        codecs = (*array.filters, *array.compressors)
        if any(getattr(codec, "codec_id", None) == "pickle" for codec in codecs):
            raise InputError(f"{path}: `{name}` is a pickle, which may run anything; not read")
        size, count = math.prod(array.chunks) * array.dtype.itemsize, array.nchunks
        if size > MAX_CHUNK_BYTES or count > MAX_CHUNKS:
            raise InputError(
                f"{path}: `{name}` declares {count} parts of {size} bytes; at most {MAX_CHUNKS} "
                f"of {MAX_CHUNK_BYTES} are read"
            )
        if array.ndim == 1:  # read whole when it is opened
            inputs.check_memory(path, size * count)
        if (sealed or name in needed) and array.nchunks_initialized < count:
            held = f"{array.nchunks_initialized} of {count} parts of `{name}`"
            raise InputError(f"{path}: cut off, holds {held}")


def check_zarr(path: Path) -> None:
    """Raises InputError if the extra that reads and writes `.zarr` is not installed."""
    require_packages(path, "scale", "zarr", "dask")
