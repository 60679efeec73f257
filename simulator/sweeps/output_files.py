"""Writes sweeps as NetCDF, Zarr or CSV by file ending, and checks output paths."""

from __future__ import annotations

import errno
import os
import shutil
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from .digests import seal_store
from .errors import InputError
from .formats.csv import write_csv, write_rows
from .formats.netcdf import write_dataset, write_table
from .input_files import ENDINGS, check_zarr
from .schema import check
from .sweep_table import SweepTable
from .writing import (
    PREFIX,
    check_all_replaceable,
    check_replaceable,
    named_failures,
    present,
    whole_file,
)

if TYPE_CHECKING:
    import xarray as xr


def write(sweeps: xr.Dataset | SweepTable, path: str | Path) -> None:
    """Writes sweeps to `path`; the file appears whole or not at all.

    Raises InputError if the ending is not in ENDINGS or the folder does not exist.
    """
    path = checked_output(path)
    with whole_file(path) as unfinished:
        if isinstance(sweeps, SweepTable) and path.suffix in TABLE_WRITERS:
            TABLE_WRITERS[path.suffix](sweeps, unfinished)
        else:
            whole = sweeps.dataset() if isinstance(sweeps, SweepTable) else sweeps
            DATASET_WRITERS[path.suffix](check(whole), unfinished)


def checked_output(path: str | Path, endings: Sequence[str] = ENDINGS) -> Path:
    """Returns the path if a file can be written there; call it before any work is done.

    Raises InputError as `checked_place`, and if a file exists that may not be replaced (see
    `writing`).
    """
    path = checked_place(path, endings)
    check_replaceable(path)
    return path


def checked_place(path: str | Path, endings: Sequence[str]) -> Path:
    """Returns the path if a file could be written there, regardless of an existing one.

    Raises InputError if the ending is not allowed, the folder does not exist or is not writable,
    the name is too long, or the path is a folder.
    """
    path = Path(path)
    if path.suffix not in endings:
        raise InputError(f"{path}: must end in {' or '.join(endings)}, got {path.suffix!r}")
    _check_parent(path)
    if path.suffix != ".zarr" and path.is_dir():
        raise InputError(f"{path}: is a folder, not a file to write to")
    if path.suffix == ".zarr":
        check_zarr(path)
    return path


def checked_folder(path: Path, *names: str) -> Path:
    """Returns the path if it is a folder, or can become one in an existing folder.

    names: name patterns of the files to be written. Raises InputError, also if an existing file of
    such a name may not be replaced.
    """
    if path.exists() and not path.is_dir():
        raise InputError(f"{path}: is a file, not a folder")
    _check_parent(path)
    check_all_replaceable(path, names)
    return path


def checked_data_folder(path: Path, marker: str) -> Path:
    """Returns the path if a folder of data that holds the file `marker` can be written there.

    Raises InputError as `checked_folder`, and if it is a folder without that file, or exists and
    may not be replaced.
    """
    checked_folder(path)
    if present(path) and not (path / marker).is_file():
        raise InputError(
            f"{path}: is a folder without {marker}, so it holds other files than such a data set; "
            "give a new name"
        )
    check_replaceable(path)
    return path


def made_folder(path: Path) -> Path:
    """Makes the folder and its parents if needed, and returns it.

    Raises InputError if it cannot be made.
    """
    with named_failures(path):
        path.mkdir(parents=True, exist_ok=True)
    return path


DERIVED_NAME_LENGTH = 32
"""Extra characters of names that are derived from an output's name, such as journals."""


def _check_parent(path: Path) -> None:
    with named_failures(path):
        if not path.parent.is_dir():
            raise InputError(f"{path}: the folder {path.parent} does not exist")
        whole = path.absolute()  # `.` alone has no name
        whole.with_name(f"{whole.name}{DERIVED_NAME_LENGTH * '_'}").exists()  # raises if too long
        if not os.access(path.parent, os.W_OK | os.X_OK):
            raise PermissionError(errno.EACCES, "", str(path))


@contextmanager
def locked(folder: Path, begun: str, busy: str) -> Iterator[Path]:
    """Makes the folder if needed and locks it for this process while the block runs.

    At the end the folder is removed if no finished file in it matches `begun`; the lock goes last,
    because Windows removes no open file. The system frees the lock of a killed process. Raises
    InputError with the message `busy` if another process holds the lock.
    """
    from filelock import FileLock, Timeout

    made_folder(folder)
    file = folder / "lock"
    lock = FileLock(file)
    try:
        lock.acquire(blocking=False)
    except Timeout:
        raise InputError(busy) from None
    except OSError as error:
        raise InputError(
            f"{file}: cannot be used as a lock: {error.strerror}; remove it"
        ) from error
    try:
        yield folder
    finally:
        done = all(each.name.startswith(PREFIX) for each in folder.glob(begun))
        if done:
            shutil.rmtree(folder, ignore_errors=True)
        left = done and file.exists()
        lock.release()
        if left:
            with suppress(OSError):  # another process has begun there
                file.unlink(missing_ok=True)
                folder.rmdir()


def _write_zarr(sweeps: xr.Dataset, path: Path) -> None:
    from zarr.codecs import Crc32cCodec, ZstdCodec

    checked = {"compressors": (ZstdCodec(), Crc32cCodec())}
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Consolidated metadata is currently not part")
        sweeps.to_zarr(
            path,
            mode="w",
            zarr_format=3,
            consolidated=True,
            encoding=dict.fromkeys(sweeps.variables, checked),
            write_empty_chunks=True,
        )
    seal_store(path)


TABLE_WRITERS = {".nc": write_table, ".csv": write_rows}
DATASET_WRITERS = {".nc": write_dataset, ".zarr": _write_zarr, ".csv": write_csv}
