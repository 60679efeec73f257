"""A command that is told to end: what it has begun with a meter is put in order first."""

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

from ...simulator.safe_text import escaped
from ...simulator.sweeps.cleanup import cleanup_block
from .windows_console import handle_console_close

SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGBREAK")
"""Ctrl-C; told to end; the terminal is closed or the line to it lost; Ctrl-\\; Ctrl-Break."""
REPEAT_INTERVAL = 1.0
"""Seconds within which signals are one: a key is held, or a shell and a terminal both send it."""
INTERRUPTS_TO_QUIT = 3
"""Ctrl-C so often while settings are put back: whoever does that wants to get out."""
NOT_RESTORED = 3
"""Exit code of a command that did its work and could not leave the meter as it was found."""
SHIELDED = (
    "rcskin: the meter's settings are being put back; Ctrl-C {left} more, a second apart, leaves "
    "them changed\n"
)


@dataclass
class Termination:
    """What has told the command under way to end.

    number: the first signal, None before. heard: when the latest came, s of `monotonic`. shields:
    blocks that no signal leaves. insisted: how often Ctrl-C was pressed within them.
    """

    number: int | None = None
    latest_signal: float = -REPEAT_INTERVAL
    shields: int = 0
    interrupts: int = 0

    def on_signal(self, number: int, frame: FrameType | None, before: Any = None) -> None:
        """Raise what ends the command, unless it is shielded. before: the handler of Ctrl-C."""
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
        """What a signal raises: SystemExit with the code of shells, 128 + its number."""
        return KeyboardInterrupt() if number == signal.SIGINT else SystemExit(128 + number)

    def _count(self, number: int) -> None:
        self.interrupts += number == signal.SIGINT
        left = INTERRUPTS_TO_QUIT - self.interrupts
        if left > 0:
            times = f"{left} times" if left > 1 else "once"
            with suppress(OSError):  # no print: a signal may come in the midst of another one
                os.write(2, SHIELDED.format(left=times).encode())


_ending = Termination()


def raise_pending_signal() -> None:
    """Raise anew what a signal has raised and a callback of a library has swallowed.

    Loops that work with a meter call this with each exchange.
    """
    if _ending.number is None or _ending.shields:
        return
    if threading.current_thread() is threading.main_thread():
        raise _ending.exception_for(_ending.number)


@contextmanager
def shielded() -> Iterator[Callable[[], bool]]:
    """A block that no signal leaves. Gives a function: whether a user insists on getting out."""
    _ending.shields += 1
    try:
        yield lambda: _ending.interrupts >= INTERRUPTS_TO_QUIT
    finally:
        _ending.shields -= 1


@contextmanager
def orderly_termination() -> Iterator[Callable[[str], None]]:
    """Each of SIGNALS leaves the block by an exception, once, however a library treats it.

    A signal that is ignored stays so (`nohup`). The block is left in its own time. Gives a function
    that tells on the terminal what could not be put back; where that was called and all else went
    well, the block ends with SystemExit(NOT_AS_FOUND).
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
        """What ends the command and was swallowed is raised anew, which `look` does."""
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
