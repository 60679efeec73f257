"""Reaction to the closing of a Windows console while a command works with a meter."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

CLOSING_EVENTS = (2, 5, 6)
"""CTRL_CLOSE_EVENT, CTRL_LOGOFF_EVENT, CTRL_SHUTDOWN_EVENT of HandlerRoutine
(https://learn.microsoft.com/windows/console/handlerroutine)."""
GRACE_PERIOD = 4.5
"""Seconds. Windows ends the process when the handler returns, at most 5 s after its call."""


@contextmanager
def handle_console_close() -> Iterator[None]:
    """Turn the closing of the console into SIGBREAK; the block then has GRACE_PERIOD s to end.

    On other systems a closed terminal sends SIGHUP, and this function does nothing.
    """
    if sys.platform != "win32":
        yield
        return
    import ctypes
    from _thread import interrupt_main

    ended = threading.Event()

    @ctypes.WINFUNCTYPE(ctypes.c_int, ctypes.c_uint)
    def closed(event: int) -> int:
        if event not in CLOSING_EVENTS:
            return 0  # Ctrl-C and Ctrl-Break are signals already
        interrupt_main(signal.SIGBREAK)
        ended.wait(GRACE_PERIOD)
        return 1

    kernel = ctypes.windll.kernel32
    kernel.SetConsoleCtrlHandler(closed, 1)
    try:
        yield
    finally:
        kernel.SetConsoleCtrlHandler(closed, 0)
        ended.set()
