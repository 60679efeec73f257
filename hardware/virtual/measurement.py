"""One reading of a virtual meter: from the skin's impedance to a status and quantities."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, Self

from ...simulator.meters.accuracy_table import AccuracyTable, ReadingConditions
from ..meter.meter_reading import ReadingStatus
from ..meter.setting import rows

if TYPE_CHECKING:
    from ...simulator.measure.specimen import Specimen
    from .recorded_skin import RecordedSkin

    Skin = Specimen | RecordedSkin

Readout = Callable[[complex, ReadingConditions], complex]
"""Displayed impedance for a true one, ohm, with the errors of the session and the reading."""


@dataclass(frozen=True)
class MeasurementResult:
    """Result of a measurement. Z: as measured, ohm. conditions: with the range that was used."""

    status: ReadingStatus
    Z: complex
    conditions: ReadingConditions


NO_RESULT = MeasurementResult(ReadingStatus.NOT_MEASURED, 0j, ReadingConditions(1e3, 6))


class Settings(SimpleNamespace):
    """Settings of a virtual meter by name: those of its dialect, and its `own` ones.

    A subclass says how they measure. frequency: Hz.
    """

    dialect: ClassVar[type]
    own: ClassVar[Mapping[str, Any]] = {}
    frequency: float

    def __init__(self, **changes: Any) -> None:
        """changes: values that differ from those after a reset."""
        defaults = {name: row.default for name, row in rows(self.dialect).items()}
        kept = {name: value for name, value in defaults.items() if value is not None}
        super().__init__(**{**kept, **self.own, **changes})

    def replaced(self, **changes: Any) -> Self:
        """Copy in which these settings have other values."""
        return type(self)(**{**vars(self), **changes})

    def conditions(self, Z: complex, accuracy: AccuracyTable) -> ReadingConditions:
        """Conditions of a measurement of Z in ohm, with the range that the meter uses."""
        raise NotImplementedError

    def status(self, Z: complex, used: ReadingConditions, accuracy: AccuracyTable) -> ReadingStatus:
        """Status of a reading that shows Z in ohm under these conditions."""
        return ReadingStatus.NORMAL


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
