"""The header of a table, and how its numbers are written.

There are several ways to split a header into names; what stands below it decides.
"""

from __future__ import annotations

import csv
import functools
import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from ..units import PLAIN_NUMBER
from .columns import MAY_BE_FREQUENCY, UNITS, Column, recognised, spelled, unit_factor
from .text_lines import (
    ALL_SEPARATORS,
    COMMENTS,
    SPACE,
    Lines,
    header_cells,
    is_comment,
    line_cells,
    trimmed,
)

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


MAX_SHOWN = 40
"""Number of characters shown of a line."""
LONGEST_NAME = 300
"""Number of characters up to which a name is understood."""

DIGITS_ONLY = re.compile(r"(?=.*\d)[\d\s.,;+\-eEdD'\"]+")
"""A line of numbers, even if it cannot be split into them."""

OPEN_QUOTE = re.compile(r'(?:^|[,;\t])\s*"')
MAX_JOINED = 100
"""Largest number of lines of one header whose names have line breaks."""


@dataclass
class Scan:
    """A header and what was found below it.

    line: number of the header's line; 0 for names that the user gave. readings: names and separator
    for each way to split the header. commented: the header is a comment. above: the last texts
    above it. header, names: cells of the header without and with the units of a line of its own,
    `units`. remark: describes a line that may hold units. names, columns, separator: from the first
    line of readings on. rows: number and cells. left_out: number and text of lines that are no
    readings. misfit: describes a line of numbers above them with other cells. foreign: number of
    a line that may name other columns. fresh: no reading stands below the header yet.
    ended: text stands below readings.
    """

    line: int
    readings: list[tuple[list[str], str]]
    commented: bool = False
    above: tuple[str, ...] = ()
    header: list[str] = field(default_factory=list)
    units: list[str] = field(default_factory=list)
    remark: str = ""
    names: list[str] = field(default_factory=list)
    columns: list[Column] = field(default_factory=list)
    separator: str = ""
    rows: list[tuple[int, list[str]]] = field(default_factory=list)
    left_out: list[tuple[int, str]] = field(default_factory=list)
    misfit: str = ""
    foreign: int = 0
    fresh: bool = True
    ended: bool = False


def recognised_all(names: list[str]) -> list[Column]:
    """The recognized columns of a header."""
    found = (recognised(n, place) for place, n in enumerate(names) if len(n) <= LONGEST_NAME)
    return [column for column in found if column is not None]


def is_header(columns: list[Column]) -> bool:
    """True if columns hold a frequency and another quantity."""
    known = {column.holds for column in columns}
    return "frequency" in known and bool(known & (UNITS.keys() - {"frequency"}))


def header_readings(text: str) -> list[tuple[list[str], str]]:
    """The distinct ways to split a line into names, with the separator; empty if it is no header.

    The way with the most understood columns comes first.
    """
    found: dict[tuple[str, ...], str] = {}
    if not MAY_BE_FREQUENCY.search(spelled(text)):
        return []
    for separator in ALL_SEPARATORS:
        names = header_cells(text, separator)
        if tuple(names) not in found and is_header(recognised_all(names)):
            found[tuple(names)] = separator
    ways = [(list(names), separator) for names, separator in found.items()]
    return sorted(ways, key=lambda way: -len(recognised_all(way[0])))


def with_whole_headers(lines: Lines) -> Lines:
    """The lines, with each header in one line although its quoted names have line breaks."""
    found: Lines = []
    place = 0
    while place < len(lines):
        number, text = lines[place]
        count = 1
        if text.count('"') % 2 and OPEN_QUOTE.search(text):
            count, text = _joined([text for _, text in lines[place : place + MAX_JOINED]])
        found.append((number, text))
        place += count
    return found


def _joined(texts: list[str]) -> tuple[int, str]:
    """Number of lines of the header that begins in the first one, and its text; else the first."""
    text = texts[0]
    for count, more in enumerate(texts[1:], 2):
        if DIGITS_ONLY.fullmatch(more):
            break
        text = f"{text} {more}"
        if text.count('"') % 2 == 0:
            return (count, text) if header_readings(text) else (1, texts[0])
    return 1, texts[0]


