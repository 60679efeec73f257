"""Keys as they are pressed, without Enter, where a terminal gives them."""

from __future__ import annotations

import atexit
import os
import select
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial


@contextmanager
def keys() -> Iterator[Callable[[], str]]:
    """A function that tells the last key pressed since it was asked before, empty where none was.

    The terminal is as before at the block's end. Without a terminal, or where the system has none
    of its kind, no key is ever pressed.
    """
    try:
        import termios
        import tty
    except ImportError:
        yield lambda: ""
        return
    if not sys.stdin.isatty():
        yield lambda: ""
        return
    terminal = sys.stdin.fileno()
    before = termios.tcgetattr(terminal)
    restore = partial(termios.tcsetattr, terminal, termios.TCSADRAIN, before)
    atexit.register(restore)  # where the block is not left, the process being ended by force
    try:
        tty.setcbreak(terminal)
        yield lambda: _last(terminal)
    finally:
        restore()
        atexit.unregister(restore)


def _last(terminal: int) -> str:
    if not select.select([terminal], [], [], 0)[0]:
        return ""
    return os.read(terminal, 1024).decode(errors="replace")[-1:].lower()
