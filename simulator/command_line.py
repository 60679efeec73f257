"""Runs the command line. Exit codes: 0 success, 2 bad input, 1 any other failure."""

from __future__ import annotations

import errno
import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NoReturn, TextIO

import typer

from .cleanup import end_process
from .interrupt import EndSignal, end_on_signals
from .requests.console import show_log_as_notes
from .requests.mistyped import mistyped
from .safe_text import say

BAD_INPUT, FAILURE = 2, 1
OUT_OF_MEMORY = (
    "this machine has too little memory for this work: use fewer pixels, frequencies, sweeps or "
    "processes"
)

OUT_OF_RANGE = (
    "the numbers of the scene or of the options lie too far apart for double precision: "
    "bring sizes, resistances, capacitances and frequencies nearer to those of a skin "
    "(RCSKIN_DEBUG=1 shows where)"
)

OF_NUMBERS = ("math domain error", "cannot convert float NaN to integer")
"""Messages of ValueErrors that Python raises for numbers, not for wrong input."""


def run(app: typer.Typer, failures: tuple[type[Exception], ...] = ()) -> None:
    """Runs the command line; every failure becomes one clear line and an exit code.

    failures: further exception types whose message is complete as it is.
    """
    guarded = _guard_streams()
    os.environ["MPLBACKEND"] = "agg"  # charts go to files only
    show_log_as_notes("rcskin")
    heard = EndSignal()
    try:
        _run(app, failures, heard)
    except SystemExit as end:
        for each in guarded:
            each.failure = None  # it was reported
        if heard.is_set():  # libraries' threads may keep or break the usual end
            end_process(heard.code)
        if not end.code and any(each.lost for each in guarded):
            sys.exit(FAILURE)
        raise


class _StandardStream(io.TextIOWrapper):
    """Standard output or standard error, with letters that a terminal lacks as escapes.

    After a failure the rest goes nowhere; a closed terminal is no failure. ends_work: True if
    writing then raises BrokenPipeError or OutputError, also later, in case a library hides it.
    lost: True if the device did not take what was written.
    """

    failure: Exception | None = None
    lost = False

    def __init__(self, stream: TextIO, ends_work: bool) -> None:
        super().__init__(
            stream.buffer,
            stream.encoding,
            "backslashreplace",
            line_buffering=bool(stream.line_buffering),
            write_through=True,
        )
        self._stream = stream  # which closes its buffer when nothing refers to it
        self._terminal, self._ends_work = stream.isatty(), ends_work

    def write(self, text: str, /) -> int:
        """Write the text, or drop it."""
        with self._failing():
            super().write(text)
        return len(text)

    def flush(self) -> None:
        """Flush what was written, or drop it."""
        with self._failing():
            super().flush()

    def close(self) -> None:
        """Leave the stream open: it belongs to whoever made it, also if nothing refers to this."""

    @contextmanager
    def _failing(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self.fileno())
            os.close(nowhere)
            if not (self._terminal and error.errno == errno.EIO):
                self.lost = error.errno not in (errno.EPIPE, errno.EBADF)
                self.failure = _output_failure(error) if self._ends_work else None
        if self.failure:
            raise self.failure


def _output_failure(error: OSError) -> Exception:
    """Exception that ends a command whose standard output cannot be written."""
    from .sweeps.errors import OutputError
    from .sweeps.writing import DISKS

    if error.errno == errno.EPIPE:
        return error
    reason = "it is closed" if error.errno == errno.EBADF else error.strerror
    return OutputError(f"standard output: cannot be written: {DISKS.get(error.errno or 0, reason)}")


def _guard_streams() -> list[_StandardStream]:
    """Replace standard output and standard error by streams whose failures end in order.

    A closed one is opened so that each write fails: otherwise the next file would get its number.
    Streams of a host program that lead to no file stay as they are.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDONLY)
    sys.stdin = sys.stdin or open(0, closefd=False)
    guarded = []
    for number, name in enumerate(("stdout", "stderr"), 1):
        stream = getattr(sys, name) or open(number, "w", closefd=False)
        if hasattr(stream, "buffer"):
            guarded.append(_StandardStream(stream, ends_work=name == "stdout"))
            setattr(sys, name, guarded[-1])
    return guarded


def _run(app: typer.Typer, failures: tuple[type[Exception], ...], received: EndSignal) -> NoReturn:
    try:
        with end_on_signals(received):
            code = app(standalone_mode=False)
            sys.stdout.flush()
    except typer.TyperException as error:
        if _is_help(error):  # a group of commands without a command
            say(*error.format_message().splitlines(), err=True)
            sys.exit(BAD_INPUT)
        _end(error.format_message() + _hint(error), BAD_INPUT)
    except (KeyboardInterrupt, typer.Abort):
        _end("interrupted", received.code)
    except BrokenPipeError:
        sys.exit(FAILURE)
    except failures as error:
        _end(str(error), FAILURE)
    except Exception as error:
        _end_by_error(error, received)
    if code == EndSignal().code:  # typer returns this code for Ctrl-C
        _end("interrupted", received.code)
    sys.exit(code or 0)


def _end_by_error(error: Exception, received: EndSignal) -> NoReturn:
    """Ends the process for an error of the work; imports here cost nothing in the normal case."""
    from .sweeps.errors import InputError, InterruptedWorkError, OutputError, ToleranceError

    match error:
        case InputError():
            _end(str(error), BAD_INPUT)
        case OutputError():
            _end(str(error), FAILURE)
        case MemoryError():
            _end(OUT_OF_MEMORY, FAILURE)
        case _ if _is_of_numbers(error) and "RCSKIN_DEBUG" not in os.environ:
            _end(OUT_OF_RANGE, FAILURE)
        case ToleranceError(times=None):
            _end(f"{error}; a larger --rtol can be reached", FAILURE)
        case ToleranceError(times=times):
            _end(f"{error}; {times:.1g} times that --rtol can be reached", FAILURE)
        case InterruptedWorkError():
            _end(f"interrupted; {error}", received.code)
    if "RCSKIN_DEBUG" in os.environ:
        raise error
    _end(f"{error} ({type(error).__name__}; RCSKIN_DEBUG=1 shows where)", FAILURE)


def _is_of_numbers(error: Exception) -> bool:
    """True for errors of arithmetic with numbers beyond its range."""
    from numpy.linalg import LinAlgError

    numeric = isinstance(error, ArithmeticError | RecursionError | LinAlgError)
    return numeric or (type(error) is ValueError and str(error) in OF_NUMBERS)


def _is_help(error: typer.TyperException) -> bool:
    return error.format_message().startswith("Usage: ")


def _hint(error: typer.TyperException) -> str:
    """What was likely meant; the example of the command if an argument is missing or too many."""
    if meant := mistyped(error):
        return f"{_full_stop(error)} {meant}"
    context = getattr(error, "ctx", None)
    example = context.command.epilog if context is not None else None
    of_arguments = error.format_message().startswith(("Missing ", "Got unexpected extra "))
    return f"{_full_stop(error)} {example}" if of_arguments and example else ""


def _full_stop(error: typer.TyperException) -> str:
    return "" if error.format_message().endswith(".") else "."


def _end(message: str, code: int) -> NoReturn:
    if message:
        say(f"rcskin: {' '.join(message.split())}", err=True)
    sys.exit(code)
