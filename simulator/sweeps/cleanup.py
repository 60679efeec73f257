"""Cleanup that a command must finish before a signal may end it, such as resetting a meter."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Condition

_left = Condition()
_blocks = 0


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
