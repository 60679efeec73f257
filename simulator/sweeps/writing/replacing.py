"""The rule for overwriting files.

A file that the same command made and nobody changed is overwritten with a note. An option is needed
to overwrite files that rcskin did not make, results of another command, and inputs of the command
itself. Measured sweeps need an option of their own.
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
from .measured_files import measured_description
from .register import made_by

PYTHON = "Python"
"""Stands for a script in place of a command."""

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class WriteContext:
    """The writing command, its inputs, and its overwrite options.

    command: such as `sweep`, `meter record`, or PYTHON. inputs: paths that it reads. overwrite,
    overwrite_measured: True if any file, and even measured sweeps, may be overwritten. noted:
    folders for which a note on overwriting was logged.
    """

    command: str = PYTHON
    inputs: tuple[Path, ...] = ()
    overwrite: bool = False
    overwrite_measured: bool = False
    noted: set[Path] = field(default_factory=set, compare=False)

    def option(self, name: str) -> str:
        """The option's spelling on the command line or in Python."""
        return f"{name}=True" if self.command == PYTHON else f"--{name.replace('_', '-')}"


UNFINISHED = WriteContext("a part of an output")
"""Context of files that are parts of an output; they are not registered."""
_context: ContextVar[WriteContext] = ContextVar("occasion", default=WriteContext())  # noqa: B039


def write_context() -> WriteContext:
    """The current context of writing."""
    return _context.get()


@contextmanager
def in_write_context(now: WriteContext) -> Iterator[None]:
    """Sets the context of writing within the block."""
    token = _context.set(now)
    try:
        yield
    finally:
        _context.reset(token)


def check_replaceable(path: Path) -> None:
    """Raises InputError with reason and advice if `path` may not be overwritten."""
    now = write_context()
    if now.overwrite_measured or not path.exists():
        return
    maker = made_by(path)
    if readings := measured_description(path, maker == now.command):
        raise InputError(
            f"{path}: already exists with {readings}; {now.option('overwrite_measured')} "
            "replaces it, or give another name"
        )
    if now.overwrite:
        return
    if reason := _reason(path, maker, now):
        raise InputError(
            f"{path}: {reason}; {now.option('overwrite')} replaces it, or give another name"
        )


def check_all_replaceable(folder: Path, patterns: Iterable[str]) -> None:
    """Applies `check_replaceable` to all files in `folder` whose names match the patterns."""
    for pattern in patterns:
        for path in sorted(folder.glob(pattern)):
            check_replaceable(path)


def log_replaced(path: Path) -> None:
    """Logs a note if a file is about to be overwritten; one note for all files of a folder."""
    noted = write_context().noted
    if path.exists() and path.parent not in noted:
        noted.add(path.parent)
        log.info("%s: replaces the earlier file", path)


def _reason(path: Path, maker: str | None, now: WriteContext) -> str | None:
    """Why a file may not be overwritten; None if it may."""
    if any(each.exists() and os.path.samefile(each, path) for each in now.inputs):
        return "this command also reads it"
    if maker is None:
        return "already exists, and was not made by rcskin or was changed since"
    if maker != now.command:
        return f"already exists, made by {maker if maker == PYTHON else f'rcskin {maker}'}"
    return None
