"""How a switch fails; every message ends with what to check."""

from __future__ import annotations

from ..meter.errors import MeterError


class SwitchError(MeterError):
    """The switch between meter and skin failed; told in one line that says what to check."""


class NoSwitchError(SwitchError):
    """The switch cannot be reached, or is gone."""


class SilentSwitchError(SwitchError):
    """No whole answer came in time."""


class GarbledSwitchError(SwitchError):
    """An answer came that no such switch gives."""


class RefusedSwitchError(SwitchError):
    """The switch would not do what it was asked."""


class StuckSwitchError(SwitchError):
    """The switch tells another position than the one asked for."""
