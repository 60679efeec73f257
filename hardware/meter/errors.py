"""Errors of meters. Every message ends with what to check."""

from __future__ import annotations


class MeterError(RuntimeError):
    """Something between computer and skin failed. The message is one line."""


class NoConnectionError(MeterError):
    """The resource cannot be opened, or nothing answers there."""


class LostConnectionError(MeterError):
    """An open connection is lost, or its answers no longer fit the queries."""


class NoAnswerError(MeterError):
    """No whole answer came in time."""


class GarbledError(MeterError):
    """The answer is not one that a meter gives to the query."""


class RefusedError(MeterError):
    """The meter refused the message, as its event register says."""


class RestartedError(MeterError):
    """The meter's settings are not those of before: it was switched on, or someone changed one."""


class WrongMeterError(MeterError):
    """The instrument that answers is no meter of this driver, or another one than before."""


class FailedReadingError(MeterError):
    """The meter's status says that the reading failed; there is no number."""


class CorrectionError(MeterError):
    """An open or short correction was not acquired."""


class PressError(MeterError):
    """The machine could not press the skin."""


def changed_setting(resource: str, name: str, now: object, before: object) -> RestartedError:
    """Error about a setting that is not what it was."""
    return RestartedError(
        f"{resource}: `{name}` is {now} and was {before}; check whether the meter lost its "
        "settings, or someone changed them on its panel or by another program"
    )
