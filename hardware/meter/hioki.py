"""Hioki's LCR meters IM3523, IM3533, IM3536 and IM3570: dialects of one command language."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from ...simulator.meters.accuracy_table import (
    METER_BANDS,
    RANGES,
    AccuracyTable,
    GeneratorLevel,
    ReadingConditions,
)
from .errors import GarbledError
from .lcr_meter import LcrMeter
from .meter_reading import MeterReading, parse_reading
from .setting import (
    IntegerFormat,
    MeterProperty,
    NumberFormat,
    OnOffFormat,
    RegisterFormat,
    Setting,
    WordFormat,
)

SPEEDS = ("FAST", "MEDium", "SLOW", "SLOW2")
CORRECTIONS = ("OFF", "ALL", "SPOT")
CORRECTION_COMMANDS = {"open": ":CORRection:OPEN", "short": ":CORRection:SHORt"}
CORRECTION_COMPLETE = 1
CP_RS_X = 16, 18
STATUS_AND_VALUES = 18
TIMING = ("frequency", "speed", "averaging", "trigger_delay")
READ = "*TRG;:MEASure?"
ROUNDING = 6e-5
"""Relative rounding of frequencies, which a meter sets with five digits."""


class HiokiMeter(LcrMeter):
    """Common part of the four models."""

    header = Setting(":HEADer", OnOffFormat(), "True if answers begin with the command's name")
    items = Setting(":MEASure:ITEM", RegisterFormat(2), "Quantities of a reading")
    valid = Setting(":MEASure:VALid", IntegerFormat(1, 31), "Parts of a reading")
    mode = Setting(":MODE", WordFormat(("LCR", "CONTinuous")), "Mode of measurement")
    level = Setting(
        ":LEVel",
        WordFormat(("V", "CV", "CC")),
        "Controlled quantity: the open voltage (V), the skin's voltage (CV) or its current (CC)",
    )
    voltage = Setting(":LEVel:VOLTage", NumberFormat("V", 5e-3, 5, 4), "Open voltage, rms, level V")
    constant_voltage = Setting(
        ":LEVel:CVOLTage", NumberFormat("V", 5e-3, 5, 4), "Voltage on the skin, rms, level CV"
    )
    constant_current = Setting(
        ":LEVel:CCURRent",
        NumberFormat("A", 10e-6, 50e-3, 4),
        "Current through the skin, rms, level CC",
    )
    range = Setting(
        ":RANGe",
        IntegerFormat(1, 10),
        "Range, 100 mohm x 10^(range - 1) full scale; ends automatic choice",
        moves="auto_range",
    )
    auto_range = Setting(
        ":RANGe:AUTO", OnOffFormat(), "True if the meter chooses the range", moves="range"
    )
    trigger = Setting(
        ":TRIGger",
        WordFormat(("INTernal", "EXTernal")),
        "Source of the trigger: the meter itself, or *TRG",
    )
    cable = Setting(":CORRection:CABLe", IntegerFormat(0, 1), "Length of the cable, m")
    load_correction = Setting(
        ":CORRection:LOAD", OnOffFormat(), "True if load correction is applied"
    )
    open_correction = MeterProperty(
        ":CORRection:OPEN?", WordFormat(CORRECTIONS), "Open correction in use"
    )
    short_correction = MeterProperty(
        ":CORRection:SHORt?", WordFormat(CORRECTIONS), "Short correction in use"
    )

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
    extents = ("ALL", "SPOT", "OFF")

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
        self.talk.send(f"{CORRECTION_COMMANDS[kind]} {extent}")

    def correction_done(self) -> bool:
        """True if the started correction has ended."""
        return bool(self.talk.query(":ESR0?", int) & CORRECTION_COMPLETE)

    def correction_fault(self, kind: str) -> str:
        """Fault of the correction that has ended; empty if there is none."""
        error = self.talk.query(f"{CORRECTION_COMMANDS[kind]}:ERRor?", int)
        return f"error {error}" if error else ""

    def cancel_correction(self, kind: str) -> None:
        """Cancel the started correction."""
        self.talk.send(f"{CORRECTION_COMMANDS[kind]} CANCel")


class IM3523(HiokiMeter):
    """40 Hz to 200 kHz. Speed, averaging and delay exist per range and are set equally."""

    model = "IM3523"
    frequency = Setting(":FREQuency", NumberFormat("Hz", *METER_BANDS["IM3523"], 5), "Frequency")
    speed = Setting(":RANGe:SYNC:SPEEd", WordFormat(SPEEDS), "Speed", each_range=RANGES)
    averaging = Setting(
        ":RANGe:SYNC:AVERaging",
        IntegerFormat(1, 256, "OFF"),
        "Readings averaged",
        each_range=RANGES,
    )
    trigger_delay = Setting(
        ":RANGe:SYNC:TRIGger:DELay",
        NumberFormat("s", 0, 9.9999, 5),
        "Time from trigger to measurement",
        each_range=RANGES,
    )


class _Sibling(HiokiMeter):
    speed = Setting(":SPEEd", WordFormat(SPEEDS), "Speed")
    averaging = Setting(":AVERaging", IntegerFormat(1, 256, "OFF"), "Readings averaged")
    trigger_delay = Setting(
        ":TRIGger:DELay", NumberFormat("s", 0, 9.9999, 5), "Time from trigger to measurement"
    )


class IM3533(_Sibling):
    """1 mHz to 200 kHz."""

    model = "IM3533"
    frequency = Setting(":FREQuency", NumberFormat("Hz", *METER_BANDS["IM3533"], 5), "Frequency")


class IM3536(_Sibling):
    """4 Hz to 8 MHz, from 10 mV."""

    model = "IM3536"
    frequency = Setting(":FREQuency", NumberFormat("Hz", *METER_BANDS["IM3536"], 5), "Frequency")
    voltage = Setting(
        ":LEVel:VOLTage", NumberFormat("V", 10e-3, 5, 4), "Open voltage, rms, level V"
    )
    constant_voltage = Setting(
        ":LEVel:CVOLTage", NumberFormat("V", 10e-3, 5, 4), "Voltage on the skin, rms, level CV"
    )


class IM3570(_Sibling):
    """4 Hz to 5 MHz."""

    model = "IM3570"
    frequency = Setting(":FREQuency", NumberFormat("Hz", *METER_BANDS["IM3570"], 5), "Frequency")


HIOKI = (IM3523, IM3533, IM3536, IM3570)
"""Classes of the four models."""
