"""Cells of CSV files that are safe in a spreadsheet: a name is never read as a formula."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable
from typing import IO, Any

FORMULA = re.compile(r"'*[=+\-@\t\r\n＝＋－＠]")
"""Beginning of text that spreadsheets compute, after any number of our own quotes."""
NUMBER = re.compile(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?")
BEYOND_ASCII = re.compile(r"[^\n -~]")
"""Characters beyond ASCII and control characters, except the line breaks between keys."""
WITHIN_COMMENT = re.compile(r"(?<=[,;\t])[=+\-@]")


def write_cells(file: IO[str], rows: Iterable[Iterable[Any]]) -> None:
    """Writes rows of CSV; text that begins like a formula is preceded by a quote."""
    cells = ([guarded(cell) for cell in row] for row in rows)
    csv.writer(file, lineterminator="\n").writerows(cells)


def guarded(cell: Any) -> Any:
    """The cell, with a quote before text that a spreadsheet would compute."""
    formula = isinstance(cell, str) and FORMULA.match(cell) and not NUMBER.fullmatch(cell)
    return f"'{cell}" if formula else cell


def unguarded(cell: str) -> str:
    """Inverse of `guarded`: the original text of a cell."""
    return cell[1:] if cell.startswith("'") and FORMULA.match(cell) else cell


def printable(toml: str) -> str:
    """Escapes control characters in TOML texts; the TOML reads back the same."""
    return BEYOND_ASCII.sub(lambda found: _printable(found[0]), toml)


def _printable(character: str) -> str:
    return character if character.isprintable() else _escaped(character)


def _escaped(character: str) -> str:
    return f"\\u{ord(character):04x}" if ord(character) < 2**16 else f"\\U{ord(character):08x}"


def guarded_comment(toml: str) -> str:
    """Escapes formula signs after separators in TOML comments; the TOML reads back the same.

    Spreadsheets split comment lines at separators as well; TOML escapes replace the signs.
    """
    return WITHIN_COMMENT.sub(lambda found: _escaped(found[0]), printable(toml))
