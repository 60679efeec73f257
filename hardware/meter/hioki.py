"""Hioki's LCR meters IM3523, IM3533, IM3536 and IM3570: dialects of one command language."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from ...simulator.meters.accuracy_table import AccuracyTable, GeneratorLevel, ReadingConditions
from .errors import GarbledError
from .hioki_dialect import (
    CORRECTIONS,
    CP_RS_X,
    STATUS_AND_VALUES,
    HiokiDialect,
    HiokiSiblingDialect,
    frequency_of,
    voltage_from,
)
from .lcr_meter import LcrMeter
from .meter_reading import MeterReading, parse_reading

CORRECTION_COMPLETE = 1
TIMING = ("frequency", "speed", "averaging", "trigger_delay")
READ = "*TRG;:MEASure?"
ROUNDING = 6e-5
"""Relative rounding of frequencies, which a meter sets with five digits."""


class HiokiMeter(HiokiDialect, LcrMeter):
    """Common part of the four models."""

    needed: ClassVar = {
        "header": False,
        "mode": "LCR",
        "trigger": "EXTERNAL",
        "items": CP_RS_X,
        "valid": STATUS_AND_VALUES,
    }
    meaning = ("items", "valid")
    settable = (
        "level",
        "voltage",
        "constant_voltage",
        "constant_current",
        "range",
        "auto_range",
        "speed",
        "averaging",
        "trigger_delay",
        "cable",
        "load_correction",
    )
    timing = TIMING
    restored_last = ("auto_range", "trigger", "header")
    extents = (*CORRECTIONS[1:], "OFF")

    def read(self) -> MeterReading:
        """Reading that this call triggered, never an older one.

        After `prepare`, the time-out grows with speed, averaging and delay. Raises
        FailedReadingError if the meter reports a failure, RefusedError if the meter refused the
        trigger (its answer would be stale), RestartedError, or another MeterError.
        """
        return self.measure(READ, lambda text, _: parse_reading(text), self.max_seconds)

    def read_at(self, frequency: float) -> MeterReading:
        """Reading at a frequency in Hz, in two exchanges.

        The meter rounds a frequency to five digits, and reports it with the reading. Raises
        InputError if the model does not reach the frequency, GarbledError if the meter is at
        another one, and the errors of `read`.
        """
        self.frequency = frequency
        reading, reported = self.measure(
            READ,
            lambda text, found: (parse_reading(text), found["frequency"]),
            self.max_seconds,
            ("frequency",),
        )
        if abs(reported / frequency - 1) > ROUNDING:
            raise GarbledError(
                f"{self.talk.resource}: the meter is at {reported:g} Hz instead of "
                f"{frequency:g} Hz; check that nothing else sets it"
            )
        return reading

    @classmethod
    def reading_seconds(cls, timing: Mapping[str, Any]) -> float:
        """Approximate time of a reading, s."""
        frequency, speed, averaging, delay = (timing[name] for name in TIMING)
        return ReadingConditions(frequency, 1, speed, averaging).seconds + delay

    @classmethod
    def conditions(
        cls, settings: Mapping[str, Any], frequency: float, Z: complex, table: AccuracyTable
    ) -> ReadingConditions:
        """Conditions of a reading of Z [ohm] with the settings of a snapshot."""
        return ReadingConditions(
            frequency,
            settings.get("range") or table.fitting_range(Z),
            settings["speed"],
            settings["averaging"],
            GeneratorLevel.of(settings).open_voltage(Z),
            settings["cable"],
        )

    def start_correction(self, kind: str, extent: str) -> None:
        """Start to acquire a correction, or end it; the meter requires the external trigger."""
        self.trigger = "EXTERNAL"
        self.talk.query(":ESR0?", int)
        self.talk.send(f"{self._corrections(kind)} {extent}")

    def correction_done(self) -> bool:
        """True if the started correction has ended."""
        return bool(self.talk.query(":ESR0?", int) & CORRECTION_COMPLETE)

    def correction_fault(self, kind: str) -> str:
        """Fault of the correction that has ended; empty if there is none."""
        error = self.talk.query(f"{self._corrections(kind)}:ERRor?", int)
        return f"error {error}" if error else ""

    def cancel_correction(self, kind: str) -> None:
        """Cancel the started correction."""
        self.talk.send(f"{self._corrections(kind)} CANCel")

    def _corrections(self, kind: str) -> str:
        return getattr(type(self), f"{kind}_correction").command


class IM3523(HiokiMeter):
    """40 Hz to 200 kHz. Speed, averaging and delay exist per range and are set equally."""

    model = "IM3523"


class IM3533(HiokiSiblingDialect, HiokiMeter):
    """1 mHz to 200 kHz."""

    model = "IM3533"
    frequency = frequency_of("IM3533")


class IM3536(HiokiSiblingDialect, HiokiMeter):
    """4 Hz to 8 MHz, from 10 mV."""

    model = "IM3536"
    frequency = frequency_of("IM3536")
    voltage = voltage_from(10e-3, ":LEVel:VOLTage", "Open voltage, rms, level V")
    constant_voltage = voltage_from(10e-3, ":LEVel:CVOLTage", "Voltage on the skin, rms, level CV")


class IM3570(HiokiSiblingDialect, HiokiMeter):
    """4 Hz to 5 MHz."""

    model = "IM3570"
    frequency = frequency_of("IM3570")


HIOKI = (IM3523, IM3533, IM3536, IM3570)
"""Classes of the four models."""
