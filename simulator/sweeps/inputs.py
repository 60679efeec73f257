"""How every input is opened: a regular file of a bounded size, whose contents are bounded, too.

A pipe would be waited for, a device has no end, and a small file can declare or unpack to more than
the memory holds: each is refused in one line before anything of it is read.
"""

from __future__ import annotations

import io
import json
import os
import stat
import tomllib
import zipfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from .errors import InputError
from .free_space import SHARE, free_memory

MIB, GIB = 2**20, 2**30
WHOLE = 2**63
"""TOML's whole numbers have 64 bits."""


@dataclass(frozen=True)
class InputKind:
    """What an input is, and its largest size in bytes."""

    what: str
    most: int


SCENE = InputKind("a scene", 32 * MIB)
"""A mesh of 400,000 triangles as numbers is as large."""
SETTINGS = InputKind("a file of settings", MIB)
"""Tables of a switch or of accuracies, orders and scripts of presses: 20,000 lines."""
MAP = InputKind("a map", 16 * MIB)
"""As a CSV; a thousand times a thousand factors of 16 characters."""
PICTURE = InputKind("a picture", 256 * MIB)
"""64 million pixels of 16 bits, three colours, not compressed."""
MESH = InputKind("a mesh", 256 * MIB)
"""A few million triangles."""
TABLE = InputKind("a table of sweeps", 512 * MIB)
"""Five million readings; as text it takes ten times as much memory."""
SWEEPS = InputKind("a file of sweeps", 16 * GIB)
MODEL = InputKind("a model", 4 * GIB)
"""A hundred thousand sweeps that a kernel keeps, at a thousand features, are 0.8 GB."""
JOURNAL = InputKind("a journal", 512 * MIB)
"""Of a recording or a design: as large as a table of the same numbers."""
LINE = MIB
"""Bytes of one line of a table: a hundred thousand columns."""
MAX_CHUNK_BYTES = GIB
"""Of one part of a Zarr array, which is decoded whole."""
MAX_CHUNKS = 10**6


def check_input(path: Path, kind: InputKind) -> Path:
    """The same path. Raises InputError where it is no regular file, or larger than `kind` is."""
    try:
        _check(path, kind, path.stat())
    except OSError as error:
        raise _unreadable(path, error) from None
    return path


def content(path: Path, kind: InputKind) -> bytes:
    """All bytes of a file. Raises InputError as `check_input`, and where it cannot be read."""
    flags = os.O_RDONLY | getattr(os, "O_BINARY", 0) | getattr(os, "O_NONBLOCK", 0)
    try:
        if path.is_dir():  # Windows opens none
            _check(path, kind, path.stat())
        with open(os.open(path, flags), "rb") as file:
            _check(path, kind, os.fstat(file.fileno()))
            return file.read()
    except OSError as error:
        raise _unreadable(path, error) from None


def table(path: Path) -> bytes:
    """All bytes of a table of sweeps. Raises InputError as `content`, and for endless lines."""
    found = content(path, TABLE)
    for number, line in enumerate(io.BytesIO(found), 1):
        if len(line) > LINE and not line.startswith(b"#"):
            raise InputError(f"{path}: line {number} is longer than {LINE} bytes: is it a table?")
    return found


def text(path: Path, kind: InputKind) -> str:
    """A file in UTF-8 as text. Raises InputError as `content`, and for other bytes."""
    try:
        return content(path, kind).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: cannot be read: not text in UTF-8 ({error.reason})") from error


def tables(given: str) -> dict[str, Any]:
    """The tables of a TOML text. Raises tomllib.TOMLDecodeError, too deep nesting included."""
    if len(given) > SCENE.most:  # within sweeps or a model
        raise tomllib.TOMLDecodeError(f"it has {len(given) / MIB:.4g} MiB; {_at_most(SCENE)}")
    try:
        found = tomllib.loads(given)
        if _beyond(found):
            raise tomllib.TOMLDecodeError("a whole number has more than 64 bits")
        return found
    except tomllib.TOMLDecodeError:
        raise
    except RecursionError:
        raise tomllib.TOMLDecodeError("tables or lists are nested too deep") from None
    except ValueError as error:
        raise tomllib.TOMLDecodeError(str(error)) from None


def objects(given: str) -> Any:
    """What a JSON text holds. Raises ValueError, too deep nesting included."""
    try:
        return json.loads(given)
    except RecursionError:
        raise ValueError("lists or objects are nested too deep") from None


def check_memory(path: Path, size: int) -> None:
    """Raises InputError where arrays of a file would take more bytes than is sensible here."""
    most = min(SWEEPS.most, SHARE * free_memory())
    if size > most:
        raise InputError(
            f"{path}: declares {size / GIB:.3g} GiB of numbers; at most {most / GIB:.3g} GiB are "
            "read at once here"
        )


def check_archive(path: Path, file: IO[bytes]) -> None:
    """Raises InputError where a ZIP archive would unpack to more than a model is.

    path: only named. Raises zipfile.BadZipFile where it is no archive.
    """
    with zipfile.ZipFile(file) as archive:
        size = sum(each.file_size for each in archive.infolist())
    if size > min(MODEL.most, SHARE * free_memory()):
        raise InputError(f"{path}: unpacks to {size / GIB:.3g} GiB; {_at_most(MODEL)}")


def check_folder(path: Path) -> None:
    """Raises InputError where a folder holds anything but folders and regular files."""
    with os.scandir(path) as listed:
        entries = list(listed)
    for entry in entries:
        if entry.is_dir(follow_symlinks=False):
            check_folder(Path(entry.path))
        elif not entry.is_file(follow_symlinks=False):
            raise InputError(f"{entry.path}: must be a regular file, not a link, pipe or device")


def check_arrays(path: Path, arrays: Iterable[tuple[str, int, int, int]]) -> None:
    """Raises InputError where arrays of a Zarr declare more than can be read in parts.

    arrays: of each its name, number of dimensions, bytes of a chunk and number of chunks.
    """
    for name, dimensions, size, count in arrays:
        if size > MAX_CHUNK_BYTES or count > MAX_CHUNKS:
            raise InputError(
                f"{path}: `{name}` declares {count} parts of {size} bytes; at most {MAX_CHUNKS} "
                f"of {MAX_CHUNK_BYTES} are read"
            )
        if dimensions == 1:  # read whole when it is opened
            check_memory(path, size * count)


def _check(path: Path, kind: InputKind, told: os.stat_result) -> None:
    if stat.S_ISDIR(told.st_mode):
        raise InputError(f"{path}: is a folder; {kind.what} is a file")
    if not stat.S_ISREG(told.st_mode):
        raise InputError(f"{path}: is a pipe, a device or a socket; {kind.what} is a regular file")
    if told.st_size > kind.most:
        raise InputError(f"{path}: has {told.st_size / MIB:.4g} MiB; {_at_most(kind)}")


def _at_most(kind: InputKind) -> str:
    return f"{kind.what} has at most {kind.most / MIB:.4g} MiB"


def _unreadable(path: Path, error: OSError) -> InputError:
    if isinstance(error, FileNotFoundError):
        return InputError(f"{path}: no such file")
    return InputError(f"{path}: cannot be read: {error.strerror or error}")


def _beyond(value: Any) -> bool:
    """Whether any whole number in tables has more than 64 bits."""
    if isinstance(value, dict | list):
        return any(map(_beyond, value.values() if isinstance(value, dict) else value))
    return isinstance(value, int) and not -WHOLE <= value < WHOLE
