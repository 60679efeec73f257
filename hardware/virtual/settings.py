"""What a meter is set to; a new one is what the factory sets."""

from __future__ import annotations

from dataclasses import dataclass, field

from hardware.accuracy import RANGES

SPEEDS = ("FAST", "MEDium", "SLOW", "SLOW2")


@dataclass(frozen=True)
class PerRange:
    """What is kept for each range by itself. delay: s."""

    speed: str = "MEDIUM"
    averaging: int = 1
    delay: float = 0.0


def _each_range() -> dict[int, PerRange]:
    return {number: PerRange() for number in RANGES}


@dataclass
class Settings:
    """frequency: Hz. voltages: V. current: A. cable: m. items: the two registers of what to send.

    valid: the register of what a reading holds. The range is the last one set or chosen.
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
