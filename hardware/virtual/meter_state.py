"""Settings and event registers of the virtual meter."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntFlag

from ..meter.accuracy_table import RANGES


class Standard(IntFlag):
    """Bits of `*ESR?`."""

    PON = 128
    CME = 32
    EXE = 16
    DDE = 8
    QYE = 4
    OPC = 1


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
class Registers:
    """Both event registers with their masks, and the mask of the status byte."""

    standard: int = Standard.PON
    measuring: int = 0
    standard_mask: int = 0
    measuring_mask: int = 0
    request_mask: int = 0

    def note(self, event: Standard | Measuring) -> None:
        """Set the bit of an event."""
        if isinstance(event, Standard):
            self.standard |= event
        else:
            self.measuring |= event

    def take_standard(self) -> int:
        """Read and clear the standard register."""
        taken, self.standard = int(self.standard), 0
        return taken

    def take_measuring(self) -> int:
        """Read and clear the measuring register."""
        taken, self.measuring = int(self.measuring), 0
        return taken

    def clear(self) -> None:
        """`*CLS`: clear the events, keep the masks."""
        self.standard = self.measuring = 0

    def status_byte(self, waiting: bool) -> int:
        """Status byte: ESB 32, ESB0 1, MAV 16 with a waiting answer, MSS 64 by the mask."""
        byte = (
            32 * bool(self.standard & self.standard_mask)
            | 16 * waiting
            | 1 * bool(self.measuring & self.measuring_mask)
        )
        return byte | 64 * bool(byte & self.request_mask)


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
