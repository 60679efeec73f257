"""Numbers in the language of a meter."""

from __future__ import annotations

import math
import re
from decimal import Decimal

from .parser import DATA_OUT_OF_RANGE, NUMERIC_DATA_ERROR, CommandError, ExecutionError

NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d{1,3})?", re.ASCII)


def engineering(value: float, digits: int) -> str:
    """Engineering notation with so many significant digits, such as `49.9299E+03`."""
    mantissa, exponent = f"{value:.{digits - 1}E}".split("E")
    shift = int(exponent) % 3
    moved = Decimal(mantissa).scaleb(shift)
    return f"{moved:.{max(digits - 1 - shift, 0)}f}E{int(exponent) - shift:+03d}"


def number(text: str, low: float, high: float) -> float:
    """Number in an argument.

    Raises CommandError if it is none, ExecutionError if it is out of range.
    """
    if NUMBER.fullmatch(text) is None:
        raise CommandError(text, NUMERIC_DATA_ERROR)
    if not low <= float(text) <= high:
        raise ExecutionError(text, DATA_OUT_OF_RANGE)
    return float(text)


def integer(text: str, low: int, high: int) -> int:
    """Number in an argument, rounded to a whole one as a meter does. Raises as `number`."""
    value = number(text, -math.inf, math.inf)
    if not low - 0.5 <= value < high + 0.5:
        raise ExecutionError(text, DATA_OUT_OF_RANGE)
    return math.floor(value + 0.5)
