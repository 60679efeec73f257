"""Opens inputs safely: regular files of bounded size, whose declared contents are bounded as well.

A pipe would block, a device has no end, and a small file can declare or unpack to more than the
memory holds. Each is refused in one line before anything is read.
"""

from __future__ import annotations

import io
import json
import os
import stat
import tomllib
import warnings
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .errors import InputError
from .free_space import SHARE, free_memory

if TYPE_CHECKING:
    from PIL import Image

MIB, GIB = 2**20, 2**30
INTEGER_LIMIT = 2**63
"""Limit of whole numbers: TOML's have 64 bits."""


@dataclass(frozen=True)
class InputKind:
    """Kind of an input file: a noun with its article, and the largest size in bytes."""

    label: str
    max_bytes: int


SCENE = InputKind("a scene", 32 * MIB)
"""Room for a mesh of 400,000 triangles as numbers."""
SETTINGS = InputKind("a file of settings", MIB)
"""Switch tables, accuracy tables, press orders and scripts: 20,000 lines."""
MAP = InputKind("a map", 16 * MIB)
"""A CSV of 1000 x 1000 factors with 16 characters each."""
PICTURE = InputKind("a picture", 256 * MIB)
"""64 million pixels of 16 bits and three colours, uncompressed."""
PICTURES = ("PNG", "JPEG", "TIFF", "BMP")
MAX_PIXELS = 2**26
"""Largest number of pixels of a picture; each takes up to 8 bytes in memory."""
MESH = InputKind("a mesh", 256 * MIB)
"""A few million triangles."""
TABLE = InputKind("a table of sweeps", 512 * MIB)
"""Five million readings; parsing takes ten times as much memory."""
SWEEPS = InputKind("a file of sweeps", 16 * GIB)
MODEL = InputKind("a model", 4 * GIB)
"""A kernel model with 100,000 support sweeps of 1000 features has 0.8 GB."""
JOURNAL = InputKind("a journal", 512 * MIB)
"""Journal of a recording or a design: as large as a table of the same numbers."""
LINE = MIB
"""Largest number of bytes in one line of a table: 100,000 columns."""
MAX_REASON = 200
"""Largest number of characters of a library's own message."""
ANOTHER_COPY = "; use another copy"
KIND_OF = {
    ".toml": "scene",
    **dict.fromkeys((".nc", ".csv", ".zarr"), "sweeps"),
    ".npz": "model",
}
GIVEN = {"scene": "this is a scene", "sweeps": "these are sweeps", "model": "this is a model"}
EXPECTED = {
    "scene": "a scene is expected here: a .toml or a built-in name",
    "sweeps": "sweeps are expected here: a .nc, .csv or .zarr",
    "model": "a model is expected here: a .npz, as rcskin train writes",
}
FOREIGN = "tables of instruments and other programs are read by rcskin import"


def check_file_kind(path: Path, expected: str) -> None:
    """Raises InputError if the ending belongs to another kind of file than `expected`.

    expected: a key of EXPECTED. Unknown endings pass.
    """
    given = KIND_OF.get(path.suffix, expected)
    if given == expected:
        return
    simulated = f"; rcskin sweep {path} -o {path.stem}.nc simulates some"
    hint = simulated if (given, expected) == ("scene", "sweeps") else ""
    raise InputError(f"{path}: {GIVEN[given]}, {EXPECTED[expected]}{hint}")


def check_input(path: Path, kind: InputKind) -> Path:
    """Returns the path. Raises InputError if it is no regular file or is too large for its kind."""
    try:
        _check(path, kind, path.stat())
    except OSError as error:
        raise _unreadable(path, error) from None
    return path


def content(path: Path, kind: InputKind) -> bytes:
    """All bytes of a file. Raises InputError as `check_input`, and if it cannot be read."""
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
    """All bytes of a table of sweeps. Raises InputError as `content`, and for too long lines."""
    found = content(path, TABLE)
    for number, line in enumerate(io.BytesIO(found), 1):
        if len(line) > LINE and not line.startswith(b"#"):
            raise InputError(f"{path}: line {number} is longer than {LINE} bytes: is it a table?")
    return found


def text(path: Path, kind: InputKind) -> str:
    """The text of a UTF-8 file. Raises InputError as `content`, and for other encodings."""
    try:
        return content(path, kind).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: cannot be read: not text in UTF-8 ({error.reason})") from error


