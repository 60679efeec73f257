"""Arguments and answers of SCPI: numbers with units, words, switches, and the NR3 format."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any

from ..language import (
    DATA_OUT_OF_RANGE,
    SUFFIX_OUT_OF_RANGE,
    CommandError,
    ExecutionError,
    MeterCommand,
    matched_word,
    short_form,
)
from .error_queue import DATA_TYPE, ILLEGAL_VALUE, INVALID_SUFFIX

NUMBER = re.compile(r"([+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:E[+-]?\d{1,3})?)\s*([A-Z]*)", re.ASCII)
MULTIPLIERS = {"T": 1e12, "G": 1e9, "MA": 1e6, "K": 1e3, "": 1.0, "M": 1e-3, "U": 1e-6, "N": 1e-9}
"""Multipliers of units; source: SCPI 1999, volume 1, section 7.3."""
MEGA_UNITS = ("HZ", "OHM")
"""Units before which M means mega."""
NO_NUMBER = 9.9e37
"""Number that stands for a missing value."""

Read = Callable[[str], Any]


def nr3(value: float, decimals: int = 5) -> str:
    """Number such as `+1.00000E+03`; what is not finite is 9.9E37."""
    return f"{value if math.isfinite(value) else NO_NUMBER:+.{decimals}E}"


def number(text: str, low: float, high: float, unit: str = "", clip: bool = False) -> float:
    """Number in an argument, with or without its unit, or MIN or MAX.

    clip: True to replace a number out of range by the nearest one. Raises CommandError if it is
    none, ExecutionError if it is out of range.
    """
    word = matched_word(text, ("MINimum", "MAXimum"))
    if word:
        return low if word == "MINIMUM" else high
    match = NUMBER.fullmatch(text.upper())
    if match is None:
        raise CommandError(text, DATA_TYPE)
    value = float(match[1]) * _multiplier(match[2], unit)
    if not low <= value <= high:
        if not clip:
            raise ExecutionError(text, DATA_OUT_OF_RANGE)
        return low if value < low else high
    return value


def integer(text: str, low: int, high: int, clip: bool = False) -> int:
    """Whole number in an argument, rounded. Raises as `number`."""
    return math.floor(number(text, low, high, clip=clip) + 0.5)


def _multiplier(suffix: str, unit: str) -> float:
    prefix = suffix.removesuffix(unit) if unit else suffix
    if prefix == "M" and unit in MEGA_UNITS:
        return 1e6
    if (suffix and not suffix.endswith(unit or " ")) or prefix not in MULTIPLIERS:
        raise CommandError(suffix, INVALID_SUFFIX)
    return MULTIPLIERS[prefix]


def one_of(*words: str) -> Read:
    """Reader of one of these words, in its short form. Raises ExecutionError for another."""

    def read(text: str) -> str:
        found = next((word for word in words if matched_word(text, (word,))), None)
        if found is None:
            raise ExecutionError(text, ILLEGAL_VALUE)
        return short_form(found)

    return read


def switch(text: str) -> bool:
    """True for ON or 1, False for OFF or 0. Raises ExecutionError for another word."""
    return one_of("ON", "1", "OFF", "0")(text) in ("ON", "1")


def switch_text(value: bool) -> str:
    """Answer of a switch."""
    return str(int(value))


def word(*words: str) -> Callable[[Any, str], str]:
    """Reader of a setting that is one of these words, see `one_of`."""
    read = one_of(*words)
    return lambda meter, text: read(text)


def on_off(meter: Any, text: str) -> bool:
    """Reader of a setting that is a switch."""
    return switch(text)


def within(low: float, high: float, unit: str, clip: bool = False) -> Callable[[Any, str], float]:
    """Reader of a setting that is a number, see `number`."""
    return lambda meter, text: number(text, low, high, unit, clip)


def setting(
    header: str, name: str, read: Callable[..., Any], show: Callable[[Any], str] = str
) -> MeterCommand:
    """Command of a setting. read: called with the meter and the text of the argument."""

    def set_value(meter: Any, *given: Any) -> None:
        check_suffixes(given[:-1])
        setattr(meter.settings, name, read(meter, given[-1]))
        meter.changed()

    def query(meter: Any, *suffixes: int) -> str:
        check_suffixes(suffixes)
        return show(getattr(meter.settings, name))

    return MeterCommand(header, set_value, query)


def check_suffixes(suffixes: tuple[int, ...]) -> None:
    """Raise CommandError unless all numbers of a header's suffixes are 1."""
    if any(number != 1 for number in suffixes):
        raise CommandError(suffixes, SUFFIX_OUT_OF_RANGE)
