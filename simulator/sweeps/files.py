"""Reading and writing sweeps: NetCDF and CSV, chosen by the file's ending."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from simulator.sweeps.csv import read_csv, write_csv
from simulator.sweeps.errors import InputError
from simulator.sweeps.schema import check

if TYPE_CHECKING:
    import xarray as xr

ENDINGS = (".nc", ".csv")


def write(sweeps: xr.Dataset, path: str | Path) -> None:
    """Write sweeps to `path`; the file appears whole or not at all.

    Raises InputError where the ending is not one of ENDINGS or the folder does not exist.
    """
    writers = {".nc": _write_netcdf, ".csv": write_csv}
    path = checked_output(path)
    with whole_file(path) as unfinished:
        writers[path.suffix](check(sweeps), unfinished)


def read(path: str | Path) -> xr.Dataset:
    """Sweeps from a file written by `write`, or from any CSV with named columns (see `read_csv`).

    Raises InputError naming the file where it is absent, of another kind, or breaks the schema.
    """
    path = Path(path)
    readers = {".nc": _read_netcdf, ".csv": read_csv}
    if path.suffix not in readers:
        raise InputError(f"{path}: sweeps are read from {', '.join(ENDINGS)}, got {path.suffix!r}")
    if not path.exists():
        raise InputError(f"{path}: no such file")
    try:
        return check(readers[path.suffix](path))
    except OSError as error:
        raise InputError(f"{path}: cannot be read as {path.suffix}: {error}") from error
    except InputError as error:
        named = str(error) if str(error).startswith(str(path)) else f"{path}: {error}"
        raise InputError(named) from error


def checked_output(path: str | Path, endings: Sequence[str] = ENDINGS) -> Path:
    """The same path, if such a file can be written there: to be asked before any work is done.

    Raises InputError where the ending is another or the folder does not exist.
    """
    path = Path(path)
    if path.suffix not in endings:
        raise InputError(f"{path}: must end in {' or '.join(endings)}, got {path.suffix!r}")
    if not path.parent.is_dir():
        raise InputError(f"{path}: the folder {path.parent} does not exist")
    return path


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A temporary name beside `path`, renamed to `path` when the block ends without an error."""
    unfinished = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    try:
        yield unfinished
        os.replace(unfinished, path)
    finally:
        unfinished.unlink(missing_ok=True)


def _write_netcdf(sweeps: xr.Dataset, path: Path) -> None:
    sweeps.to_netcdf(path, engine="netcdf4")


def _read_netcdf(path: Path) -> xr.Dataset:
    import xarray as xr

    return xr.load_dataset(path, engine="netcdf4")
