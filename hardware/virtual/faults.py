"""Faults that a virtual meter can simulate."""

from __future__ import annotations

from dataclasses import dataclass, field

from ...simulator.sweeps import InputError
from ..meter.meter_reading import FAILURES

KINDS = {
    "drop": "close the connection instead of answering",
    "late": "answer late",
    "silent": "do not answer",
    "garbage": "answer with bytes that are no text",
    "half": "send half an answer and no end of line",
    "status": "report a failed reading, by default 7 (overflow)",
    "correction": "fail an open or short correction",
    "forget": "lose all settings, as after a power cut",
    "slow": "have the switch turn late",
    "stuck": "have the switch stay where it is",
    "restart": "restart a reader in the middle of a number",
    "miscount": "have the count of a reader's lines jump",
    "repeat": "send a line of a reader twice",
    "interleave": "send a line of a reader again after the next one",
    "endless": "send a line without an end",
    "nan": "send a number that is not finite",
}
GARBAGE = b"\xff\x00\x9c,,;;\x07\xe9\r\n"
ON_ANSWERS = ("drop", "late", "silent", "garbage", "half")
ON_LINES = (*ON_ANSWERS, "restart", "miscount", "repeat", "interleave", "endless", "nan")
"""Faults of a reader's lines."""


@dataclass
class Fault:
    """A kind of fault, and how many times it is still to occur."""

    kind: str
    times: int = 1
    seconds: float = 2.0
    status: int = 7

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError(f"`kind` must be one of {', '.join(KINDS)}, got {self.kind!r}")
        if type(self.times) is not int or not 1 <= self.times <= 10**6:
            raise InputError(f"`times` must be a whole number in 1..1000000, got {self.times!r}")
        if type(self.seconds) not in (int, float) or not 0 <= self.seconds <= 3600:
            raise InputError(f"`seconds` must be in [0, 3600] s, got {self.seconds!r}")
        if self.status not in FAILURES:
            raise InputError(f"`status` must be 1, 7, -7, 9 or 12 to 17, got {self.status}")


@dataclass
class Faults:
    """Pending faults, in order."""

    waiting: list[Fault] = field(default_factory=list)

    def add(self, fault: Fault) -> None:
        """Add a fault for the next occasion."""
        self.waiting.append(fault)

    def take(self, *kinds: str) -> Fault | None:
        """Take the first fault of these kinds, and count it; None if there is none."""
        fault = next((each for each in self.waiting if each.kind in kinds), None)
        if fault:
            fault.times -= 1
            self.waiting = [each for each in self.waiting if each.times]
        return fault
