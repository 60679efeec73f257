"""What a command that is told to end still has to put in order, such as a meter."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Condition

_left = Condition()
_blocks = 0


@contextmanager
def cleanup_block() -> Iterator[None]:
    """A block that Ctrl-C leaves in its own time, however long what is unfinished takes to end."""
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
    """Until all such blocks are left; whether there was one."""
    with _left:
        some = _blocks > 0
        _left.wait_for(lambda: _blocks == 0)
    return some
