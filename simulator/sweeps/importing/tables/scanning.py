"""Finds the table of a file: its header, the lines of readings, and the lines that are none."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

from ...errors import InputError
from .header import (
    DIGITS_ONLY,
    MAX_SHOWN,
    Scan,
    count_numbers,
    has_number,
    header_readings,
    misfit_text,
    number_like,
    recognised_all,
    take_units_above,
    unit_row,
)
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
