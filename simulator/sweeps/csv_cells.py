"""Cells of CSV files, safe to open in a spreadsheet: a name is never a formula there."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable
from typing import IO, Any

FORMULA = re.compile(r"'*[=+\-@\t\r\n＝＋－＠]")
"""How text begins that spreadsheets compute, after any number of our own quotes."""
NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
BEYOND_ASCII = re.compile(r"[^\n -~]")
"""And control characters, but the line breaks between keys."""
WITHIN_COMMENT = re.compile(r"(?<=[,;\t])[=+\-@]")


class CsvWriter:
    """Writes rows as `csv.writer` does; text that begins like a formula gets a quote before it."""

    def __init__(self, file: IO[str]) -> None:
        self._rows = csv.writer(file, lineterminator="\n")

    def writerow(self, row: Iterable[Any]) -> None:
        """Write one row."""
        self._rows.writerow([guarded(cell) for cell in row])

    def writerows(self, rows: Iterable[Iterable[Any]]) -> None:
        """Write many rows."""
        self._rows.writerows([guarded(cell) for cell in row] for row in rows)


def guarded(cell: Any) -> Any:
    """The same cell; text that a spreadsheet would compute, with a quote before it."""
    formula = isinstance(cell, str) and FORMULA.match(cell) and not NUMBER.fullmatch(cell)
    return f"'{cell}" if formula else cell


def unguarded(cell: str) -> str:
    """The text that `guarded` made a cell of."""
    return cell[1:] if cell.startswith("'") and FORMULA.match(cell) else cell


def printable(toml: str) -> str:
    """TOML whose texts hold no character that is obeyed, not shown; it reads back the same."""
    return BEYOND_ASCII.sub(lambda found: _printable(found[0]), toml)


def _printable(character: str) -> str:
    return character if character.isprintable() else _escaped(character)


def _escaped(character: str) -> str:
    return f"\\u{ord(character):04x}" if ord(character) < 2**16 else f"\\U{ord(character):08x}"


def guarded_comment(toml: str) -> str:
    """TOML whose texts hold no cell that begins like a formula; it reads back the same.

    Spreadsheets divide lines of comment at separators, too; TOML's own escapes stand in there.
    """
    return WITHIN_COMMENT.sub(lambda found: _escaped(found[0]), printable(toml))
