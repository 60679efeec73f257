"""Settings and event registers of Hioki's meters."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntFlag

from ....simulator.meters.accuracy_table import (
    RANGES,
    AccuracyTable,
    GeneratorLevel,
    ReadingConditions,
    full_scale,
)
from ..instrument import EventRegisters, Standard
from ..measurement import NORMAL, OUTSIDE_GUARANTEE, OVERFLOW, UNDERFLOW


class Measuring(IntFlag):
    """Bits of `:ESR0?`."""

    REF = 128
    COF = 64
    LOF = 32
    MOF = 16
    MUF = 8
    IDX = 4
    EOM = 2
    CEM = 1


@dataclass
class Registers(EventRegisters):
    """Both event registers with their masks, and the mask of the status byte."""

    measuring: int = 0
    measuring_mask: int = 0

    def note(self, event: Standard | Measuring) -> None:
        """Set the bit of an event."""
        if isinstance(event, Standard):
            super().note(event)
        else:
            self.measuring |= event

    def take_measuring(self) -> int:
        """Read and clear the measuring register."""
        taken, self.measuring = int(self.measuring), 0
        return taken

    def clear(self) -> None:
        """`*CLS`: clear the events, keep the masks."""
        super().clear()
        self.measuring = 0

    def status_byte(self, waiting: bool, further: int = 0) -> int:
        """Status byte with ESB0 1 of the measuring register."""
        return super().status_byte(waiting, further | bool(self.measuring & self.measuring_mask))


ITEMS = (
    ("Z", "Y", "PHASE", "CS", "CP", "D", "LS", "LP"),
    ("Q", "RS", "G", "RP", "X", "B", "RDC"),
)
PARAMETERS = ("OFF", *ITEMS[0], *ITEMS[1])
SPEEDS = ("FAST", "MEDium", "SLOW", "SLOW2")


@dataclass(frozen=True)
class PerRange:
    """Settings that each range has by itself. delay: s."""

    speed: str = "MEDIUM"
    averaging: int = 1
    delay: float = 0.0


def _each_range() -> dict[int, PerRange]:
    return {number: PerRange() for number in RANGES}


@dataclass
class Settings:
    """Settings. frequency: Hz. voltages: V. current: A. cable: m. items: registers of quantities.

    valid: register of the parts of a reading. The range is the last one set or chosen.
    """

    header: bool = False
    mode: str = "LCR"
    frequency: float = 1e3
    level: str = "V"
    voltage: float = 1.0
    constant_voltage: float = 1.0
    constant_current: float = 10e-3
    range: int = 6
    auto_range: bool = True
    parameters: tuple[str, str] = ("Z", "PHASE")
    trigger: str = "INTERNAL"
    items: tuple[int, int] = (0, 0)
    valid: int = 31
    each_range: dict[int, PerRange] = field(default_factory=_each_range)
    open_correction: str = "OFF"
    short_correction: str = "OFF"
    load_correction: bool = False
    cable: int = 0
    carriage_return_only: bool = False
    compatible: bool = False

    def conditions(self, Z: complex, accuracy: AccuracyTable) -> ReadingConditions:
        """Conditions of a measurement of Z in ohm, with the range that the meter uses."""
        return conditions(self, accuracy.fitting_range(Z) if self.auto_range else self.range, Z)

    def status(self, Z: complex, used: ReadingConditions, accuracy: AccuracyTable) -> int:
        """Status of a reading that shows Z in ohm under these conditions."""
        low, high = accuracy.span.displayed
        size = abs(Z) / full_scale(used.range)
        if size > high:
            return OVERFLOW
        if size < low:
            return UNDERFLOW
        return OUTSIDE_GUARANTEE if accuracy.is_outside_guarantee(Z, used) else NORMAL


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
