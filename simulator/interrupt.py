"""Ctrl-C ends a command soon, also within a library that does not hear of it for long."""

from __future__ import annotations

import atexit
import os
import signal
import socket
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

PATIENCE, LEAVE = 0.8, 0.4
"""Seconds until a Ctrl-C must have been heard of, and that an end may take where it was not."""
SHOWN_CURSOR = "\x1b[?25h"
"""What gives a terminal its cursor back, which a progress bar had hidden."""
INTERRUPTED = 130
"""Exit code of what Ctrl-C ends."""


@contextmanager
def ending_soon() -> Iterator[None]:
    """Ctrl-C raises KeyboardInterrupt or, where that is not raised in PATIENCE, ends the process.

    Python raises it between two of its own instructions, which a fit in C may keep waiting for
    minutes. What is unfinished on disk is removed before such an end.
    """
    usual = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if not usual or threading.current_thread() is not threading.main_thread():
        yield
        return
    heard = threading.Event()

    def interrupt(number: int, frame: object) -> None:
        heard.set()
        raise KeyboardInterrupt

    ours, theirs = socket.socketpair()
    theirs.setblocking(False)
    before = signal.set_wakeup_fd(theirs.fileno(), warn_on_full_buffer=False)
    signal.signal(signal.SIGINT, interrupt)
    threading.Thread(target=_watch, args=(ours, heard), daemon=True).start()
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.set_wakeup_fd(before)
        theirs.close()


def _watch(signals: socket.socket, heard: threading.Event) -> None:
    """Ends the process where it does not hear of a Ctrl-C; ends itself at the block's end."""
    with signals:
        while number := signals.recv(1):
            if number[0] == signal.SIGINT and not heard.wait(PATIENCE):
                _end()


def _end() -> None:
    """What is left to do at exit is done, if it takes no longer than LEAVE."""
    timer = threading.Timer(LEAVE, os._exit, (INTERRUPTED,))
    timer.daemon = True
    timer.start()
    sys.stderr.write((SHOWN_CURSOR if sys.stderr.isatty() else "") + "rcskin: interrupted\n")
    sys.stderr.flush()
    atexit._run_exitfuncs()
    os._exit(INTERRUPTED)
