"""Turns system errors of writing into one line that states what to do."""

from __future__ import annotations

import errno
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import InputError, OutputError

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
def named_failures(path: Path) -> Iterator[None]:
    """Turns write errors in the block into one line that names `path`.

    Raises InputError if another path avoids the error, OutputError if the disk is at fault. Other
    errors, and errors about files elsewhere, pass unchanged.
    """
    try:
        yield
    except OutputError as error:
        text = str(error)
        raise OutputError(text if text.startswith(str(path)) else f"{path}: {text}") from error
    except (OSError, RuntimeError) as error:
        if _of_disk(error):
            reason = DISKS.get(getattr(error, "errno", None) or 0, f"{error}; is the disk full?")
            raise OutputError(f"{path}: cannot be written: {reason}") from error
        if isinstance(error, OSError) and error.errno in PATHS and _near(error.filename, path):
            raise InputError(f"{path}: cannot be written: {PATHS[error.errno]}") from error
        raise


def _of_disk(error: Exception) -> bool:
    """True for errors of a disk that did not accept the data."""
    return getattr(error, "errno", None) in DISKS or str(error).startswith(OF_NETCDF)


def _near(filename: object, path: Path) -> bool:
    """True if the file name of an error is in the folder of `path`, or if it names none."""
    if not isinstance(filename, str | bytes | Path):
        return True
    named = Path(filename.decode() if isinstance(filename, bytes) else filename).absolute()
    folder = path.absolute().parent
    return folder in (named, *named.parents) or path.resolve().parent in named.parents
