"""Text of a reading as Hioki's meters answer it to `:MEASure?`."""

from __future__ import annotations

import math

from ..language import engineering
from ..measurement import UNDERFLOW, WITHOUT_NUMBERS, MeasurementResult, quantity
from .meter_state import ITEMS, Settings

OVER, UNDER = " 999999E+28", "-999999E+28"
DECIMALS = {"PHASE": 3, "Q": 3, "D": 6}


def measurement_text(result: MeasurementResult, settings: Settings) -> str:
    """Answer to `:MEASure?` in the form that `:MEASure:VALid` and `:MEASure:ITEM` set."""
    parts = [str(result.status)] if settings.valid & 16 else []
    if settings.valid & 2:
        parts += [_value(result, name) for name in requested_quantities(settings)]
    if settings.valid & 1:
        parts.append("0")
    return ",".join(parts)


def requested_quantities(settings: Settings) -> list[str]:
    """Names in the order of the registers; the displayed pair if both registers are 0."""
    if settings.items == (0, 0):
        return [name for name in settings.parameters if name != "OFF"]
    return [
        name
        for register, names in zip(settings.items, ITEMS, strict=True)
        for bit, name in enumerate(names)
        if register >> bit & 1
    ]


def _value(result: MeasurementResult, name: str) -> str:
    if result.status == UNDERFLOW:
        return UNDER
    if result.status in WITHOUT_NUMBERS:
        return OVER
    return measured_text(quantity(name, result.Z, result.conditions.frequency), DECIMALS.get(name))


def measured_text(value: float, decimals: int | None = None) -> str:
    """A measured value after a space or a minus: six digits, or `decimals` (phase, Q, D).

    A value beyond any display is written as overflow.
    """
    if not (math.isfinite(value) and abs(value) < 1e30):
        return OVER
    if decimals is not None:
        return f"{value: 8.{decimals}f}"
    text = engineering(value, 6)
    return text if text.startswith("-") else f" {text}"
