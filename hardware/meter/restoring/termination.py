"""Orderly end of a command on a signal: the meter's settings are restored first."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from time import monotonic
from types import FrameType
from typing import Any

from ....simulator.safe_text import escaped
from ....simulator.sweeps.cleanup import cleanup_block
from .windows_console import handle_console_close

SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGBREAK")
"""Ctrl-C; terminate; terminal closed or its line lost; Ctrl-\\; Ctrl-Break."""
REPEAT_INTERVAL = 1.0
"""Seconds within which repeated signals count as one (key repeat, shell and terminal)."""
INTERRUPTS_TO_QUIT = 3
"""Number of Ctrl-C that ends the restoring of settings."""
NOT_RESTORED = 3
"""Exit code of a command that did its work and could not restore the meter's settings."""
SHIELDED = (
    "rcskin: the meter's settings are being restored; Ctrl-C {left} more, a second apart, leaves "
    "them changed\n"
)


@dataclass
class Termination:
    """State of the signals that end the running command.

    number: the first signal, or None. latest_signal: time of the latest one, s of `monotonic`.
    shields: number of blocks that no signal leaves. interrupts: number of Ctrl-C within them.
    """

    number: int | None = None
    latest_signal: float = -REPEAT_INTERVAL
    shields: int = 0
    interrupts: int = 0

    def on_signal(self, number: int, frame: FrameType | None, before: Any = None) -> None:
        """Raise the exception that ends the command, unless shielded. before: handler of Ctrl-C."""
        again, self.latest_signal = monotonic() - self.latest_signal < REPEAT_INTERVAL, monotonic()
        if again:
            return
        if self.shields:
            self._count(number)
            return
        self.number = self.number or number
        if number == signal.SIGINT and callable(before):
            before(number, frame)
        raise self.exception_for(number)

    def exception_for(self, number: int) -> BaseException:
        """Exception of a signal: KeyboardInterrupt, or SystemExit with 128 + its number."""
        return KeyboardInterrupt() if number == signal.SIGINT else SystemExit(128 + number)

    def _count(self, number: int) -> None:
        self.interrupts += number == signal.SIGINT
        left = INTERRUPTS_TO_QUIT - self.interrupts
        if left > 0:
            times = f"{left} times" if left > 1 else "once"
            with suppress(OSError):  # os.write: a signal may interrupt a print
                os.write(2, SHIELDED.format(left=times).encode())


_ending = Termination()


def raise_pending_signal() -> None:
    """Raise a signal's exception again, if a library's callback swallowed it.

    Loops that work with a meter call this at each exchange.
    """
    if _ending.number is None or _ending.shields:
        return
    if threading.current_thread() is threading.main_thread():
        raise _ending.exception_for(_ending.number)


@contextmanager
def shielded() -> Iterator[Callable[[], bool]]:
    """Block that no signal ends. Gives a function that is True if the user insists on ending."""
    _ending.shields += 1
    try:
        yield lambda: _ending.interrupts >= INTERRUPTS_TO_QUIT
    finally:
        _ending.shields -= 1


@contextmanager
def orderly_termination() -> Iterator[Callable[[str], None]]:
    """Block that each of SIGNALS ends by one exception, even if a library swallows it.

    An ignored signal stays ignored (`nohup`). Gives a function that prints a warning about settings
    that could not be restored. After such a warning, a block without another failure ends with
    SystemExit(NOT_RESTORED).
    """
    global _ending
    warnings: list[str] = []

    def warn(text: str) -> None:
        warnings.append(text)
        with suppress(OSError, ValueError):  # the terminal may be closed
            print(f"rcskin: {escaped(text)}", file=sys.stderr, flush=True)

    if threading.current_thread() is not threading.main_thread():
        yield warn
        return
    _ending = Termination()
    with _listening(_ending), cleanup_block(), handle_console_close():
        yield warn
    if warnings:
        sys.exit(NOT_RESTORED)


@contextmanager
def _listening(ending: Termination) -> Iterator[None]:
    numbers = [getattr(signal, name) for name in SIGNALS if hasattr(signal, name)]
    before = {number: signal.getsignal(number) for number in numbers}
    heeded = [number for number in numbers if before[number] is not signal.SIG_IGN]
    usual = sys.unraisablehook

    def quiet(unraisable: Any) -> None:
        """Hide a swallowed exception that `raise_pending_signal` will raise again."""
        if unraisable.exc_type not in (KeyboardInterrupt, SystemExit):
            usual(unraisable)

    try:
        sys.unraisablehook = quiet
        for number in heeded:
            signal.signal(number, lambda n, frame: ending.on_signal(n, frame, before[n]))
        yield
    finally:
        for number in heeded:
            signal.signal(number, before[number])
        sys.unraisablehook = usual
        ending.number = None
