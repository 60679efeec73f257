"""Numbers in the meter's language."""

from __future__ import annotations

import math
import re
from decimal import Decimal

from .parser import CommandError, ExecutionError

NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d{1,3})?", re.ASCII)
OVER, UNDER = " 999999E+28", "-999999E+28"


def engineering(value: float, digits: int) -> str:
    """Engineering notation with so many significant digits, such as `49.9299E+03`."""
    mantissa, exponent = f"{value:.{digits - 1}E}".split("E")
    shift = int(exponent) % 3
    moved = Decimal(mantissa).scaleb(shift)
    return f"{moved:.{max(digits - 1 - shift, 0)}f}E{int(exponent) - shift:+03d}"


def measured_text(value: float, decimals: int | None = None) -> str:
    """A measured value after a space or a minus: six digits, or `decimals` (phase, Q, D).

    A value beyond any display is written as overflow.
    """
    if not (math.isfinite(value) and abs(value) < 1e30):
        return OVER
    if decimals is not None:
        return f"{value: 8.{decimals}f}"
    text = engineering(value, 6)
    return text if text.startswith("-") else f" {text}"


def number(text: str, low: float, high: float) -> float:
    """Number in an argument.

    Raises CommandError if it is none, ExecutionError if it is out of range.
    """
    if NUMBER.fullmatch(text) is None:
        raise CommandError(text)
    if not low <= float(text) <= high:
        raise ExecutionError(text)
    return float(text)


def integer(text: str, low: int, high: int) -> int:
    """Number in an argument, rounded to a whole one as a meter does. Raises as `number`."""
    value = number(text, -math.inf, math.inf)
    if not low - 0.5 <= value < high + 0.5:
        raise ExecutionError(text)
    return math.floor(value + 0.5)
