"""Outputs of users: where one may be written, what it may replace, and sweeps by file ending.

Nothing that exists is replaced without an option. Measured sweeps need an option of their own,
because nobody can make them again.
"""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING

from .errors import InputError, named
from .formats import ENDINGS, FORMATS
from .formats.zarr import check_zarr
from .schema import MEASURED, VIRTUAL, SweepTable, check
from .writing import PREFIX, keep_beside, kept_file, named_failures, present

if TYPE_CHECKING:
    import xarray as xr

FILES, MEASURED_TOO = 1, 2
_replaceable: ContextVar[int] = ContextVar("replaceable", default=0)
"""What may be replaced: nothing, FILES and folders, or MEASURED_TOO: even measured sweeps."""
DERIVED_NAME_LENGTH = 32
"""Extra characters of names that are derived from an output's name, such as journals."""


@contextmanager
def replacing(files: bool = True, measured: bool = False) -> Iterator[None]:
    """Within the block, files and folders may be replaced too, or even measured sweeps."""
    more = MEASURED_TOO if measured else FILES * files
    token = _replaceable.set(max(_replaceable.get(), more))
    try:
        yield
    finally:
        _replaceable.reset(token)


def may_replace(measured: bool = False) -> bool:
    """True within `replacing`; measured: True if even measured sweeps may be replaced."""
    return _replaceable.get() >= (MEASURED_TOO if measured else FILES)


def check_replaceable(path: Path) -> None:
    """Raises InputError with reason and advice if something exists that may not be replaced.

    Without an option the file is not read, so that a command refuses at once.
    """
    if not present(path) or may_replace(measured=True):
        return
    if not may_replace():
        reason, option = "already exists", f"{named('overwrite', flag=True)} replaces it"
        if path.suffix in FORMATS:
            option += f" ({named('overwrite_measured', flag=True)} if its sweeps were measured)"
    elif reason := _measured(path):
        option = f"{named('overwrite_measured', flag=True)} replaces it"
    else:
        return
    raise InputError(f"{path}: {reason}; {option}, or give another name")


def check_all_replaceable(folder: Path, patterns: Iterable[str]) -> None:
    """Applies `check_replaceable` to all files in `folder` whose names match the patterns."""
    for pattern in patterns:
        for path in sorted(folder.glob(pattern)):
            check_replaceable(path)


def _measured(path: Path) -> str | None:
    """Why a file counts as measured sweeps; None if it does not.

    A damaged file with an ending of sweeps counts as measured, so that damage never makes measured
    sweeps easier to lose. Only a tolerance shows that sweeps were simulated.
    """
    if path.suffix not in FORMATS:
        return None
    before = _identity(path)
    try:
        names, attributes = FORMATS[path.suffix].marks(path)
    except Exception:  # of whatever library
        if (now := _identity(path)) is None:
            return None
        if now != before:  # another writer replaced it meanwhile
            return _measured(path)
        return "already exists, and cannot be read whole: it may hold measured sweeps"
    recorded = attributes.get("model") in (MEASURED, VIRTUAL)
    if not recorded and ("rtol" in attributes or not names & {"Rs", "Cp", "gain"}):
        return None
    begun = attributes.get("begun")
    return "already exists with measured sweeps" + (f", begun {begun}" if begun else "")


def _identity(path: Path) -> tuple[int, int] | None:
    """Number and time of what is at a path, which differ once it was replaced; None if nothing."""
    with suppress(FileNotFoundError):
        found = path.stat()
        return found.st_ino, found.st_mtime_ns
    return None


@contextmanager
def whole_file(path: Path, folder: bool = False) -> Iterator[Path]:
    """Like `kept_file`, for a user's output, which replaces only what it may.

    Raises InputError if `path` may not be replaced (see `check_replaceable`). If something appeared
    there while the block ran, the finished output stays next to it, and the error names both.
    """
    check_replaceable(path)
    with kept_file(path, folder) as unfinished:
        yield unfinished
        try:
            check_replaceable(path)
        except InputError as error:
            raise InputError(f"{error}. {keep_beside(unfinished, path)}") from error


def write(sweeps: xr.Dataset | SweepTable, path: str | Path) -> None:
    """Writes sweeps to `path`; the file appears whole or not at all.

    Raises InputError if the ending is not in ENDINGS or the folder does not exist.
    """
    path = checked_output(path)
    with whole_file(path) as unfinished:
        FORMATS[path.suffix].write(check(sweeps), unfinished)


def checked_output(path: str | Path, endings: Sequence[str] = ENDINGS) -> Path:
    """Returns the path if a file can be written there; call it before any work is done.

    Raises InputError as `checked_place`, and if a file exists that may not be replaced.
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
    if path.suffix == ".zarr":
        check_zarr(path)
    elif path.is_dir():
        raise InputError(f"{path}: is a folder, not a file to write to")
    return path


OF_FILES = (".toml", ".nc", ".csv", ".npz", ".json", ".html", ".png", ".svg", ".pdf")
"""Endings of single files, as no folder that rcskin makes has one."""


def checked_folder(path: Path, *names: str) -> Path:
    """Returns the path if it is a folder, or can become one in an existing folder.

    names: name patterns of the files to be written. Raises InputError, also for a name with the
    ending of a single file, and if an existing file of such a name may not be replaced.
    """
    if path.exists() and not path.is_dir():
        raise InputError(f"{path}: is a file, not a folder")
    _check_folder_name(path)
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

    Raises InputError if it cannot be made, and for a name with the ending of a single file.
    """
    _check_folder_name(path)
    with named_failures(path):
        path.mkdir(parents=True, exist_ok=True)
    return path


def _check_folder_name(path: Path) -> None:
    if path.suffix in OF_FILES and not path.exists():
        raise InputError(
            f"{path}: a folder of several files is written here; give a name without {path.suffix}"
        )


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
