"""A file or a folder that appears whole or not at all, and stays through a power cut."""

from __future__ import annotations

import atexit
import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path

from ..errors import OutputError
from .failures import named_failures
from .left_overs import PREFIX, clear_left_overs, own_mark

FOLDERS = (".zarr",)
"""Endings of what is a folder."""
SWAPS = 10
"""Attempts to swap a folder, which other writers may be swapping at the same time."""


@contextmanager
def kept_file(path: Path) -> Iterator[Path]:
    """A new, empty file or folder beside `path`, renamed to `path` at the end of the block.

    Its name cannot be guessed. It is on the disk before it is renamed, and the new name before the
    block ends. Where `path` is a symbolic link, its target is replaced. If the block ends with an
    error nothing is renamed and nothing is left, nor where the process is told to end within it.

    Raises InputError or OutputError naming `path` where it cannot be written.
    """
    with named_failures(path):
        place = Path(os.path.realpath(path))
        clear_left_overs(place.parent)
        unfinished = _new(place)
        remove = partial(removed, unfinished)
        atexit.register(remove)
        try:
            yield unfinished
            _check_written(unfinished)
            sync(unfinished)
            put(unfinished, place)
        finally:
            remove()
            atexit.unregister(remove)


def put(unfinished: Path, place: Path) -> None:
    """Give what is finished its name, in place of a file or folder of that name.

    Where the name is not free to be taken, as that of a file which another program has open under
    Windows, what is finished stays beside it. Raises OutputError naming both, OSError where the
    folder is gone.
    """
    try:
        if unfinished.is_dir():
            _swap(unfinished, place)
        else:
            with suppress(OSError):
                shutil.copymode(place, unfinished)
            os.replace(unfinished, place)
    except OSError as error:
        if not unfinished.exists():
            raise
        beside = place.with_name(f"finished-{secrets.token_hex(4)}{place.suffix}")
        os.rename(unfinished, beside)
        raise OutputError(
            f"{place}: cannot be replaced ({error.strerror}); close it in other programs. "
            f"What was to be there is finished, in {beside}"
        ) from error
    _sync_folder(place.parent)


def _swap(unfinished: Path, place: Path) -> None:
    """Rename a folder to a name that another one may have, which is deleted after that.

    Other writers may take the name or free it at any moment. What this one has put aside goes once
    its own folder had the name, and comes back where it never gets it.
    """
    aside: list[Path] = []
    for attempt in range(SWAPS):
        before = place.with_name(f"{PREFIX}replaced-{secrets.token_hex(8)}{place.suffix}")
        with suppress(FileNotFoundError):
            os.rename(place, before)
            aside.append(before)
        try:
            os.rename(unfinished, place)
            break
        except OSError:
            if attempt == SWAPS - 1:
                _put_back(aside, place)
                raise
    for each in aside:
        removed(each)


def _put_back(aside: list[Path], place: Path) -> None:
    """Give the newest of what was put aside its name again, unless another folder has it."""
    with suppress(OSError, IndexError):
        os.rename(aside[-1], place)
    if place.exists():
        for each in aside:
            removed(each)


def sync(path: Path) -> None:
    """Have a file, or all that is in a folder, on the disk."""
    if path.is_dir():
        for folder, _, names in os.walk(path):
            for name in names:
                _sync_file(Path(folder, name))
            _sync_folder(Path(folder))
    else:
        _sync_file(path)


def removed(path: Path) -> None:
    """Delete a file or a folder if it is there."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _new(place: Path) -> Path:
    unfinished = place.with_name(f"{own_mark()}{secrets.token_hex(8)}{place.suffix}")
    if place.suffix in FOLDERS:
        unfinished.mkdir()
    else:
        os.close(os.open(unfinished, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
    return unfinished


def _check_written(unfinished: Path) -> None:
    """Raises OutputError where a library wrote nothing and said nothing, as on a full disk."""
    if not unfinished.is_dir() and unfinished.stat().st_size == 0:
        raise OutputError("nothing could be written; is the disk full?")


def _sync_file(path: Path) -> None:
    with path.open("r+b") as file:
        os.fsync(file.fileno())


def _sync_folder(path: Path) -> None:
    """Have the names in a folder on the disk; Windows opens no folder, and needs no such call."""
    if os.name == "nt":
        return
    number = os.open(path, os.O_RDONLY)
    try:
        os.fsync(number)
    except OSError:  # some network file systems refuse it for folders
        pass
    finally:
        os.close(number)