def picture(path: Path) -> Image.Image:
    """A picture that is not decoded yet; decoding raises OSError, ValueError or SyntaxError.

    Raises InputError as `content`, for other formats than PICTURES, and for more than MAX_PIXELS.
    """
    from PIL import Image

    file = io.BytesIO(content(path, PICTURE))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            found = Image.open(file, formats=PICTURES)
    except (OSError, SyntaxError, ValueError):
        raise InputError(f"{path}: cannot be read as an image of {', '.join(PICTURES)}") from None
    except Image.DecompressionBombError as error:
        raise InputError(f"{path}: {error}; at most {MAX_PIXELS} pixels are read") from error
    if found.width * found.height > MAX_PIXELS:
        size = f"{found.width} x {found.height}"
        raise InputError(f"{path}: has {size} pixels; at most {MAX_PIXELS} are read")
    return found


@contextmanager
def named_damage(path: Path, failure: str, advice: str = "") -> Iterator[None]:
    """Turns whatever a library raises for a damaged file into one line that names it.

    failure: such as `cannot be read as .nc`. advice: follows the reason.
    """
    try:
        yield
    except InputError:
        raise
    except Exception as error:
        reason = " ".join(str(error).split())[:MAX_REASON] or type(error).__name__
        raise InputError(f"{path}: {failure}: {reason}{advice}") from error


def tables(given: str) -> dict[str, Any]:
    """The tables of a TOML text. Raises TOMLDecodeError, also for nesting that is too deep."""
    if len(given) > SCENE.max_bytes:  # within sweeps or a model
        raise tomllib.TOMLDecodeError(f"it has {len(given) / MIB:.4g} MiB; {_limit_text(SCENE)}")
    try:
        found = tomllib.loads(given)
        if _has_large_integer(found):
            raise tomllib.TOMLDecodeError("a whole number has more than 64 bits")
        return found
    except tomllib.TOMLDecodeError:
        raise
    except RecursionError:
        raise tomllib.TOMLDecodeError("tables or lists are nested too deep") from None
    except ValueError as error:
        raise tomllib.TOMLDecodeError(str(error)) from None


def objects(given: str) -> Any:
    """The content of a JSON text. Raises ValueError, also for nesting that is too deep."""
    try:
        return json.loads(given)
    except RecursionError:
        raise ValueError("lists or objects are nested too deep") from None


def check_memory(path: Path, size: float) -> None:
    """Raises InputError if the arrays of a file need more memory than is available."""
    most = min(SWEEPS.max_bytes, SHARE * free_memory())
    if size > most:
        raise InputError(
            f"{path}: declares {size / GIB:.3g} GiB of numbers; at most {most / GIB:.3g} GiB are "
            "read at once here"
        )


def check_unpacked(path: Path, archive: zipfile.ZipFile) -> None:
    """Raises InputError if an archive unpacks to more than the limit of a model."""
    size = sum(each.file_size for each in archive.infolist())
    if size > min(MODEL.max_bytes, SHARE * free_memory()):
        raise InputError(f"{path}: unpacks to {size / GIB:.3g} GiB; {_limit_text(MODEL)}")


def check_folder(path: Path) -> None:
    """Raises InputError if a folder holds anything but folders and regular files."""
    with os.scandir(path) as listed:
        entries = list(listed)
    for entry in entries:
        if entry.is_dir(follow_symlinks=False):
            check_folder(Path(entry.path))
        elif not entry.is_file(follow_symlinks=False):
            raise InputError(f"{entry.path}: must be a regular file, not a link, pipe or device")


def _check(path: Path, kind: InputKind, status: os.stat_result) -> None:
    if stat.S_ISDIR(status.st_mode):
        raise InputError(f"{path}: is a folder; {kind.label} is a file")
    if not stat.S_ISREG(status.st_mode):
        raise InputError(f"{path}: is a pipe, a device or a socket; {kind.label} is a regular file")
    if status.st_size > kind.max_bytes:
        raise InputError(f"{path}: has {status.st_size / MIB:.4g} MiB; {_limit_text(kind)}")


def _limit_text(kind: InputKind) -> str:
    return f"{kind.label} has at most {kind.max_bytes / MIB:.4g} MiB"


def _unreadable(path: Path, error: OSError) -> InputError:
    if isinstance(error, FileNotFoundError):
        return InputError(f"{path}: no such file")
    return InputError(f"{path}: cannot be read: {error.strerror or error}")


def _has_large_integer(value: Any) -> bool:
    """True if any whole number in tables has more than 64 bits."""
    if isinstance(value, dict | list):
        return any(map(_has_large_integer, value.values() if isinstance(value, dict) else value))
    return isinstance(value, int) and not -INTEGER_LIMIT <= value < INTEGER_LIMIT
