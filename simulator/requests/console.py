"""Messages of commands: warnings, notes, and the files that were written."""

from __future__ import annotations

import logging
from pathlib import Path

from ..safe_text import say


def warn(text: str) -> None:
    """Prints a warning on standard error: something may be wrong."""
    say(f"rcskin: warning: {text}", err=True)


def note(text: str) -> None:
    """Prints a note on standard error: something useful to know."""
    say(f"rcskin: note: {text}", err=True)


def show_log_as_notes(library: str) -> None:
    """From now on, prints each line that a library logs as a note."""
    handler, logger = logging.Handler(logging.INFO), logging.getLogger(library)
    handler.emit = lambda record: note(record.getMessage())
    logger.handlers = [handler]
    logger.setLevel(logging.INFO)


def report_written(what: str, *paths: Path) -> None:
    """Prints on standard output what was written, and where."""
    say(f"{what} -> {', '.join(map(str, paths))}")
