"""Exceptions with a message for the user: bad input, failed output, tolerance not reached."""


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
