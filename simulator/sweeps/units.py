"""Parses and formats numbers with units, SI prefixes or a decimal comma."""

from __future__ import annotations

import math
import re
from decimal import Decimal, DecimalException

PREFIXES = {"f": -15, "p": -12, "n": -9, "u": -6, "µ": -6, "m": -3, "c": -2}
PREFIXES |= {"k": 3, "K": 3, "M": 6, "G": 9}
BASES = ("m", "ohm", "Ω", "F", "Hz", "H", "Pa", "N", "rad", "s", "V", "A")
NUMBER_WITH_UNIT = re.compile(
    r"(?P<number>[-+]?[\d._]+(?:,\d+)?(?:[eE][-+]?\d+)?)\s*(?P<unit>[^\d\s,][^,]*)?"
)

PLAIN_NUMBER = re.compile(r"\s*[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?\s*", re.ASCII)


def plain_number(text: str) -> float:
    """The value of a decimal number with a point; NaN for any other text.

    Python would also read `1_0`, `nan`, `inf` and the digits of other scripts.
    """
    return float(text) if PLAIN_NUMBER.fullmatch(text) else math.nan


def in_si(text: str) -> str | None:
    """The number in SI without its unit, with a point; None if it is plain or not a number."""
    match = NUMBER_WITH_UNIT.fullmatch(text.strip())
    if match is None or (match["unit"] is None and "," not in match["number"]):
        return None
    power = _power((match["unit"] or "").strip().split("/")[0])
    if power is None:
        return None
    try:
        number = Decimal(match["number"].replace(",", ".").replace("_", "")).scaleb(power)
    except DecimalException:
        return None
    return f"{float(number):g}"


def suggestion(text: str) -> str:
    """`; did you mean NUMBER?` for a number with a unit or a comma; empty for other text."""
    plain = in_si(text)
    return "" if plain is None else f"; did you mean {plain}?"


def _power(unit: str) -> int | None:
    """Power of ten of an SI unit with its prefix, or of a prefix alone; None if unknown."""
    if unit == "%":
        return -2
    if unit in ("", *BASES):
        return 0
    prefix, base = unit[0], unit[1:]
    return PREFIXES.get(prefix) if base in ("", *BASES) else None


PREFIX_OF_POWER = {0: "", 3: "k", 6: "M", 9: "G", -3: "m", -6: "u", -9: "n", -12: "p", -15: "f"}


def prefixed(value: float, unit: str) -> str:
    """A number with three digits, its unit and a suitable SI prefix: 5.46 kHz."""
    power = 3 * math.floor(math.log10(abs(value)) / 3 + 1e-12) if value else 0
    power = min(max(power, min(PREFIX_OF_POWER)), max(PREFIX_OF_POWER))
    return f"{value / 10.0**power:.3g} {PREFIX_OF_POWER[power]}{unit}"
