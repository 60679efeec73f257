"""Writing sweeps: NetCDF, Zarr and CSV, chosen by the file's ending; where outputs may be."""

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
from .writing import check_replaceable, named_failures, whole_file
from .writing.replacing import check_all_replaceable

if TYPE_CHECKING:
    import xarray as xr


def write(sweeps: xr.Dataset | SweepTable, path: str | Path) -> None:
    """Write sweeps to `path`; the file appears whole or not at all.

    Raises InputError where the ending is not one of ENDINGS or the folder does not exist.
    """
    path = checked_output(path)
    with whole_file(path) as unfinished:
        if isinstance(sweeps, SweepTable) and path.suffix in OF_TABLES:
            OF_TABLES[path.suffix](sweeps, unfinished)
        else:
            whole = sweeps.dataset() if isinstance(sweeps, SweepTable) else sweeps
            OF_DATASETS[path.suffix](check(whole), unfinished)


def checked_output(path: str | Path, endings: Sequence[str] = ENDINGS) -> Path:
    """The same path, if such a file can be written there: to be asked before any work is done.

    Raises InputError as `checked_place`, and where what is there may not be replaced (see
    `writing`).
    """
    path = checked_place(path, endings)
    check_replaceable(path)
    return path


def checked_place(path: str | Path, endings: Sequence[str]) -> Path:
    """The same path, if such a file could be written there, whatever is there now.

    Raises InputError where the ending is another, the folder does not exist or may not be written
    to, the name is too long, or the path is a folder.
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
    """The same path, if it is a folder or can become one in a folder that exists.

    names: patterns of what will be written in it. Raises InputError, also where a file of such a
    name may not be replaced.
    """
    if path.exists() and not path.is_dir():
        raise InputError(f"{path}: is a file, not a folder")
    _check_parent(path)
    check_all_replaceable(path, names)
    return path


def made_folder(path: Path) -> Path:
    """The same folder, made with those above it where it does not exist.

    Raises InputError where it cannot be made.
    """
    with named_failures(path):
        path.mkdir(parents=True, exist_ok=True)
    return path


LONGER = 16
"""Characters of names beside an output's that are longer than its own, such as a recording's."""


def _check_parent(path: Path) -> None:
    with named_failures(path):
        if not path.parent.is_dir():
            raise InputError(f"{path}: the folder {path.parent} does not exist")
        path.with_name(f"{path.name}{LONGER * '_'}").exists()  # raises where that is too long
        if not os.access(path.parent, os.W_OK | os.X_OK):
            raise PermissionError(errno.EACCES, "", str(path))


@contextmanager
def locked(folder: Path, begun: str, busy: str) -> Iterator[Path]:
    """The folder, made if need be, and no other process's while the block runs.

    At the end it is taken away if no file in it has a name like `begun`: the lock last, as Windows
    removes no file that is open. The system frees the lock of a killed process. Raises InputError,
    saying `busy`, where another process has it.
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
        done = not any(folder.glob(begun))
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


OF_TABLES = {".nc": write_table, ".csv": write_rows}
OF_DATASETS = {".nc": write_dataset, ".zarr": _write_zarr, ".csv": write_csv}
