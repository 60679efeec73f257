"""Writes a user's output: whole, by the rule of overwriting, and registered for later."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .register import note_made
from .replacing import UNFINISHED, check_replaceable, log_replaced, write_context
from .whole import kept_file


@contextmanager
def whole_file(path: Path, folder: bool = False) -> Iterator[Path]:
    """Yields a new file or folder that is renamed to `path` at the end of the block.

    Arguments as in `kept_file`.

    Raises InputError if `path` may not be overwritten (see `check_replaceable`), InputError or
    OutputError if it cannot be written.
    """
    check_replaceable(path)
    with kept_file(path, folder) as unfinished:
        yield unfinished
        log_replaced(path)
    if write_context() != UNFINISHED:
        note_made(path, write_context().command)
