"""Keys as they are pressed, without Enter, where a terminal gives them."""

from __future__ import annotations

import atexit
import os
import select
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from importlib import import_module
from typing import Any

PREFIXES = ("\0", "\xe0")
"""Of the arrow and function keys, as `msvcrt.getwch` gives them."""


@contextmanager
def keys() -> Iterator[Callable[[], str]]:
    """A function that tells the last key pressed since it was asked before, empty where none was.

    The terminal is as before at the block's end. Without a terminal no key is ever pressed.
    """
    if not sys.stdin.isatty():
        yield lambda: ""
        return
    try:
        import termios
        import tty
    except ImportError:  # Windows
        yield partial(_last_of_console, import_module("msvcrt"))
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


def _last_of_console(msvcrt: Any) -> str:
    """The same on Windows, where a key without a letter is a prefix and a code."""
    last = ""
    while msvcrt.kbhit():
        last = msvcrt.getwch()
        if last in PREFIXES:
            msvcrt.getwch()
    return "" if last in PREFIXES else last.lower()


def _last(terminal: int) -> str:
    if not select.select([terminal], [], [], 0)[0]:
        return ""
    return os.read(terminal, 1024).decode(errors="replace")[-1:].lower()
