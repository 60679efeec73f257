"""A user's output: written whole, by the rule of what may be replaced, and known again later."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .register import note_made
from .replacing import UNFINISHED, check_free, occasion, tell_replaced
from .whole import kept_file


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A new file or folder, renamed to `path` at the end of the block, as `kept_file`.

    Raises InputError where `path` may not be replaced (see `check_free`), InputError or
    OutputError where it cannot be written.
    """
    check_free(path)
    with kept_file(path) as unfinished:
        yield unfinished
        tell_replaced(path)
    if occasion() != UNFINISHED:
        note_made(path, occasion().command)
