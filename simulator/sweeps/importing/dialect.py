"""Reads another tool's table: encoding, preamble, header, separator, decimal sign."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from .. import inputs
from ..digests import check_text
from ..errors import InputError
from ..units import PLAIN, plain_number
from .columns import UNITS, Column, recognised

SEPARATORS = {"\t": "tab", ";": "semicolon", ",": "comma"}
COMMENTS = "#%;"
FAILED = 1e30
"""Numbers of at least this size are a meter's code for "no reading" (9.9E+37, 999999E+28)."""


@dataclass(frozen=True)
class ImportedTable:
    """The cells of a file below its header.

    columns: recognized columns by what they hold. rows: line number and cells, one cell for each of
    `names`. preamble: the text above the header. decimal: '.' or ','.
    """

    path: Path
    names: list[str]
    columns: dict[str, Column]
    rows: list[tuple[int, list[str]]]
    preamble: str
    decimal: str

    def text(self, holds: str) -> list[str]:
        """The cells of one column."""
        place = self.names.index(self.columns[holds].name)
        return [cells[place] for _, cells in self.rows]

    def numbers(self, holds: str) -> list[float]:
        """One column as finite numbers in SI units.

        Raises InputError naming file, line and column of the first cell that is none.
        """
        column = self.columns[holds]
        if column.problem:
            raise InputError(f"{self.path}: {column.problem}")
        cells = zip(self.rows, self.text(holds), strict=True)
        return [column.factor * self._number(line, column, text) for (line, _), text in cells]

    def _number(self, line: int, column: Column, text: str) -> float:
        plain = text.replace(",", ".") if self.decimal == "," else text
        value = plain_number(plain)
        mixed = self.decimal == "," and "." in text
        if mixed or not abs(value) < FAILED:
            which = "number with a decimal comma, as others are" if mixed else "finite number"
            raise self.error(line, f"`{column.name}` must be a {which}, got {text!r}")
        return value

    def error(self, line: int, message: str) -> InputError:
        """An InputError that names the file and the line."""
        return InputError(f"{self.path}: line {line}: {message}")


def read_table(path: Path) -> ImportedTable:
    """Reads the table of a file; the header is found by the names of its columns.

    Raises InputError naming the file, and the line if there is one: no such file, not text, no
    header, two columns of one quantity, a line with another number of cells than the header.
    """
    lines = _lines(path)
    at, separator, names, columns = _header(path, lines)
    below = list(enumerate(lines[at + 1 :], start=at + 2))
    if below and (units := _unit_row(names, _split(path, *below[0], separator))):
        names, below = units, below[1:]
        columns = _by_what_they_hold(path, at + 1, names)
    rows = list(_rows(path, below, separator, names))
    if not rows:
        raise InputError(f"{path}: no line of readings below the header in line {at + 1}")
    return ImportedTable(
        path, names, columns, rows, "\n".join(lines[:at]), _decimal(rows, names, columns)
    )


def _lines(path: Path) -> list[str]:
    content = inputs.table(path)
    check_text(path, content)
    encoding = "utf-16" if content[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    if "\0" in text:
        raise InputError(f"{path}: line {text[: text.index(chr(0))].count(chr(10)) + 1}: not text")
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def _header(path: Path, lines: list[str]) -> tuple[int, str, list[str], dict[str, Column]]:
    """The first line with a frequency and another quantity: index, separator and columns."""
    for index, line in enumerate(lines):
        for separator in SEPARATORS:
            names = _names(line, separator)
            known = {column.holds for name in names if (column := recognised(name))}
            if "frequency" in known and known & (UNITS.keys() - {"frequency"}):
                return index, separator, names, _by_what_they_hold(path, index + 1, names)
    raise InputError(
        f"{path}: no line names a frequency column (as `Frequency (kHz)`, `f/Hz`) and a column of "
        f"impedance beside it, separated by {', '.join(SEPARATORS.values())}"
    )


def _names(line: str, separator: str) -> list[str]:
    """The cells of a line as column names, without leading comment signs."""
    bare = line.strip(" ").lstrip(COMMENTS if separator != ";" else "#%").strip(" ")
    try:
        cells = next(csv.reader([bare], delimiter=separator, skipinitialspace=True), [])
    except csv.Error:
        return []
    names = [cell.strip() for cell in cells]
    while names and not names[-1]:
        names.pop()
    return names


def _by_what_they_hold(path: Path, line: int, names: list[str]) -> dict[str, Column]:
    columns: dict[str, Column] = {}
    for column in filter(None, map(recognised, names)):
        if column.holds in columns:
            raise InputError(
                f"{path}: line {line}: `{columns[column.holds].name}` and `{column.name}` "
                f"both hold {column.holds}"
            )
        columns[column.holds] = column
    return columns


def _unit_row(names: list[str], cells: list[str]) -> list[str]:
    """The names extended by a line of units; empty if the line holds no units."""
    if len(cells) != len(names) or any(PLAIN.match(cell) for cell in cells):
        return []
    with_units = [f"{name} [{unit}]" for name, unit in zip(names, cells, strict=True)]
    known = [column for column in map(recognised, with_units) if column]
    usable = {column.holds for column in known if not column.problem}
    return with_units if "frequency" in usable and len(usable) > 1 else []


def _split(path: Path, line: int, text: str, separator: str) -> list[str]:
    try:
        cells = next(csv.reader([text], delimiter=separator, strict=True), [])
    except csv.Error as error:
        raise InputError(f"{path}: line {line}: cannot be split into cells: {error}") from error
    return [cell.strip() for cell in cells]


def _rows(
    path: Path, lines: list[tuple[int, str]], separator: str, names: list[str]
) -> Iterator[tuple[int, list[str]]]:
    comments = tuple(COMMENTS.replace(separator, ""))
    for line, text in lines:
        if text.lstrip().startswith(comments):
            continue
        cells = _split(path, line, text, separator)
        if not any(cells) or cells[: len(names)] == names:
            continue
        if len(cells) < len(names) or any(cells[len(names) :]):
            raise InputError(
                f"{path}: line {line}: has {len(cells)} cells where the header has {len(names)}"
            )
        yield line, cells[: len(names)]


def _decimal(
    rows: list[tuple[int, list[str]]], names: list[str], columns: dict[str, Column]
) -> str:
    """The decimal sign: ',' if any number of the file has one, else '.'."""
    places = [names.index(column.name) for column in columns.values() if column.holds in UNITS]
    return "," if any("," in cells[place] for _, cells in rows for place in places) else "."
