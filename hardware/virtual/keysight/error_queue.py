"""Error queue of SCPI instruments, read by `:SYSTem:ERRor?`."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

from ..instrument import Standard

TEXTS = {
    0: "No error",
    -100: "Command error",
    -102: "Syntax error",
    -104: "Data type error",
    -108: "Parameter not allowed",
    -109: "Missing parameter",
    -113: "Undefined header",
    -114: "Header suffix out of range",
    -120: "Numeric data error",
    -131: "Invalid suffix",
    -200: "Execution error",
    -211: "Trigger ignored",
    -213: "Init ignored",
    -221: "Settings conflict",
    -222: "Data out of range",
    -223: "Too much data",
    -224: "Illegal parameter value",
    -230: "Data corrupt or stale",
    -300: "Device-specific error",
    -350: "Queue overflow",
}
"""Numbers and texts of errors; source: SCPI 1999, volume 2, chapter 21.8."""
DATA_TYPE, INVALID_SUFFIX, INIT_IGNORED, SETTINGS_CONFLICT = -104, -131, -213, -221
TOO_MUCH_DATA, ILLEGAL_VALUE, STALE_DATA, DEVICE_ERROR, OVERFLOW = -223, -224, -230, -300, -350
LENGTH = 20
"""Errors that the queue of an LCR meter holds. Chosen here: it is in no manual that was at hand."""


@dataclass
class ErrorQueue:
    """Errors, the oldest first. The last one of a full queue is -350."""

    length: int = LENGTH
    codes: deque[int] = field(default_factory=deque)

    def add(self, code: int) -> None:
        """Add an error."""
        if len(self.codes) < self.length:
            self.codes.append(code)
        else:
            self.codes[-1] = OVERFLOW

    def take(self) -> str:
        """Read and remove the oldest error, such as `-113,"Undefined header"`."""
        code = self.codes.popleft() if self.codes else 0
        return f'{code:+d},"{TEXTS[code]}"'

    def clear(self) -> None:
        """Remove all errors."""
        self.codes.clear()


def register_bit(code: int) -> Standard:
    """Bit of the standard event register for an error: E4980A user's guide, page 272."""
    if code <= -400:
        return Standard.QYE
    if code <= -300 or code > 0:
        return Standard.DDE
    return Standard.EXE if code <= -200 else Standard.CME
