"""The table of a file: named columns, lines of readings, and what was left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ....arrays import Real
from ...errors import InputError
from .columns import Column
from .header import (
    MAX_SHOWN,
    NUMBERISH,
    POINT,
    NumberNotation,
    failed,
    possible_formats,
    with_whole_headers,
)
from .scanning import first_header, scanned
from .sources import WORKBOOKS, sources
from .text_lines import Lines
from .written_layouts import rewritten


@dataclass(frozen=True)
class LeftOut:
    """A line that gives no reading: its number and the reason."""

    line: int
    reason: str


@dataclass(frozen=True)
class ImportedTable:
    """The cells of a file below its header.

    header: number of the header's line, 0 if the user named the columns. names: of all columns.
    columns: those that are recognized. rows: line number and cells, one cell for each of `names`.
    preamble: the text above the header. form: how its numbers are written. remarks:
    what is unusual about it.
    """

    path: Path
    header: int
    names: list[str]
    columns: list[Column]
    rows: list[tuple[int, list[str]]]
    preamble: str
    form: NumberNotation = POINT
    left_out: list[LeftOut] = field(default_factory=list)
    separator: str = ","
    remarks: list[str] = field(default_factory=list)

    def holding(self, holds: str) -> list[Column]:
        """The columns of one quantity, those with an understood unit first."""
        found = [column for column in self.columns if column.holds == holds]
        return sorted(found, key=lambda column: bool(column.problem))

    def label(self, holds: str) -> Column | None:
        """The only column of a label that is not the same in all lines, or the only one.

        Raises InputError if there are two.
        """
        found = self.holding(holds)
        if len(found) > 1:
            found = [each for each in found if len(set(self.text(each))) > 1] or found
        if len(found) > 1:
            raise InputError(
                f"{self.path}: line {self.header}: `{found[0].name}` and `{found[1].name}` both "
                f"hold {holds}"
            )
        return found[0] if found else None

    def text(self, column: Column) -> list[str]:
        """The cells of one column."""
        return [cells[column.place] for _, cells in self.rows]

    def numbers(self, column: Column) -> Real:
        """One column in SI units; infinite where a cell says that the reading failed.

        Raises InputError naming file, line and column of the first cell that is no number.
        """
        if column.problem:
            raise InputError(f"{self.path}: {column.problem}")
        pairs = zip(self.rows, self.text(column), strict=True)
        values = [self._number(line, column, text) for (line, _), text in pairs]
        return column.factor * np.array(values)

    def readable(self, column: Column, form: NumberNotation | None = None) -> Real:
        """One column in SI units; NaN where a cell is no number. form: other than the table's."""
        plain = [(form or self.form).plain(text) for text in self.text(column)]
        values = np.array(
            [np.nan if text is None or failed(text) else float(text) for text in plain]
        )
        return column.factor * values

    def forms(self, column: Column) -> list[NumberNotation]:
        """The table's number format if it reads all numbers of a column, else those that may."""
        numbers = [text for text in self.text(column) if NUMBERISH.fullmatch(text)]
        if all(self.form.plain(text) is not None for text in numbers):
            return [self.form]
        return possible_formats(numbers)

    def _number(self, line: int, column: Column, text: str) -> float:
        if failed(text):
            return np.inf
        plain = self.form.plain(text)
        if plain is None:
            as_others = f" {self.form}, as others are" if self.form != POINT else ""
            kind = f"number{as_others}" if as_others else "finite number"
            raise self.error(line, f"`{column.name}` must be a {kind}, got {text!r}")
        return np.inf if failed(plain) else float(plain)

    def error(self, line: int, message: str) -> InputError:
        """An InputError that names the file and the line."""
        return InputError(f"{self.path}: line {line}: {message}")

    def without(self, reasons: Sequence[str]) -> ImportedTable:
        """The table without the rows that have a reason, one text for each row.

        Raises InputError if nothing is left.
        """
        pairs = list(zip(self.rows, reasons, strict=True))
        gone = [LeftOut(line, reason) for (line, _), reason in pairs if reason]
        rows = [row for row, reason in pairs if not reason]
        if not rows:
            raise self.error(gone[0].line, f"{gone[0].reason}, and no line has a reading")
        return replace(self, rows=rows, left_out=[*self.left_out, *gone])

    def written(self, columns: Sequence[Column]) -> ImportedTable:
        """The table with the number format of these columns, the first of them the frequency.

        Raises InputError if their numbers can be read in two ways.
        """
        cells = [text for column in columns for text in self.text(column)]
        forms = possible_formats(cells)
        if len(forms) > 1:
            forms = self._monotone(forms, columns[0])
        if len(forms) > 1 and (self.separator == ";" or POINT in forms):
            forms = [form for form in forms if not form.thousands]
        if len(forms) > 1:
            raise self._ambiguous(forms, columns)
        return replace(self, form=forms[0])

    def _monotone(self, forms: Sequence[NumberNotation], column: Column) -> list[NumberNotation]:
        """The formats with which the frequency turns back least often."""
        turns = []
        for form in forms:
            values = replace(self, form=form).readable(column)
            signs = np.sign(np.diff(values[np.isfinite(values)]))
            turns.append(int(np.sum(signs[1:] != signs[:-1])))
        return [form for form, count in zip(forms, turns, strict=True) if count == min(turns)]

    def _ambiguous(self, forms: Sequence[NumberNotation], columns: Sequence[Column]) -> InputError:
        for line, cells in self.rows:
            for column in columns:
                text = cells[column.place]
                one, other = (form.plain(text) for form in forms[:2])
                if one is not None and other is not None and float(one) != float(other):
                    return self.error(
                        line,
                        f"`{column.name}` can be read in two ways: {text} is {float(one):g} or "
                        f"{float(other):g}; write numbers with a decimal point and without signs "
                        "between thousands",
                    )
        raise AssertionError("formats differ")


def read_table(path: Path, names: list[str] | None = None) -> ImportedTable:
    """Reads the table of a file; the header is found by the names of its columns.

    names: names of all columns, if they are not those of a header.
    Raises InputError naming the file, and the line if there is one: no such file, not text, no
    header, a line with another number of cells than the header.
    """
    problem: InputError | None = None
    found: list[ImportedTable] = []
    for number, lines in enumerate(sources(path), 1):
        try:
            found.append(_table(path, lines, names))
        except InputError as error:
            problem = problem or error
        if found and path.suffix.lower() not in WORKBOOKS:
            break
        if len(found) > 1:
            raise InputError(f"{path}: sheet {number} is not the only one with a table; keep one")
    if not found:
        raise problem or InputError(f"{path}: holds no text")
    return found[0]


def _table(path: Path, lines: Lines, names: list[str] | None) -> ImportedTable:
    lines = with_whole_headers(lines)
    layout, other = (None, None) if names else rewritten(path, lines)
    if other is not None and (line := first_header(path, lines)):
        raise InputError(
            f"{path}: can be read as a table with the header in line {line} and as {layout}; "
            "import a part of it"
        )
    scan, preamble = scanned(path, other or lines, names)
    last = scan.rows[-1][0]
    behind = [f"text from `{text[:MAX_SHOWN]}` on" for line, text in scan.left_out if line > last]
    left_out = [
        LeftOut(line, behind[0] if line > last else f"`{text[:MAX_SHOWN]}`")
        for line, text in scan.left_out
    ]
    return ImportedTable(
        path, scan.line, scan.names, scan.columns, scan.rows, preamble, POINT, left_out,
        scan.separator, [scan.remark] if scan.remark else [],
    )  # fmt: skip
