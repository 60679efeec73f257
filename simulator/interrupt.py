"""Ctrl-C and similar signals end a command soon, even inside a library that reacts late."""

from __future__ import annotations

import signal
import socket
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from time import monotonic
from types import FrameType

from .cleanup import LEAVE, end_process, wait_for_cleanup

PATIENCE, UNWOUND = 0.8, 1.4
"""Seconds from a signal until Python must have raised it, and until the block must have ended."""
SHOW_CURSOR = "\x1b[?25h"
"""Escape sequence that shows the cursor again after a progress bar has hidden it."""
SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGBREAK")
"""Ctrl-C; request to end; closed terminal or lost connection; Ctrl-\\; Ctrl-Break on Windows."""

Handler = Callable[[int, FrameType | None], object] | int | None


class EndSignal(threading.Event):
    """Set by a signal that ends the command."""

    number = int(signal.SIGINT)

    @property
    def code(self) -> int:
        """Exit code of a command ended by the signal, as shells define it."""
        return 128 + self.number

    def receive(self, number: int, frame: FrameType | None) -> None:
        """Raises KeyboardInterrupt for any signal; a second signal counts only if it is Ctrl-C."""
        if self.is_set() and number != signal.SIGINT:
            return
        self.number = number
        self.set()
        raise KeyboardInterrupt


@contextmanager
def end_on_signals(received: EndSignal | None = None) -> Iterator[None]:
    """Makes each of SIGNALS raise KeyboardInterrupt in the block, or end the process if it is late.

    Python raises the exception between two of its own instructions. A fit in C may delay that for
    minutes, and threads of a fit may delay the unwinding. Cleanup blocks are always waited for.
    Unfinished files are removed before the process ends. Signals that are ignored or handled
    otherwise stay so. received: is set by a signal.
    """
    before = _default_handlers()
    if not before or threading.current_thread() is not threading.main_thread():
        yield
        return
    received, over = received or EndSignal(), threading.Event()
    ours, theirs = socket.socketpair()
    theirs.setblocking(False)
    woken = signal.set_wakeup_fd(theirs.fileno(), warn_on_full_buffer=False)
    for number in before:
        signal.signal(number, received.receive)
    threading.Thread(target=_watch, args=(ours, {*before}, received, over), daemon=True).start()
    try:
        yield
    finally:
        over.set()
        for number, handler in before.items():
            signal.signal(number, handler)
        signal.set_wakeup_fd(woken)
        theirs.close()


def _default_handlers() -> dict[int, Handler]:
    """The signals of SIGNALS with their default handler on this system, and that handler."""
    numbers = [getattr(signal, name) for name in SIGNALS if hasattr(signal, name)]
    defaults = (signal.default_int_handler, signal.SIG_DFL)
    handlers = {number: signal.getsignal(number) for number in numbers}
    return {number: handler for number, handler in handlers.items() if handler in defaults}


def _watch(
    signals: socket.socket, ends: set[int], received: EndSignal, over: threading.Event
) -> None:
    """Watchdog thread: ends the process if a signal does not end the block in time."""
    with signals:
        while number := signals.recv(1):
            if number[0] not in ends:
                continue
            last = monotonic() + UNWOUND
            ended = received.wait(PATIENCE / 2) or over.is_set()
            if not ended:
                _send_again(number[0])
                ended = received.wait(PATIENCE / 2) or over.is_set()
            ended = wait_for_cleanup() or ended
            if not (ended and over.wait(max(last - monotonic(), LEAVE))):
                with suppress(OSError, ValueError):  # the terminal may be closed
                    cursor = SHOW_CURSOR if sys.stderr.isatty() else ""
                    sys.stderr.write(f"{cursor}rcskin: interrupted\n")
                end_process(128 + number[0])


def _send_again(number: int) -> None:
    """Sends a signal to the main thread, whose call may have begun to wait just after the first.

    Python handles a signal once a call returns; a signal ends only a call that waits already.
    """
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(threading.main_thread().ident or 0, number)
