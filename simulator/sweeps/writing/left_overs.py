"""Files left by killed writers: deleted once the writer has ended."""

from __future__ import annotations

import hashlib
import logging
import os
import platform
import shutil
from functools import cache
from pathlib import Path
from time import time

PREFIX = ".rcskin-"
DAY = 86400.0
"""Seconds without a change after which an unfinished file of an unknown writer is abandoned."""

log = logging.getLogger(__name__)


def own_prefix() -> str:
    """Prefix of this process's unfinished files: names the machine and the process."""
    return f"{PREFIX}{_machine()}-{os.getpid()}-"


def clear_left_overs(folder: Path) -> None:
    """Deletes unfinished files of ended writers; logs files that a writer was about to replace.

    folder: where something is about to be written.
    """
    for path in folder.glob(f"{PREFIX}*"):
        if path.name.startswith(f"{PREFIX}replaced-"):
            if _idle(path):
                log.info("%s is what a writer was about to replace when it was killed", path)
        elif _ended(path):
            if path.is_dir():
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink(missing_ok=True)


def _ended(path: Path) -> bool:
    """True if the writer of an unfinished file has ended."""
    machine, _, rest = path.name.removeprefix(PREFIX).partition("-")
    process = rest.partition("-")[0]
    if machine != _machine() or os.name == "nt" or not process.isdigit():
        return _idle(path)
    try:
        os.kill(int(process), 0)
    except ProcessLookupError:
        return True
    except (OSError, OverflowError):
        return False
    return False


def _idle(path: Path) -> bool:
    try:
        return time() - path.lstat().st_mtime > DAY
    except OSError:
        return False


@cache
def _machine() -> str:
    return hashlib.sha256(platform.node().encode()).hexdigest()[:8]
