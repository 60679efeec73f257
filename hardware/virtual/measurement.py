"""One reading of the virtual meter: from the skin's impedance to a status and numbers."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..meter.accuracy_table import AccuracyTable, GeneratorLevel, ReadingConditions, full_scale
from .language import values as numbers
from .meter_state import Settings

if TYPE_CHECKING:
    from ...simulator.measure.specimen import Specimen
    from .recorded_skin import RecordedSkin

    Skin = Specimen | RecordedSkin

Readout = Callable[[complex, ReadingConditions], complex]
"""Displayed impedance for a true one, ohm, with the errors of the session and the reading."""
NORMAL, NOT_MEASURED, OUTSIDE_GUARANTEE, OVERFLOW, UNDERFLOW = 0, 1, 2, 7, -7
WITHOUT_NUMBERS = {1, 7, 9, *range(12, 18)}
ITEMS = (
    ("Z", "Y", "PHASE", "CS", "CP", "D", "LS", "LP"),
    ("Q", "RS", "G", "RP", "X", "B", "RDC"),
)
PARAMETERS = ("OFF", *ITEMS[0], *ITEMS[1])
DECIMALS = {"PHASE": 3, "Q": 3, "D": 6}


@dataclass(frozen=True)
class MeasurementResult:
    """Result of a measurement. Z: as measured, ohm. conditions: with the range that was used."""

    status: int
    Z: complex
    conditions: ReadingConditions


NO_RESULT = MeasurementResult(NOT_MEASURED, 0j, ReadingConditions(1e3, 6))


@dataclass(frozen=True)
class MeasurementSetup:
    """Inputs of a measurement: the skin, the readout and the accuracy table."""

    skin: Skin
    readout: Readout
    accuracy: AccuracyTable

    def measure(self, press: Any, settings: Settings) -> MeasurementResult:
        """Measure under a press, given as the skin's `momentary` does.

        Raises the skin's errors; ValueError if Z is not finite.
        """
        Z = self.skin.impedance(press, settings.frequency)
        if not cmath.isfinite(Z):
            raise ValueError(f"the skin's impedance is {Z} at {settings.frequency:g} Hz")
        used = self.accuracy.fitting_range(Z) if settings.auto_range else settings.range
        used_conditions = conditions(settings, used, Z)
        shown = self.readout(Z, used_conditions)
        return MeasurementResult(self._status(shown, used_conditions), shown, used_conditions)

    def _status(self, Z: complex, used_conditions: ReadingConditions) -> int:
        low, high = self.accuracy.span.displayed
        size = abs(Z) / full_scale(used_conditions.range)
        if size > high:
            return OVERFLOW
        if size < low:
            return UNDERFLOW
        return (
            OUTSIDE_GUARANTEE if self.accuracy.is_outside_guarantee(Z, used_conditions) else NORMAL
        )


def conditions(settings: Settings, range_number: int, Z: complex) -> ReadingConditions:
    """Conditions of a measurement of Z in ohm, by the settings and a range."""
    kept = settings.each_range[range_number]
    drive = GeneratorLevel.of(vars(settings))
    return ReadingConditions(
        settings.frequency,
        range_number,
        kept.speed,
        kept.averaging,
        drive.open_voltage(Z),
        settings.cable,
    )


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
        return numbers.UNDER
    if result.status in WITHOUT_NUMBERS:
        return numbers.OVER
    return numbers.measured_text(
        quantity(name, result.Z, result.conditions.frequency), DECIMALS.get(name)
    )


def quantity(name: str, Z: complex, frequency: float) -> float:
    """Quantity by name from Z in ohm at a frequency in Hz; infinite at a division by zero."""
    omega = 2 * math.pi * frequency
    formulas = {
        "Z": lambda: abs(Z),
        "Y": lambda: 1 / abs(Z),
        "PHASE": lambda: math.degrees(cmath.phase(Z)),
        "CS": lambda: -1 / (omega * Z.imag),
        "CP": lambda: (1 / Z).imag / omega,
        "D": lambda: Z.real / Z.imag,
        "LS": lambda: Z.imag / omega,
        "LP": lambda: -1 / (omega * (1 / Z).imag),
        "Q": lambda: Z.imag / Z.real,
        "RS": lambda: Z.real,
        "G": lambda: (1 / Z).real,
        "RP": lambda: 1 / (1 / Z).real,
        "X": lambda: Z.imag,
        "B": lambda: (1 / Z).imag,
        "RDC": lambda: math.inf,
    }
    try:
        return formulas[name]()
    except ZeroDivisionError:
        return math.inf
