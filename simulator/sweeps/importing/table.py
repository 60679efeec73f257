"""The table of a file: its header found, columns named, lines of readings, what was left out."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ...arrays import Real
from ..errors import InputError
from .columns import Column
from .header import (
    DIGITS_ONLY,
    MAX_SHOWN,
    NUMBERISH,
    POINT,
    NumberNotation,
    Scan,
    count_numbers,
    failed,
    has_number,
    header_readings,
    misfit_text,
    number_like,
    possible_formats,
    recognised_all,
    take_units_above,
    unit_row,
    with_whole_headers,
)
from .sources import WORKBOOKS, rewritten, sources
from .text_lines import (
    ALL_SEPARATORS,
    SEPARATORS,
    SPACE,
    WIDE,
    Lines,
    header_cells,
    is_comment,
    line_cells,
    trimmed,
)


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


MAX_ABOVE = 4
"""Number of lines above a header among which one may hold its units."""


def scanned(path: Path, lines: Lines, given: list[str] | None) -> tuple[Scan, str]:
    """The table of a file, and the text above it.

    given: names of the columns, None to find them in a header.
    Raises InputError naming file and line: no header, no readings, two tables with different
    headers, a line of readings with another number of cells than the header.
    """
    scans = [] if given is None else [Scan(0, [(given, "")])]
    above: tuple[str, ...] = ()
    for number, text in lines:
        _take(path, scans, number, text, above, named=given is not None)
        above = (*above, text)[-MAX_ABOVE:] if text.strip() else above
    return _only(path, lines, scans, given)


def first_header(path: Path, lines: Lines) -> int:
    """Number of the first header with readings below it; 0 if there is none."""
    scans: list[Scan] = []
    for number, text in lines:
        try:
            _take(path, scans, number, text, (), named=False)
        except InputError:
            return 0
        if scans and scans[-1].rows:
            return scans[-1].line
    return 0


def _take(
    path: Path, scans: list[Scan], number: int, text: str, above: tuple[str, ...], *, named: bool
) -> None:
    """Takes one line. above: last texts above it. named: by the user, so no line is a header."""
    current = scans[-1] if scans else None
    if not text.strip() or (current is not None and _add(path, current, number, text)):
        return
    readings = [] if named else header_readings(text)
    commented = is_comment(text)
    if readings and not (commented and current and current.rows and not current.commented):
        _open(scans, Scan(number, readings, commented, above))
    elif current is not None:
        _leave_out(path, current, number, text)


def _open(scans: list[Scan], new: Scan) -> None:
    """Begins a table; the same header once more goes on with the table before it."""
    current = scans[-1] if scans else None
    if (
        current is not None
        and current.rows
        and any(current.header == names for names, _ in new.readings)
    ):
        current.fresh, current.foreign = True, 0
    else:
        scans.append(new)


def _only(path: Path, lines: Lines, scans: list[Scan], given: list[str] | None) -> tuple[Scan, str]:
    filled = [scan for scan in scans if scan.rows]
    if not filled:
        raise _no_table(path, lines, scans, given)
    first, *others = filled
    for other in others:
        if other.columns != first.columns:
            raise InputError(
                f"{path}: line {first.line} and line {other.line} both begin tables, with columns "
                f"{_listed(first.names)} and {_listed(other.names)}; import one file for each"
            )
        first.rows += other.rows
        first.left_out += other.left_out
    top = first.line if first.line else first.rows[0][0]
    above = [text for number, text in lines if number < top]
    return first, "\n".join(above)


def _add(path: Path, scan: Scan, number: int, text: str) -> bool:
    """Adds a line of readings, or skips a comment; False if the line is neither."""
    if not scan.rows:
        return _begin(path, scan, number, text)
    if is_comment(text, scan.separator):
        return _is_reading_in_comment(scan, number, text) or not scan.commented
    try:
        cells = trimmed(line_cells(text, scan.separator), len(scan.names))
    except csv.Error as error:
        message = f"{path}: line {number}: cannot be split into cells: {error}"
        raise InputError(message) from error
    if cells == scan.header or cells == scan.units or not any(cells):
        scan.fresh, scan.foreign = scan.fresh or any(cells), 0
        return True
    if len(cells) != len(scan.names) or not has_number(scan.columns, cells):
        return False
    if scan.foreign:
        raise InputError(
            f"{path}: line {scan.foreign}: names no columns that are understood, and readings "
            f"follow in line {number}; import one file for each table"
        )
    scan.rows.append((number, cells))
    scan.fresh = False
    return True


def _is_reading_in_comment(scan: Scan, number: int, text: str) -> bool:
    """Leaves out a comment that holds as many cells as a line of readings, with numbers."""
    try:
        cells = trimmed(line_cells(text, scan.separator), len(scan.names))
    except csv.Error:
        return False
    found = len(cells) == len(scan.names) and has_number(scan.columns, cells)
    if found:
        scan.left_out.append((number, text.strip()))
    return found


def _begin(path: Path, scan: Scan, number: int, text: str) -> bool:
    """Takes the first line of readings, or a line of units, below a header."""
    found: list[tuple[list[str], str, list[str]]] = []
    for names, separator, cells in _splits(scan, text):
        if len(cells) != len(names):
            continue
        if not scan.units and (with_units := unit_row(names, cells)):
            scan.header, scan.units = names, cells
            scan.readings = [(with_units, scan.readings[0][1])]
            return True
        if not is_comment(text, separator) and has_number(recognised_all(names), cells):
            found.append((names, separator, cells))
    found.sort(key=lambda each: -count_numbers(each[0], each[2]))
    if not found:
        scan.misfit = scan.misfit or misfit_text(scan, number, text)
        if scan.line and not is_comment(text) and not header_readings(text):
            scan.left_out.append((number, text.strip()))
        return False
    if scan.misfit and scan.line:
        raise InputError(f"{path}: {scan.misfit}")
    names, separator, cells = found[0]
    _check_unambiguous(path, number, found)
    scan.header = scan.header or names
    if not scan.units:
        own = dict((tuple(way), each) for way, each in scan.readings)[tuple(names)]
        names = take_units_above(scan, names, own)
    scan.names, scan.separator, scan.columns = names, separator, recognised_all(names)
    scan.rows.append((number, cells))
    scan.fresh = False
    return True


def _splits(scan: Scan, text: str) -> Iterator[tuple[list[str], str, list[str]]]:
    for names, _ in scan.readings:
        for separator in ALL_SEPARATORS:
            try:
                yield names, separator, trimmed(line_cells(text, separator), len(names))
            except csv.Error:
                continue


def _check_unambiguous(
    path: Path, number: int, found: list[tuple[list[str], str, list[str]]]
) -> None:
    """Raises InputError if a line can be split in two ways that give different readings."""

    def quantities(names: list[str], cells: list[str]) -> list[tuple[str, float, str]]:
        columns = recognised_all(names)
        return [(each.holds, each.factor, cells[each.place]) for each in columns]

    names, separator, cells = found[0]
    for other_names, other, other_cells in found[1:]:
        as_good = count_numbers(names, cells) == count_numbers(other_names, other_cells)
        if as_good and quantities(names, cells) != quantities(other_names, other_cells):
            kinds = {**SEPARATORS, WIDE: "wide space", SPACE: "space"}
            raise InputError(
                f"{path}: line {number}: can be split at each {kinds[separator]} or at each "
                f"{kinds[other]}, which gives other readings"
            )


def _leave_out(path: Path, scan: Scan, number: int, text: str) -> None:
    """Leaves out a line of text below the readings.

    Raises InputError for a line of numbers with another number of cells, unless text ended the
    table before it.
    """
    if not scan.rows or is_comment(text, scan.separator):
        return
    cells = trimmed(line_cells(text, scan.separator))
    first = next(filter(None, cells), "")
    if (number_like(first) or DIGITS_ONLY.fullmatch(text)) and not scan.ended:
        head = f"the header in line {scan.line}" if scan.line else "--columns"
        raise InputError(
            f"{path}: line {number}: has {len(cells)} cells where {head} has {len(scan.names)}"
        )
    if len(cells) == len(scan.names) and not scan.fresh:
        scan.foreign = number
    scan.ended = True
    scan.left_out.append((number, text.strip()))


def _no_table(path: Path, lines: Lines, scans: list[Scan], given: list[str] | None) -> InputError:
    """Says why a file has no table, with the columns that were seen."""
    misfits = [scan for scan in scans if scan.misfit]
    if misfits:
        return InputError(f"{path}: {misfits[0].misfit}")
    if given is not None:
        return InputError(f"{path}: no line has {len(given)} numbers, as many as --columns names")
    if scans:
        scan = scans[-1]
        return InputError(
            f"{path}: no line of readings below the header in line {scan.line}, whose columns are "
            f"{_listed(scan.readings[0][0])}"
        )
    return InputError(
        f"{path}: no line names a frequency column (as `Frequency (kHz)`, `f/Hz`) and a column of "
        f"impedance or gain beside it, separated by {', '.join(SEPARATORS.values())} or spaces"
        f"{_likely_header(lines)}; --columns f,Rs,X names columns"
    )


def _likely_header(lines: Lines) -> str:
    """The cells of the line above the first line of numbers, as the header that may be meant."""
    above: tuple[int, str] | None = None
    for number, text in lines:
        for separator in ALL_SEPARATORS:
            try:
                cells = trimmed(line_cells(text, separator))
            except csv.Error:
                continue
            if len(cells) > 2 and all(map(number_like, cells)):
                if above is None:
                    return f"; line {number} has {len(cells)} numbers and no names above it"
                names = trimmed(header_cells(above[1], separator))
                if len(names) < 2:
                    names = trimmed(header_cells(above[1], " "))
                return f"; line {above[0]} has {_listed(names)}"
        if text.strip():
            above = number, text
    return ""


def _listed(names: list[str]) -> str:
    shown = [name for name in names if name]
    more = f" and {len(shown) - 30} more" if len(shown) > 30 else ""
    return ", ".join(f"`{name[:MAX_SHOWN]}`" for name in shown[:30]) + more
