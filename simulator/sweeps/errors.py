"""Exceptions with a message for the user, and the names of arguments in such messages."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar


class InputError(ValueError):
    """Bad input; the message names file, key, value and allowed range in one line."""


class OutputError(RuntimeError):
    """An output could not be written although the input is valid; one line says why."""


class ToleranceError(RuntimeError):
    """The requested tolerance was not reached, so there is no answer.

    times: factor by which the tolerance must probably be raised; None if unknown.
    """

    def __init__(self, message: str, times: float | None = None) -> None:
        super().__init__(message)
        self.times = times


class InterruptedWorkError(RuntimeError):
    """Ctrl-C interrupted work that can be resumed; the message says how."""


_options: ContextVar[Mapping[str, str] | None] = ContextVar("options", default=None)


def named(name: str, *, flag: bool = False) -> str:
    """An argument as the caller gave it: `--max-sweeps` if it was typed, else `max_sweeps`.

    flag: True for one that is set to True in Python.
    """
    in_python = f"`{name}=True`" if flag else f"`{name}`"
    return (_options.get() or {}).get(name, in_python)


@contextmanager
def named_as_typed(options: Mapping[str, str]) -> Iterator[None]:
    """Within it messages name the options of a command. options: by the argument's name."""
    token = _options.set(options)
    try:
        yield
    finally:
        _options.reset(token)