def unit_row(names: list[str], cells: list[str]) -> list[str]:
    """The names extended by a line of units; empty if the line holds no units."""
    if any(NUMBERISH.fullmatch(cell) for cell in cells):
        return []
    pairs = zip(names, cells, strict=True)
    with_units = [f"{name} [{unit}]" if unit else name for name, unit in pairs]
    usable = {column.holds for column in recognised_all(with_units) if not column.problem}
    return with_units if "frequency" in usable and len(usable) > 1 else []


def take_units_above(scan: Scan, names: list[str], separator: str) -> list[str]:
    """The names extended by the nearest line of units above them, or the names if there is none.

    All cells of such a line above understood columns are units of these, which have none of their
    own. A line with some such cells is not used, and the scan gets a remark.
    """
    for text in reversed(scan.above):
        cells = _cells_above(text, separator, len(names))
        known = [
            (recognised(name), recognised(f"{name} [{unit}]"), unit)
            for name, unit in zip(names, cells, strict=False)
            if unit and (recognised(name) or recognised(f"{name} [{unit}]"))
        ]
        if known and all(whole is not None and not whole.problem for _, whole, _ in known):
            scan.units = cells
            scaled = [
                UNITS[c.holds] for _, c, _ in known if c and c.holds in UNITS and c.factor != 1
            ]
            return [_with_unit(name, unit, scaled) for name, unit in zip(names, cells, strict=True)]
        units = [unit for bare, whole, unit in known if _other_unit(bare or whole, unit)]
        if units:
            scan.remark = f"a line above the names may hold units ({', '.join(units)}): not used"
    return names


def _with_unit(name: str, unit: str, scaled: list[dict[str, float]]) -> str:
    """A name with its unit; one without needs it if others of its kind, `scaled`, have prefixes."""
    column = recognised(name)
    if not unit and column is not None and UNITS.get(column.holds) in scaled:
        return f"{name} [no unit]"
    return f"{name} [{unit}]" if unit and recognised(f"{name} [{unit}]") else name


def _other_unit(column: Column | None, unit: str) -> bool:
    """True if a cell is a unit of the column's quantity, other than its own."""
    factor = None if column is None else unit_factor(column.holds, unit)
    return factor is not None and column is not None and abs(column.factor) != factor


def _cells_above(text: str, separator: str, length: int) -> list[str]:
    """The cells of a line without numbers that has as many as a header; empty if it has not."""
    try:
        cells = trimmed(line_cells(text, separator), length)
    except csv.Error:
        return []
    if len(cells) != length or any(map(number_like, filter(None, cells))):
        return []
    return [cells[0].lstrip(COMMENTS).strip(" ()[]"), *(cell.strip(" ()[]") for cell in cells[1:])]


def count_numbers(names: list[str], cells: list[str]) -> int:
    """How many cells of quantities are numbers."""
    columns = recognised_all(names)
    return sum(number_like(cells[each.place]) for each in columns if each.holds in UNITS)


def has_number(columns: list[Column], cells: list[str]) -> bool:
    return any(number_like(cells[each.place]) for each in columns if each.holds in UNITS)


def misfit_text(scan: Scan, number: int, text: str) -> str:
    """Describes a line of numbers with another number of cells than the header.

    Its cells are counted as the header is split, or, without that separator in it, as numbers.
    """
    if is_comment(text):
        return ""
    counts, (names, own) = {}, scan.readings[0]
    for separator in ALL_SEPARATORS:
        try:
            cells = trimmed(line_cells(text, separator))
        except csv.Error as error:
            return f"line {number}: cannot be split into cells: {error}"
        numbers = sum(map(number_like, cells))
        begins = separator == own != SPACE and number_like(cells[0]) and numbers > 1
        if begins or numbers == len([cell for cell in cells if cell]):
            counts[separator] = len(cells)
    if not counts and DIGITS_ONLY.fullmatch(text):
        counts[SPACE] = len(text.split())
    if not counts:
        return ""
    count = counts.get(own, 1)
    head = f"the header in line {scan.line} has" if scan.line else "--columns names"
    return (
        f"line {number}: has {count if count > 1 else max(counts.values())} cells where {head} "
        f"{len(names)}"
    )
