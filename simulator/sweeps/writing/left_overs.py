"""What killed writers leave: cleared where they ran on this machine, named where they may run."""

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
"""s without a change, after which an unfinished file is nobody's whose writer cannot be asked."""

log = logging.getLogger(__name__)


def own_mark() -> str:
    """How the names of this process's unfinished files begin: with machine and process."""
    return f"{PREFIX}{_machine()}-{os.getpid()}-"


def clear_left_overs(folder: Path) -> None:
    """Delete unfinished files of writers that have ended; name what was about to be replaced.

    folder: in which something is about to be written.
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
    """Whether the writer of an unfinished file is at work no more."""
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
