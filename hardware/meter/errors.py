"""How work with a meter fails; every message ends with what to check."""

from __future__ import annotations


class MeterError(RuntimeError):
    """Something between here and the skin failed; told in one line that says what to check."""


class NoConnectionError(MeterError):
    """The resource cannot be opened, or nothing behind it speaks."""


class LostConnectionError(MeterError):
    """A connection that stood is gone, or its answers can no longer be told apart."""


class NoAnswerError(MeterError):
    """No whole answer came in time."""


class GarbledError(MeterError):
    """An answer came that no meter gives to the question."""


class RefusedError(MeterError):
    """The meter took the message for an error and said so in its event register."""


class RestartedError(MeterError):
    """The meter was switched on since it was last asked, so its settings are lost."""


class WrongMeterError(MeterError):
    """What answers is no meter that this driver knows."""


class FailedReadingError(MeterError):
    """A reading that failed, by the meter's own status: there is no number."""


class CorrectionError(MeterError):
    """An open or short correction was not acquired."""


class PressError(MeterError):
    """The skin could not be pressed by the machine that was asked to."""
