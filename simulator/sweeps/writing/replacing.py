"""The rule for overwriting: nothing that exists is replaced without an option.

Measured sweeps need an option of their own, because nobody can make them again.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

from ..digests import check_binary, check_store
from ..errors import InputError
from ..formats.csv import quantities_and_attributes
from ..formats.netcdf import LOCK
from ..schema import MEASURED, VIRTUAL
from .whole import keep_beside, kept_file, present


@dataclass(frozen=True)
class WriteContext:
    """What may be replaced: files and folders, or even measured sweeps."""

    overwrite: bool = False
    overwrite_measured: bool = False


_context: ContextVar[WriteContext] = ContextVar("write_context", default=WriteContext())  # noqa: B039


def write_context() -> WriteContext:
    """The current permissions to replace files."""
    return _context.get()


@contextmanager
def in_write_context(more: WriteContext) -> Iterator[None]:
    """Adds permissions to replace files within the block."""
    now = write_context()
    measured = now.overwrite_measured or more.overwrite_measured
    token = _context.set(WriteContext(now.overwrite or more.overwrite or measured, measured))
    try:
        yield
    finally:
        _context.reset(token)


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


def check_replaceable(path: Path) -> None:
    """Raises InputError with reason and advice if something exists that may not be replaced.

    Without an option the file is not read, so that a command refuses at once.
    """
    now = write_context()
    if not present(path) or now.overwrite_measured:
        return
    if not now.overwrite:
        reason, option = "already exists", "--overwrite replaces it"
        if path.suffix in MARKS:
            option += " (--overwrite-measured if its sweeps were measured)"
    elif reason := _measured(path):
        option = "--overwrite-measured replaces it"
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
    if path.suffix not in MARKS:
        return None
    before = _identity(path)
    try:
        names, attributes = MARKS[path.suffix](path)
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


Marks = tuple[set[str], dict[str, Any]]
"""Names of the variables in a file, and its attributes; both are empty if it is of another kind."""


def _netcdf_marks(path: Path) -> Marks:
    from netCDF4 import Dataset

    check_binary(path)
    if _is_text(path):
        return set(), {}
    with LOCK, Dataset(path) as file:
        return {*file.variables}, {name: file.getncattr(name) for name in file.ncattrs()}


def _is_text(path: Path) -> bool:
    """True if a file begins with text, as no NetCDF file does, or is empty."""
    with path.open("rb") as file:
        beginning = file.read(2**16)
    try:
        return "\0" not in beginning.decode()
    except UnicodeDecodeError:
        return False


def _zarr_marks(path: Path) -> Marks:
    if not any(chain(path.rglob("zarr.json*"), path.rglob(".z*"))):
        return set(), {}
    import zarr

    check_store(path)
    group = zarr.open_group(path, mode="r")
    return {*group.keys()}, group.attrs.asdict()


MARKS = {".nc": _netcdf_marks, ".zarr": _zarr_marks, ".csv": quantities_and_attributes}
"""Functions that read what shows whether a file holds sweeps; they raise if it is damaged."""
