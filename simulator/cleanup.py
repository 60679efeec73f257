"""Cleanup: what must be done before the process ends, even if a signal ends it.

Python calls the functions of `atexit` only if the main thread leaves its work. It may wait in a
library instead, or be in a task that takes SystemExit for its answer.
"""

from __future__ import annotations

import atexit
import os
import sys
import threading
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NoReturn

LEAVE = 0.4
"""Seconds that cleanup may take at the end of the process."""
_left = threading.Condition()
_blocks = 0
_pending: dict[object, Callable[[], object]] = {}
"""What `end_process` calls first. No lock guards it: a signal may interrupt its owner."""


@contextmanager
def cleanup_block() -> Iterator[None]:
    """A block that a signal never cuts short: the process ends only after the block."""
    global _blocks
    with _left:
        _blocks += 1
    try:
        yield
    finally:
        with _left:
            _blocks -= 1
            _left.notify_all()


def wait_for_cleanup() -> bool:
    """Waits until all cleanup blocks have ended; True if there was one."""
    with _left:
        some = _blocks > 0
        _left.wait_for(lambda: _blocks == 0)
    return some


def before_end_process(key: Hashable, action: Callable[[], object]) -> None:
    """Calls `action` if `end_process` ends the process, once for a key."""
    _pending[key] = action


@contextmanager
def if_ended_within(action: Callable[[], object]) -> Iterator[None]:
    """Calls `action` only if `end_process` ends the process within the block."""
    key = object()
    before_end_process(key, action)
    try:
        yield
    finally:
        del _pending[key]


@contextmanager
def cleanup_after(action: Callable[[], object]) -> Iterator[None]:
    """Calls `action` after the block, or when the process ends within it.

    It may be called twice, in two threads at once.
    """
    atexit.register(action)
    with if_ended_within(action):
        try:
            yield
        finally:
            action()
            atexit.unregister(action)


@contextmanager
def temporary_folder() -> Iterator[Path]:
    """A temporary folder, which is removed after the block or when the process ends."""
    from tempfile import TemporaryDirectory

    folder = TemporaryDirectory(ignore_cleanup_errors=True)
    with cleanup_after(folder.cleanup):
        yield Path(folder.name)


def end_process(code: int) -> NoReturn:
    """Ends the process at once, from any thread; cleanup has LEAVE seconds.

    The functions of `atexit` are not called.
    """
    timer = threading.Timer(LEAVE, os._exit, (code,))
    timer.daemon = True
    timer.start()
    for stream in (sys.stdout, sys.stderr):
        with suppress(Exception):
            stream.flush()
    for action in reversed([*_pending.values()]):
        with suppress(Exception):
            action()
    os._exit(code)
