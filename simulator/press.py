"""A press: which pixels are touched, and how strongly each."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from simulator.sweeps import UNPRESSED, InputError

SYNTAX = "ROW,COLUMN[:FACTOR], touches joined by '+', or 'none'"
JOINT = re.compile(r"(?<!\de)\+", re.IGNORECASE)
TOUCH = re.compile(r"\s*(\d+)\s*,\s*(\d+)\s*(?::\s*(.+?)\s*)?")


@dataclass(frozen=True, order=True)
class Touch:
    """One pressed pixel, counted from 1, and its capacitance over that at rest."""

    row: int
    column: int
    factor: float

    def __str__(self) -> str:
        return f"{self.row},{self.column}:{self.factor!r}"


@dataclass(frozen=True)
class Press:
    """Several touches at once; none at all is the skin at rest."""

    touches: tuple[Touch, ...] = ()

    def __str__(self) -> str:
        return "+".join(map(str, self.touches)) or UNPRESSED

    @property
    def pixel(self) -> tuple[int, int]:
        """(row, column) of a single touch, (0, 0) at rest, (-1, -1) where it is no single pixel."""
        if not self.touches:
            return 0, 0
        first, *others = self.touches
        return (-1, -1) if others else (first.row, first.column)


def parse_press(text: str, default_factor: float) -> Press:
    """The press written as `text` in SYNTAX; `0,0` and `none` are the skin at rest.

    Raises InputError on other syntax, a factor that is not finite and > 0, or a pixel named twice.
    """
    if text.strip() in (UNPRESSED, "0,0"):
        return Press()
    touches = tuple(sorted(_parse_touch(part, text, default_factor) for part in JOINT.split(text)))
    pixels = [(touch.row, touch.column) for touch in touches]
    if len(set(pixels)) < len(pixels):
        raise InputError(f"press {text!r}: a pixel is named twice")
    return Press(touches)


def _parse_touch(part: str, text: str, default_factor: float) -> Touch:
    match = TOUCH.fullmatch(part)
    if match is None:
        raise InputError(f"press {text!r}: must be {SYNTAX}")
    row, column, factor_text = match.groups()
    try:
        factor = default_factor if factor_text is None else float(factor_text)
    except ValueError:
        factor = math.nan
    if not (math.isfinite(factor) and factor > 0):
        raise InputError(f"press {text!r}: FACTOR must be finite and > 0, got {factor_text}")
    return Touch(int(row), int(column), factor)
