"""Keys as they are pressed, without Enter, where a terminal gives them."""

from __future__ import annotations

import os
import select
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager


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
    try:
        tty.setcbreak(terminal)
        yield lambda: _last(terminal)
    finally:
        termios.tcsetattr(terminal, termios.TCSADRAIN, before)


def _last(terminal: int) -> str:
    if not select.select([terminal], [], [], 0)[0]:
        return ""
    return os.read(terminal, 1024).decode(errors="replace")[-1:].lower()
