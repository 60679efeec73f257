"""How the numbers of a table are written: decimal sign and separators of thousands."""

from __future__ import annotations

import functools
import re
from collections.abc import Sequence
from dataclasses import dataclass

from ...units import PLAIN_NUMBER

FAILED = 1e30
"""Numbers of at least this size are a meter's code for "no reading" (9.9E+37, 999999E+28)."""
NO_READING = re.compile(
    r"[+-]?(nan|inf|infinity|1\.#\w+|ol|ovl|ovld|ofl|ovfl|over|overload|overflow|overrange|"
    r"unbal|unbalance|unbalanced|#n/?a!?|n/?a|error|invalid|fail|failed|[-*]{2,})",
    re.IGNORECASE,
)
"""What instruments print instead of a number where a reading failed."""
NUMBERISH = re.compile(
    r"[+-]?(\d([\d.,'\u2019\u00a0\u202f ]*[\d.,])?(?<!,)|[.,]\d+)([eEdD][+-]?\d+)?", re.ASCII
)


@dataclass(frozen=True)
class NumberNotation:
    """Signs of a written number; an empty `thousands` where there are none."""

    decimal: str
    thousands: str

    def plain(self, text: str) -> str | None:
        """The number with a point and without thousands; None if it is not of this format."""
        if not _pattern(self).fullmatch(text):
            return None
        bare = text.replace(self.thousands, "") if self.thousands else text
        return bare.replace(self.decimal, ".").replace("d", "e").replace("D", "e")

    def __str__(self) -> str:
        marks = {".": "point", ",": "comma", "'": "apostrophe", " ": "space"}
        text = f"with a decimal {marks.get(self.decimal, self.decimal)}"
        if self.thousands:
            text += f" and a {marks.get(self.thousands, 'sign')} between thousands"
        return text


@functools.cache
def _pattern(form: NumberNotation) -> re.Pattern[str]:
    decimal, thousands = re.escape(form.decimal), re.escape(form.thousands)
    fraction, exponent = rf"(?:{decimal}\d*)?", "(?:[eE][+-]?[0-9]+|[dD][+-][0-9]+)?"
    grouped = rf"[1-9]\d{{0,2}}(?:{thousands}\d{{3}})+{fraction}|" if thousands else ""
    return re.compile(rf"[+-]?(?:{grouped}(?:\d+{fraction}|{decimal}\d+){exponent})", re.ASCII)


POINT, COMMA = NumberNotation(".", ""), NumberNotation(",", "")
FORMATS = (
    POINT,
    COMMA,
    *(
        NumberNotation(decimal, thousands)
        for decimal, thousands in [
            (".", ","),
            (",", "."),
            (".", "'"),
            (".", "\u2019"),
            (".", " "),
            (",", " "),
            (".", "\u00a0"),
            (",", "\u00a0"),
            (".", "\u202f"),
            (",", "\u202f"),
        ]
    ),
)


SIGNS = re.compile(r"[,' \u2019\u00a0\u202f]|^[+-]?[1-9]\d{0,2}(\.\d{3})+$")
"""Signs of formats other than POINT, and points that may stand between thousands."""


def number_like(text: str) -> bool:
    """True for a number in any format, and for what stands for a failed reading."""
    return bool(NUMBERISH.fullmatch(text) or NO_READING.fullmatch(text))


def possible_formats(cells: Sequence[str]) -> list[NumberNotation]:
    """The formats that read all cells, one for each set of numbers, simplest first.

    If no format reads all, only one that reads the most is returned.
    """
    odd = [
        cell for cell in dict.fromkeys(cells) if NUMBERISH.fullmatch(cell) and not _integer(cell)
    ]
    readings: dict[tuple[str | None, ...], NumberNotation] = {}
    for each in FORMATS:
        readings.setdefault(tuple(map(each.plain, odd)), each)
    counts = {reading: sum(text is not None for text in reading) for reading in readings}
    most = max(counts.values())
    best = [each for reading, each in readings.items() if counts[reading] == most]
    if most < len(odd):
        return [COMMA if COMMA in best and any("," in cell for cell in odd) else best[0]]
    return best


def _integer(text: str) -> bool:
    return text.isascii() and text.lstrip("+-").isdigit()


def failed(text: str) -> bool:
    """True if a cell says that a reading failed, by a word or by a huge number."""
    return bool(NO_READING.fullmatch(text)) or (
        bool(PLAIN_NUMBER.fullmatch(text)) and abs(float(text)) >= FAILED
    )
