"""Pressed keys of a terminal, without Enter."""

from __future__ import annotations

import os
import select
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from ....simulator.cleanup import cleanup_after

PREFIXES = ("\0", "\xe0")
"""First character of arrow and function keys, as `msvcrt.getwch` gives them."""


@contextmanager
def key_reader() -> Iterator[Callable[[], str]]:
    """Gives a function that returns the last key since its last call, or an empty string.

    The end of the block restores the terminal. Without a terminal the function always returns "".
    """
    if not sys.stdin.isatty():
        yield lambda: ""
        return
    if sys.platform == "win32" or find_spec("termios") is None:
        yield partial(_last_console_key, import_module("msvcrt"))
        return
    import termios
    import tty

    terminal = sys.stdin.fileno()
    before = termios.tcgetattr(terminal)

    def restore() -> None:
        with suppress(termios.error):  # the terminal is gone
            termios.tcsetattr(terminal, termios.TCSADRAIN, before)

    with cleanup_after(restore):
        tty.setcbreak(terminal)
        yield lambda: _last_key(terminal)


def _last_console_key(msvcrt: Any) -> str:
    """Last key on Windows, where a key without a letter is a prefix and a code."""
    last = ""
    while msvcrt.kbhit():
        last = msvcrt.getwch()
        if last in PREFIXES:
            msvcrt.getwch()
    return "" if last in PREFIXES else last.lower()


def _last_key(terminal: int) -> str:
    if not select.select([terminal], [], [], 0)[0]:
        return ""
    with suppress(OSError):  # the terminal is gone
        return os.read(terminal, 1024).decode(errors="replace")[-1:].lower()
    return ""
