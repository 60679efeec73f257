"""One reading of a virtual meter: from the skin's impedance to a status and quantities."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from ...simulator.meters.accuracy_table import AccuracyTable, ReadingConditions

if TYPE_CHECKING:
    from ...simulator.measure.specimen import Specimen
    from .recorded_skin import RecordedSkin

    Skin = Specimen | RecordedSkin

Readout = Callable[[complex, ReadingConditions], complex]
"""Displayed impedance for a true one, ohm, with the errors of the session and the reading."""
NORMAL, NOT_MEASURED, OUTSIDE_GUARANTEE, OVERFLOW, UNDERFLOW = 0, 1, 2, 7, -7
WITHOUT_NUMBERS = {1, 7, 9, *range(12, 18)}


@dataclass(frozen=True)
class MeasurementResult:
    """Result of a measurement. Z: as measured, ohm. conditions: with the range that was used."""

    status: int
    Z: complex
    conditions: ReadingConditions

    @property
    def has_numbers(self) -> bool:
        """True if the display shows numbers."""
        return self.status not in (*WITHOUT_NUMBERS, UNDERFLOW)


NO_RESULT = MeasurementResult(NOT_MEASURED, 0j, ReadingConditions(1e3, 6))


class MeterSettings(Protocol):
    """Settings of a dialect that a measurement uses. frequency: Hz."""

    frequency: float

    def conditions(self, Z: complex, accuracy: AccuracyTable) -> ReadingConditions:
        """Conditions of a measurement of Z in ohm, with the range that the meter uses."""
        ...

    def status(self, Z: complex, used: ReadingConditions, accuracy: AccuracyTable) -> int:
        """Status of a reading that shows Z in ohm under these conditions."""
        ...


@dataclass(frozen=True)
class MeasurementSetup:
    """Inputs of a measurement: the skin, the readout and the accuracy table."""

    skin: Skin
    readout: Readout
    accuracy: AccuracyTable

    def measure(self, press: Any, settings: MeterSettings) -> MeasurementResult:
        """Measure under a press, given as the skin's `momentary` does.

        Raises the skin's errors; ValueError if Z is not finite.
        """
        Z = self.skin.impedance(press, settings.frequency)
        if not cmath.isfinite(Z):
            raise ValueError(f"the skin's impedance is {Z} at {settings.frequency:g} Hz")
        used = settings.conditions(Z, self.accuracy)
        shown = self.readout(Z, used)
        return MeasurementResult(settings.status(shown, used, self.accuracy), shown, used)


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
