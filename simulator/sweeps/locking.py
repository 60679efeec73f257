"""A folder of unfinished work, kept for one process."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .errors import InputError


@contextmanager
def locked(folder: Path, begun: str, busy: str) -> Iterator[Path]:
    """The folder, made if need be, and no other process's while the block runs.

    At the end it is taken away if there is no file `begun` in it. The system frees the lock of a
    killed process. Raises InputError, saying `busy`, where another process has it.
    """
    from filelock import FileLock, Timeout

    folder.mkdir(exist_ok=True)
    lock = FileLock(folder / "lock")
    try:
        lock.acquire(blocking=False)
    except Timeout:
        raise InputError(busy) from None
    try:
        yield folder
    finally:
        if not (folder / begun).exists():
            shutil.rmtree(folder, ignore_errors=True)
        lock.release()
