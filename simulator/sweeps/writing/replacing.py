"""The rule of what an output may replace.

What the same command made before, and nobody changed since, is replaced with a note. Replaced only
on demand is: what rcskin did not make, another command's result, and what the command reads
itself. What was measured needs a demand of its own.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path

from ..errors import InputError
from .measured_files import measured
from .register import made_by

PYTHON = "Python"
"""In place of a command: a script."""

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class WriteContext:
    """Who writes, what is read for it, and what is demanded.

    command: such as `sweep`, `meter record`, or PYTHON. inputs: paths that it reads. overwrite,
    overwrite_measured: whether anything, and even what was measured, may be replaced. noted:
    folders in which a note has told that something is replaced.
    """

    command: str = PYTHON
    inputs: tuple[Path, ...] = ()
    overwrite: bool = False
    overwrite_measured: bool = False
    noted: set[Path] = field(default_factory=set, compare=False)

    def option(self, name: str) -> str:
        """How a demand is made."""
        return f"{name}=True" if self.command == PYTHON else f"--{name.replace('_', '-')}"


UNFINISHED = WriteContext("a part of an output")
"""On which files are written that are not outputs yet: none of them is remembered."""
_now: ContextVar[WriteContext] = ContextVar("occasion", default=WriteContext())  # noqa: B039


def write_context() -> WriteContext:
    """On which occasion outputs are written now."""
    return _now.get()


@contextmanager
def in_write_context(now: WriteContext) -> Iterator[None]:
    """Within the block, outputs are written on that occasion."""
    token = _now.set(now)
    try:
        yield
    finally:
        _now.reset(token)


def check_replaceable(path: Path) -> None:
    """Raises InputError, saying what is there and what to do, where `path` may not be replaced."""
    now = write_context()
    if now.overwrite_measured or not path.exists():
        return
    maker = made_by(path)
    if readings := measured(path, maker == now.command):
        raise InputError(
            f"{path}: is there already with {readings}; {now.option('overwrite_measured')} "
            "replaces it, or give another name"
        )
    if now.overwrite:
        return
    if reason := _reason(path, maker, now):
        raise InputError(
            f"{path}: {reason}; {now.option('overwrite')} replaces it, or give another name"
        )


def check_all_replaceable(folder: Path, patterns: Iterable[str]) -> None:
    """As `check_replaceable`, for all files in `folder` of these names that a report writes."""
    for pattern in patterns:
        for path in sorted(folder.glob(pattern)):
            check_replaceable(path)


def log_replaced(path: Path) -> None:
    """Log a note where something is about to be replaced, one for the files of a folder."""
    noted = write_context().noted
    if path.exists() and path.parent not in noted:
        noted.add(path.parent)
        log.info("%s: replaces what was there", path)


def _reason(path: Path, maker: str | None, now: WriteContext) -> str | None:
    """Why it may not be replaced; None where it may."""
    if any(each.exists() and os.path.samefile(each, path) for each in now.inputs):
        return "is read by this command, too"
    if maker is None:
        return "is there already, and was not made by rcskin or was changed since"
    if maker != now.command:
        return f"is there already, made by {maker if maker == PYTHON else f'rcskin {maker}'}"
    return None
