"""Writes files and folders that appear whole or not at all and survive a power cut.

An output has a temporary name in its own folder until its data are on the disk.
"""

from __future__ import annotations

import errno
import os
import secrets
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from glob import escape
from pathlib import Path
from time import sleep

from ..cleanup import cleanup_after
from .errors import InputError, OutputError

PREFIX = ".rcskin-"
"""Beginning of the names of unfinished files and folders."""
ASIDE = f"{PREFIX}replaced-"
"""Beginning of the names of folders that are being replaced; eight digits and their name follow."""
FOLDERS = (".zarr",)
"""Endings of outputs that are folders."""
WAITS, WAIT = 50, 0.02
"""Number and seconds of waits for virus scanners and other readers, which keep a new file open for
a moment on Windows."""
SWAPS = 10
"""Attempts to swap a folder that other writers may be swapping at the same time."""
PATHS = {
    errno.EACCES: "the folder is not yours to write to; choose another one",
    errno.EPERM: "the system does not permit it; choose another folder",
    errno.EROFS: "the disk can only be read; choose another one",
    errno.ENAMETOOLONG: "the name is too long; choose a shorter one",
    errno.ENOENT: "the folder does not exist, or no longer; make it first",
    errno.EEXIST: "is a file, not a folder to write to",
    errno.ENOTDIR: "a part of the path is a file, not a folder",
    errno.EISDIR: "is a folder, not a file to write to",
    errno.ELOOP: "symbolic links lead in a circle",
    errno.EINVAL: "the system takes no such name",
}
"""Errors that another path avoids."""
DISKS = {
    errno.ENOSPC: "the disk is full; make room or choose another one",
    errno.EDQUOT: "your quota of the disk is used up; make room or choose another one",
    errno.EFBIG: "a file may not become that large there; choose another disk",
    errno.EIO: "the disk fails; choose another one",
}
"""Errors of the disk."""
OF_NETCDF = "NetCDF: "
"""Beginning of messages of the NetCDF library, which does not pass on system errors."""


@contextmanager
def kept_file(path: Path, folder: bool = False) -> Iterator[Path]:
    """Yields a new, empty file or folder next to `path`, and renames it to `path` after the block.

    folder: True if a folder is needed whatever the ending; those in FOLDERS always are. The name
    cannot be guessed. The data are on the disk before the renaming, and the new name is before the
    block ends. If `path` is a symbolic link, its target is replaced. After an error or a signal
    nothing is renamed and nothing is left behind.

    Raises InputError or OutputError naming `path` if it cannot be written.
    """
    with named_failures(path):
        place = Path(os.path.realpath(path))
        unfinished = place.with_name(f"{PREFIX}{secrets.token_hex(8)}{place.suffix}")
        with cleanup_after(partial(_delete, unfinished)):
            if folder or place.suffix in FOLDERS:
                unfinished.mkdir()
            else:
                unfinished.touch(exist_ok=False)
            yield unfinished
            if unfinished.is_file() and not unfinished.stat().st_size:  # a library kept silent
                raise OutputError("nothing could be written; is the disk full?")
            put(unfinished, place)


def put(unfinished: Path, place: Path) -> None:
    """Renames a finished file or folder to `place`, replacing an existing one.

    If the existing file cannot be replaced, for example because another program has it open on
    Windows, the finished one stays next to it; then OutputError names both. Raises OSError if the
    folder is gone.
    """
    _sync(unfinished)
    try:
        if unfinished.is_dir():
            _swap(unfinished, place)
        else:
            with suppress(OSError):
                shutil.copymode(place, unfinished)
            _patiently(os.replace, unfinished, place)
    except OSError as error:
        if not unfinished.exists():
            raise
        raise OutputError(
            f"{place}: cannot be replaced ({error.strerror}); close it in other programs. "
            f"{keep_beside(unfinished, place)}"
        ) from error
    _sync_folder(place.parent)


