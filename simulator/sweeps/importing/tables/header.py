"""The header of a table: the ways to split it into names, and what stands below it."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass, field

from .columns import MAY_BE_FREQUENCY, UNITS, Column, recognised, spelled
from .number_format import NUMBERISH, number_like
from .text_lines import ALL_SEPARATORS, header_cells, is_comment, line_cells, trimmed

MAX_SHOWN = 40
"""Number of characters shown of a line."""
LONGEST_NAME = 300
"""Number of characters up to which a name is understood."""

DIGITS_ONLY = re.compile(r"(?=.*\d)[\d\s.,;+\-eEdD'\"]+")
"""A line of numbers, even if it cannot be split into them."""


@dataclass
class Scan:
    """A header and what was found below it.

    line: number of the header's line; 0 for names that the user gave. readings: the ways to split
    the header. commented: the header is a comment. header, names: cells of the header without and
    with the units of a line of its own, `units`. names, columns, separator: known from the first
    line of readings on. rows: number and cells. left_out: number and text of lines that are no
    readings. misfit: describes a line of numbers above them with other cells. foreign: number of
    a line that may name other columns. fresh: no reading stands below the header yet.
    ended: text stands below readings.
    """

    line: int
    readings: list[list[str]]
    commented: bool = False
    header: list[str] = field(default_factory=list)
    units: list[str] = field(default_factory=list)
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


def header_readings(text: str) -> list[list[str]]:
    """The distinct ways to split a line into names of a table; empty if it is no header."""
    found: list[list[str]] = []
    if not MAY_BE_FREQUENCY.search(spelled(text)):
        return found
    for separator in ALL_SEPARATORS:
        names = header_cells(text, separator)
        if names not in found and is_header(recognised_all(names)):
            found.append(names)
    return found


def unit_row(names: list[str], cells: list[str]) -> list[str]:
    """The names extended by a line of units; empty if the line holds no units."""
    if any(NUMBERISH.fullmatch(cell) for cell in cells):
        return []
    pairs = zip(names, cells, strict=True)
    with_units = [f"{name} [{unit}]" if unit else name for name, unit in pairs]
    usable = {column.holds for column in recognised_all(with_units) if not column.problem}
    return with_units if "frequency" in usable and len(usable) > 1 else []


def count_numbers(names: list[str], cells: list[str]) -> int:
    """How many cells of quantities are numbers."""
    columns = recognised_all(names)
    return sum(number_like(cells[each.place]) for each in columns if each.holds in UNITS)


def has_number(columns: list[Column], cells: list[str]) -> bool:
    return any(number_like(cells[each.place]) for each in columns if each.holds in UNITS)


def misfit_text(scan: Scan, number: int, text: str) -> str:
    """Describes a line of numbers with another number of cells than the header."""
    if is_comment(text):
        return ""
    counts = []
    for separator in ALL_SEPARATORS:
        try:
            cells = trimmed(line_cells(text, separator))
        except csv.Error as error:
            return f"line {number}: cannot be split into cells: {error}"
        if all(number_like(cell) for cell in cells if cell):
            counts.append(len(cells))
    if not counts and DIGITS_ONLY.fullmatch(text):
        counts = [len(text.split())]
    if not counts:
        return ""
    head = f"the header in line {scan.line} has" if scan.line else "--columns names"
    return f"line {number}: has {max(counts)} cells where {head} {len(scan.readings[0])}"
