"""Errors of switches. Every message ends with what to check."""

from __future__ import annotations

from ..meter.errors import MeterError


class SwitchError(MeterError):
    """The switch between meter and skin failed. The message is one line."""


class NoSwitchError(SwitchError):
    """The switch cannot be opened, or its connection is lost."""


class SilentSwitchError(SwitchError):
    """The switch gave no complete answer in time."""


class GarbledSwitchError(SwitchError):
    """The answer is not one that such a switch gives."""


class RefusedSwitchError(SwitchError):
    """The switch refused a command."""


class StuckSwitchError(SwitchError):
    """The switch reports another position than the requested one."""
