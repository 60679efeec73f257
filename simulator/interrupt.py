"""Ctrl-C and its like end a command soon, also within a library that hears of it late."""

from __future__ import annotations

import atexit
import os
import signal
import socket
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from time import monotonic
from types import FrameType
from typing import NoReturn

PATIENCE, UNWOUND, LEAVE = 0.8, 1.4, 0.4
"""Seconds from a signal until it must have been heard of, and what is unfinished have ended; and
that what is left to do at exit may take."""
SHOWN_CURSOR = "\x1b[?25h"
"""What gives a terminal its cursor back, which a progress bar had hidden."""
ENDING = f"{__package__}.sweeps.cleanup"
SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK")
"""Ctrl-C; told to end; the terminal is closed or the line to it lost; Ctrl-Break on Windows."""

Handler = Callable[[int, FrameType | None], object] | int | None


class EndSignal(threading.Event):
    """Set by a signal that ends the command."""

    number = int(signal.SIGINT)

    @property
    def code(self) -> int:
        """Exit code of what the signal ends, as shells give it."""
        return 128 + self.number

    def hear(self, number: int, frame: FrameType | None) -> None:
        """Raise KeyboardInterrupt, whatever the signal; a second one only where it is Ctrl-C."""
        if self.is_set() and number != signal.SIGINT:
            return
        self.number = number
        self.set()
        raise KeyboardInterrupt


@contextmanager
def end_on_signals(heard: EndSignal | None = None) -> Iterator[None]:
    """Each of SIGNALS raises KeyboardInterrupt, and ends the process where that takes too long.

    Python raises it between two of its own instructions, which a fit in C may keep waiting for
    minutes, and threads of a fit may keep what unwinds it waiting. Blocks `waited_for` are. What is
    unfinished on disk is removed before such an end. A signal that is ignored or handled otherwise
    stays so. heard: is set by a signal.
    """
    before = _usual()
    if not before or threading.current_thread() is not threading.main_thread():
        yield
        return
    heard, over = heard or EndSignal(), threading.Event()
    ours, theirs = socket.socketpair()
    theirs.setblocking(False)
    woken = signal.set_wakeup_fd(theirs.fileno(), warn_on_full_buffer=False)
    for number in before:
        signal.signal(number, heard.hear)
    threading.Thread(target=_watch, args=(ours, {*before}, heard, over), daemon=True).start()
    try:
        yield
    finally:
        over.set()
        for number, handler in before.items():
            signal.signal(number, handler)
        signal.set_wakeup_fd(woken)
        theirs.close()


def _usual() -> dict[int, Handler]:
    """Those of SIGNALS that this system has and that do what they do by themselves, and what."""
    numbers = [getattr(signal, name) for name in SIGNALS if hasattr(signal, name)]
    usual = (signal.default_int_handler, signal.SIG_DFL)
    handlers = {number: signal.getsignal(number) for number in numbers}
    return {number: handler for number, handler in handlers.items() if handler in usual}


def _watch(signals: socket.socket, ends: set[int], heard: EndSignal, over: threading.Event) -> None:
    """Ends the process where a signal does not end the block; ends itself at the block's end."""
    with signals:
        while number := signals.recv(1):
            if number[0] not in ends:
                continue
            last = monotonic() + UNWOUND
            told = heard.wait(PATIENCE) or over.is_set()
            if ENDING in sys.modules:  # else nothing can be in such a block
                told = sys.modules[ENDING].wait_for_cleanup() or told
            if not (told and over.wait(max(last - monotonic(), LEAVE))):
                with suppress(OSError, ValueError):  # the terminal may be closed
                    cursor = SHOWN_CURSOR if sys.stderr.isatty() else ""
                    sys.stderr.write(f"{cursor}rcskin: interrupted\n")
                leave(128 + number[0])


def leave(code: int) -> NoReturn:
    """End the process; what is left to do at exit is done, if it takes no longer than LEAVE."""
    timer = threading.Timer(LEAVE, os._exit, (code,))
    timer.daemon = True
    timer.start()
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            stream.flush()
    atexit._run_exitfuncs()  # no documented call has this done while the main thread is deaf
    os._exit(code)
