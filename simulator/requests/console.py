"""What a command tells beside its work: warnings and notes, and what it wrote."""

from __future__ import annotations

import logging
from pathlib import Path

from ..safe_text import say


def warn(text: str) -> None:
    """One line on standard error: what may be wrong."""
    say(f"rcskin: warning: {text}", err=True)


def note(text: str) -> None:
    """One line on standard error: what is good to know."""
    say(f"rcskin: note: {text}", err=True)


def show_log_as_notes(library: str) -> None:
    """From now on each line that a library logs for its users is a note."""
    handler, logger = logging.Handler(logging.INFO), logging.getLogger(library)
    handler.emit = lambda record: note(record.getMessage())
    logger.handlers = [handler]
    logger.setLevel(logging.INFO)


def report_written(what: str, *paths: Path) -> None:
    """One line on standard output: what was written where."""
    say(f"{what} -> {', '.join(map(str, paths))}")
