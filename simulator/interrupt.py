"""Ctrl-C ends a command soon, also within a library that does not hear of it for long."""

from __future__ import annotations

import atexit
import os
import signal
import socket
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from time import monotonic
from typing import NoReturn

PATIENCE, UNWOUND, LEAVE = 0.8, 1.4, 0.4
"""Seconds from a Ctrl-C until it must have been heard of, and what is unfinished have ended; and
that what is left to do at exit may take."""
SHOWN_CURSOR = "\x1b[?25h"
"""What gives a terminal its cursor back, which a progress bar had hidden."""
ENDING = f"{__package__}.sweeps.ending"
INTERRUPTED = 130
"""Exit code of what Ctrl-C ends."""


@contextmanager
def ending_soon(heard: threading.Event | None = None) -> Iterator[None]:
    """Ctrl-C raises KeyboardInterrupt; it ends the process where that takes too long.

    Python raises it between two of its own instructions, which a fit in C may keep waiting for
    minutes, and threads of a fit may keep what unwinds it waiting. Blocks `waited_for` are. What is
    unfinished on disk is removed before such an end. heard: is set by a Ctrl-C.
    """
    usual = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if not usual or threading.current_thread() is not threading.main_thread():
        yield
        return
    heard, over = heard or threading.Event(), threading.Event()

    def interrupt(number: int, frame: object) -> None:
        heard.set()
        raise KeyboardInterrupt

    ours, theirs = socket.socketpair()
    theirs.setblocking(False)
    before = signal.set_wakeup_fd(theirs.fileno(), warn_on_full_buffer=False)
    signal.signal(signal.SIGINT, interrupt)
    threading.Thread(target=_watch, args=(ours, heard, over), daemon=True).start()
    try:
        yield
    finally:
        over.set()
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.set_wakeup_fd(before)
        theirs.close()


def _watch(signals: socket.socket, heard: threading.Event, over: threading.Event) -> None:
    """Ends the process where a Ctrl-C does not end the block; ends itself at the block's end."""
    with signals:
        while number := signals.recv(1):
            if number[0] != signal.SIGINT:
                continue
            last = monotonic() + UNWOUND
            told = heard.wait(PATIENCE)
            if ENDING in sys.modules:  # else nothing can be in such a block
                told = sys.modules[ENDING].wait() or told
            if not (told and over.wait(max(last - monotonic(), LEAVE))):
                cursor = SHOWN_CURSOR if sys.stderr.isatty() else ""
                sys.stderr.write(f"{cursor}rcskin: interrupted\n")
                leave(INTERRUPTED)


def leave(code: int) -> NoReturn:
    """End the process; what is left to do at exit is done, if it takes no longer than LEAVE."""
    timer = threading.Timer(LEAVE, os._exit, (code,))
    timer.daemon = True
    timer.start()
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            stream.flush()
    atexit._run_exitfuncs()
    os._exit(code)
