"""Writes files and folders that appear whole or not at all and survive a power cut."""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from glob import escape
from pathlib import Path
from time import monotonic, sleep, time

from ...cleanup import cleanup_after
from ..errors import OutputError
from .failures import named_failures

PREFIX = ".rcskin-"
"""Beginning of the names of unfinished files and folders."""
ASIDE = f"{PREFIX}replaced-"
"""Beginning of the names of folders that are being replaced; eight digits and their name follow."""
DAY = 86400.0
"""Seconds without a change after which an unfinished file is taken for abandoned."""
FOLDERS = (".zarr",)
"""Endings of outputs that are folders."""
PATIENCE = 1.0
"""Seconds. Virus scanners and other readers on Windows keep a new file open for a moment."""
SWAPS = 10
"""Attempts to swap a folder that other writers may be swapping at the same time."""


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
        _clear_left_overs(place.parent)
        unfinished = _new(place, folder or place.suffix in FOLDERS)
        with cleanup_after(partial(delete, unfinished)):
            yield unfinished
            _check_written(unfinished)
            sync(unfinished)
            put(unfinished, place)


def put(unfinished: Path, place: Path) -> None:
    """Renames a finished file or folder to `place`, replacing an existing one.

    If the existing file cannot be replaced, for example because another program has it open on
    Windows, the finished one stays next to it; then OutputError names both. Raises OSError if the
    folder is gone.
    """
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
            aside = place.parent.glob(f"{ASIDE}{8 * '?'}-{escape(place.name)}")
            os.rename(max(aside, key=lambda each: each.lstat().st_mtime), place)
    return path.exists()


def _swap(unfinished: Path, place: Path) -> None:
    """Renames a folder to a name that another folder may have; that one is deleted afterwards.

    Other writers may take or free the name at any moment. What was moved aside is deleted once this
    folder has had the name, and is put back if it never gets it.
    """
    aside: list[Path] = []
    for attempt in range(SWAPS):
        before = place.with_name(f"{ASIDE}{secrets.token_hex(4)}-{place.name}")
        with suppress(FileNotFoundError):
            _patiently(os.rename, place, before)
            aside.append(before)
        try:
            _patiently(os.rename, unfinished, place)
            break
        except OSError:
            if attempt == SWAPS - 1:
                present(place)
                raise
    for each in aside:
        _discard(each)


def _discard(aside: Path) -> None:
    """Deletes a folder under another name, so that half of it is never put back."""
    unfinished = aside.with_name(f"{PREFIX}{secrets.token_hex(8)}")
    with suppress(OSError):  # it was put back, and replaced again
        os.rename(aside, unfinished)
        delete(unfinished)


def _patiently(rename: Callable[[Path, Path], None], source: Path, target: Path) -> None:
    """Renames; on Windows again and again for PATIENCE, if another program has the file open."""
    last = monotonic() + PATIENCE
    while True:
        try:
            return rename(source, target)
        except PermissionError:
            if os.name != "nt" or monotonic() > last:
                raise
        sleep(PATIENCE / 50)


def sync(path: Path) -> None:
    """Flushes a file, or everything in a folder, to the disk."""
    if path.is_dir():
        for folder, _, names in os.walk(path):
            for name in names:
                _sync_file(Path(folder, name))
            _sync_folder(Path(folder))
    else:
        _sync_file(path)


def delete(path: Path) -> None:
    """Deletes a file or a folder if it exists."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _new(place: Path, folder: bool) -> Path:
    unfinished = place.with_name(f"{PREFIX}{secrets.token_hex(8)}{place.suffix}")
    if folder:
        unfinished.mkdir()
    else:
        os.close(os.open(unfinished, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
    return unfinished


def _clear_left_overs(folder: Path) -> None:
    """Deletes what killed writers left: unfinished files, and folders that they replaced.

    Unfinished files must be unchanged for a day. Who wrote them cannot be known: another container
    has its own numbers of processes.
    """
    for path in folder.glob(f"{PREFIX}*"):
        if path.name.startswith(ASIDE):
            if path.with_name(path.name[len(ASIDE) + 9 :]).exists():
                _discard(path)
        elif _is_abandoned(path):
            with suppress(OSError):
                delete(path)


def _is_abandoned(path: Path) -> bool:
    try:
        changed = max(each.lstat().st_mtime for each in (path, *path.rglob("*")))
    except OSError:  # its writer renamed it just now
        return False
    return time() - changed > DAY


def _check_written(unfinished: Path) -> None:
    """Raises OutputError if a library silently wrote nothing, as on a full disk."""
    if not unfinished.is_dir() and unfinished.stat().st_size == 0:
        raise OutputError("nothing could be written; is the disk full?")


def _sync_file(path: Path) -> None:
    with path.open("r+b") as file:
        os.fsync(file.fileno())


def _sync_folder(path: Path) -> None:
    """Flushes the names in a folder to the disk; not possible and not needed on Windows."""
    if os.name == "nt":
        return
    number = os.open(path, os.O_RDONLY)
    try:
        os.fsync(number)
    except OSError:  # some network file systems refuse it for folders
        pass
    finally:
        os.close(number)
