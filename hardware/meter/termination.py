"""Orderly end of a command on a signal: the meter's settings are restored first."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from time import monotonic
from types import FrameType
from typing import Any

from ...simulator.cleanup import cleanup_block
from ...simulator.safe_text import say

SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGBREAK")
"""Ctrl-C; terminate; terminal closed or its line lost; Ctrl-\\; Ctrl-Break."""
REPEAT_INTERVAL = 1.0
"""Seconds within which repeated signals count as one (key repeat, shell and terminal)."""
INTERRUPTS_TO_QUIT = 3
"""Number of Ctrl-C that ends the restoring of settings."""
NOT_RESTORED = 3
"""Exit code of a command that did its work and could not restore the meter's settings."""


@dataclass
class Termination:
    """Signals that end the running command, and the block `with interruptible()` that they end.

    A signal raises an exception only within that block, and at most one: nothing interrupts what
    the command does before and after it, such as restoring the meter.

    number: the first signal, or None. pending: True if its exception is still to be raised.
    at_work: True within the block, until a signal ends it. latest_signal: its time, s of
    `monotonic`. interrupts: number of Ctrl-C outside the block.
    """

    number: int | None = None
    pending: bool = False
    at_work: bool = False
    latest_signal: float = -REPEAT_INTERVAL
    interrupts: int = 0

    def __enter__(self) -> None:
        self.at_work = True

    def __exit__(self, *_: object) -> None:
        self.at_work = False  # or the signal that came first has done so

    def on_signal(self, number: int, frame: FrameType | None = None, before: Any = None) -> None:
        """Raise the exception of a signal, or note it. before: handler, which learns the first."""
        again, self.latest_signal = monotonic() - self.latest_signal < REPEAT_INTERVAL, monotonic()
        if again:
            return
        self.interrupts += number == signal.SIGINT and not self.at_work
        self.pending |= self.at_work or self.number is None
        if self.number is None:
            self.number = number
            if callable(before):
                with suppress(KeyboardInterrupt):
                    before(number, frame)
        self.raise_pending()

    def raise_pending(self) -> None:
        """Raise the exception that a signal noted; the block then ends."""
        if self.pending and self.at_work:
            self.pending = self.at_work = False
            raise self.exception

    @property
    def exception(self) -> BaseException:
        """Exception of the first signal: KeyboardInterrupt, or SystemExit with 128 + its number."""
        code = 128 + (self.number or 0)
        return KeyboardInterrupt() if self.number == signal.SIGINT else SystemExit(code)


_ending = Termination()


def interruptible() -> Termination:
    """Block that a signal ends: `with station, interruptible(): ...`."""
    return _ending


@contextmanager
def shielded() -> Iterator[None]:
    """Block in which no signal raises, except in an `interruptible` one within it."""
    before, _ending.at_work = _ending.at_work, False
    yield
    _ending.at_work = before  # unless an error ends the outer block, too


def raise_pending_signal() -> None:
    """Raise the exception of a signal that came in a shield or that a library swallowed.

    Loops that work with a meter call this at each exchange.
    """
    if threading.current_thread() is threading.main_thread():
        _ending.raise_pending()


def interrupts_to_quit() -> int:
    """Number of Ctrl-C that still end the restoring of settings."""
    return INTERRUPTS_TO_QUIT - _ending.interrupts


@contextmanager
def orderly_termination() -> Iterator[Callable[[str], None]]:
    """Block that each of SIGNALS ends in order, by one exception in its `interruptible` blocks.

    A signal that comes only while the meter is restored raises its exception at the end. An ignored
    signal stays ignored (`nohup`). Gives a function that prints a warning about settings that could
    not be restored; after one, a block without another failure ends with SystemExit(NOT_RESTORED).
    """
    global _ending
    warnings: list[str] = []

    def warn(text: str) -> None:
        warnings.append(text)
        say(f"rcskin: {text}", err=True)

    if threading.current_thread() is not threading.main_thread():
        yield warn
        return
    _ending = ending = Termination()
    try:
        with _listening(ending), cleanup_block(), handle_console_close():
            yield warn
    finally:
        _ending = Termination()
    if ending.pending:
        raise ending.exception
    if warnings:
        sys.exit(NOT_RESTORED)


@contextmanager
def _listening(ending: Termination) -> Iterator[None]:
    numbers = [getattr(signal, name) for name in SIGNALS if hasattr(signal, name)]
    before = {number: signal.getsignal(number) for number in numbers}
    heeded = [number for number in numbers if before[number] is not signal.SIG_IGN]
    usual = sys.unraisablehook

    def on_unraisable(unraisable: Any) -> None:
        """Note the exception of a signal again, if Python let it out of no callback."""
        if unraisable.exc_type in (KeyboardInterrupt, SystemExit):
            ending.pending = ending.at_work = True
        else:
            usual(unraisable)

    try:
        sys.unraisablehook = on_unraisable
        for number in heeded:
            signal.signal(number, lambda n, frame: ending.on_signal(n, frame, before[n]))
        yield
    finally:
        for number in heeded:
            signal.signal(number, before[number])
        sys.unraisablehook = usual


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