def keep_beside(unfinished: Path, place: Path) -> str:
    """Renames a finished file or folder to a new name next to `place`; says so in a sentence."""
    finished = place.absolute().with_name(f"finished-{secrets.token_hex(4)}{place.suffix}")
    shutil.move(unfinished, finished)
    return f"The finished output is in {finished}"


def present(path: Path) -> bool:
    """True if `path` exists. A folder that a killed writer moved aside is put back first.

    A writer that still runs moves it aside again.
    """
    with suppress(OSError, ValueError):
        if not path.exists():
            place = Path(os.path.realpath(path))
            os.rename(max(_aside(place), key=lambda each: each.lstat().st_mtime), place)
    return path.exists()


def _aside(place: Path) -> Iterator[Path]:
    """Folders that were moved aside from a place."""
    return place.parent.glob(f"{ASIDE}{8 * '?'}-{escape(place.name)}")


def _swap(unfinished: Path, place: Path) -> None:
    """Renames a folder to a name that another folder may have; no system replaces it in one step.

    Other writers may take or free the name at any moment. What was moved aside, also by writers
    that were killed, is deleted once this folder has had the name.
    """
    for attempt in range(SWAPS):
        aside = place.with_name(f"{ASIDE}{secrets.token_hex(4)}-{place.name}")
        with suppress(FileNotFoundError):
            _patiently(os.rename, place, aside)
        try:
            _patiently(os.rename, unfinished, place)
            break
        except OSError:
            if attempt == SWAPS - 1:
                present(place)
                raise
    for each in _aside(place):
        doomed = place.with_name(f"{PREFIX}{secrets.token_hex(8)}")  # half of it is never put back
        with suppress(OSError):  # it was put back, or another writer deletes it
            os.rename(each, doomed)
            _delete(doomed)


def _patiently(rename: Callable[[Path, Path], None], source: Path, target: Path) -> None:
    """Renames; on Windows again and again, if another program has the file open."""
    for _ in range(WAITS if os.name == "nt" else 0):
        with suppress(PermissionError):
            return rename(source, target)
        sleep(WAIT)
    rename(source, target)


def _delete(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _sync(path: Path) -> None:
    """Flushes a file, or everything in a folder, to the disk."""
    for folder, _, names in os.walk(path):
        for name in names:
            _sync(Path(folder, name))
        _sync_folder(Path(folder))
    if path.is_file():
        with path.open("r+b") as file:
            os.fsync(file.fileno())


def _sync_folder(path: Path) -> None:
    """Flushes the names in a folder to the disk; not possible and not needed on Windows."""
    if os.name == "nt":
        return
    number = os.open(path, os.O_RDONLY)
    with suppress(OSError):  # some network file systems refuse it for folders
        os.fsync(number)
    os.close(number)


@contextmanager
def named_failures(path: Path) -> Iterator[None]:
    """Turns write errors in the block into one line that names `path` and says what to do.

    Raises InputError if another path avoids the error, OutputError if the disk is at fault. Other
    errors, and errors about files elsewhere, pass unchanged.
    """
    try:
        yield
    except OutputError as error:
        text = str(error)
        raise OutputError(text if text.startswith(str(path)) else f"{path}: {text}") from error
    except (OSError, RuntimeError) as error:
        number = getattr(error, "errno", None) or 0
        if number in DISKS or str(error).startswith(OF_NETCDF):
            reason = DISKS.get(number, f"{error}; is the disk full?")
            raise OutputError(f"{path}: cannot be written: {reason}") from error
        if isinstance(error, OSError) and number in PATHS and _near(error.filename, path):
            raise InputError(f"{path}: cannot be written: {PATHS[number]}") from error
        raise


def _near(filename: object, path: Path) -> bool:
    """True if the file name of an error is in the folder of `path`, or if it names none."""
    if not isinstance(filename, str | bytes | Path):
        return True
    named = Path(filename.decode() if isinstance(filename, bytes) else filename).absolute()
    folder = path.absolute().parent
    return folder in (named, *named.parents) or path.resolve().parent in named.parents
