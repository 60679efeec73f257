"""Layouts of instruments that are no table with a header, rewritten as one.

A layout is a function of a file's lines; it returns the lines of a table, or None if the file does
not have that layout.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from pathlib import Path

from ...errors import InputError
from .columns import UNITS, recognised
from .header import number_like, recognised_all
from .text_lines import SEPARATORS, SPACE, Lines, line_cells, trimmed

TRACE = re.compile(r'"?TRACE:\s*(?P<name>[AB])"?\s*', re.IGNORECASE)
PARAMETER = re.compile(r'"?MEASURE PARAMETER:\s*(?P<text>[^"]+?)"?\s*', re.IGNORECASE)
PARAMETERS = {
    "IMPEDANCE MAG PHASE (DEG)": ("|Z|", "phase (deg)"),
    "IMPEDANCE MAG PHASE (RAD)": ("|Z|", "phase (rad)"),
    "ADMITTANCE MAG PHASE (DEG)": ("|Y|", "phase (deg)"),
    "ADMITTANCE MAG PHASE (RAD)": ("|Y|", "phase (rad)"),
    "IMPEDANCE REAL IMAG": ("Rs", "X"),
    "ADMITTANCE REAL IMAG": ("G", "B"),
}
"""Quantities of the traces A and B; others are written as Cp-D."""
MAX_BEFORE = 4
"""Number of cells that may stand before the name in a transposed table."""


def rewritten(path: Path, lines: Lines) -> tuple[str, Lines | None]:
    """Name of the layout and the lines as one table with a header; None if it is another.

    Raises InputError if a file has two layouts, or if its layout is broken.
    """
    found = {name: table for name, layout in LAYOUTS.items() if (table := layout(path, lines))}
    if len(found) > 1:
        raise InputError(f"{path}: can be read as {' and as '.join(found)}; import a part of it")
    return next(iter(found.items()), ("", None))


def _trace_blocks(path: Path, lines: Lines) -> Lines | None:
    """One block of lines for each of the traces A and B, as of HP and Agilent 4294A."""
    blocks: list[tuple[str, int, list[tuple[int, list[str]]]]] = []
    parameter = ""
    for number, text in lines:
        if (match := PARAMETER.fullmatch(text.strip())) is not None:
            parameter = " ".join(match["text"].split())
        elif (match := TRACE.fullmatch(text.strip())) is not None:
            blocks.append((match["name"].upper(), number, []))
        elif blocks:
            cells = trimmed(line_cells(text.replace('"', ""), "\t" if "\t" in text else ","))
            if cells and number_like(cells[0]):
                blocks[-1][2].append((number, cells))
    if not blocks or not parameter:
        return None
    names = _trace_names(path, parameter)
    if [name for name, _, _ in blocks] != ["A", "B"] * (len(blocks) // 2):
        raise InputError(f"{path}: line {blocks[-1][1]}: traces A and B must follow each other")
    table = [(blocks[0][1], "\t".join(["frequency (Hz)", *names]))]
    for (_, _, first), (_, start, second) in zip(blocks[::2], blocks[1::2], strict=True):
        if [cells[0] for _, cells in first] != [cells[0] for _, cells in second]:
            raise InputError(f"{path}: line {start}: trace B has other frequencies than trace A")
        for (line, a), (other, b) in zip(first, second, strict=True):
            _check_trace(path, line, a)
            _check_trace(path, other, b)
            table.append((line, "\t".join([a[0], a[1], b[1]])))
    return table


def _trace_names(path: Path, parameter: str) -> Sequence[str]:
    names = PARAMETERS.get(parameter.upper(), re.split(r"\s*[-,/]\s*", parameter))
    if len(names) != 2 or not all(recognised(name) for name in names):
        raise InputError(f"{path}: the measure parameter {parameter!r} of its traces is unknown")
    return names


def _check_trace(path: Path, line: int, cells: list[str]) -> None:
    """Raises InputError unless a trace has a real value and the imaginary one is 0."""
    try:
        values = [float(cell) for cell in cells[1:3]]
    except ValueError:
        values = []
    if len(values) < 2 or values[1] != 0:
        raise InputError(
            f"{path}: line {line}: a trace must have a frequency, a number and 0, got "
            f"{', '.join(cells)}"
        )


def _transposed(path: Path, lines: Lines) -> Lines | None:
    """One line for each quantity, its name before its numbers, as of LabOne."""
    named = [each for number, text in lines if (each := _named_line(number, text)) is not None]
    blocks: list[dict[str, tuple[int, list[str]]]] = []
    for number, name, cells in named:
        if not blocks or name in blocks[-1]:
            blocks.append({})
        blocks[-1][name] = number, cells
    for block in blocks:
        kinds = {column.holds for column in recognised_all(list(block))}
        if "frequency" not in kinds or len(kinds & UNITS.keys()) < 3:
            return None
    table: Lines = []
    for block in blocks:
        length = len(next(iter(block.values()))[1])
        first = next(iter(block.values()))[0]
        for name, (number, cells) in block.items():
            if len(cells) != length:
                raise InputError(
                    f"{path}: line {number}: `{name}` has {len(cells)} numbers, line {first} has "
                    f"{length}"
                )
        rows = zip(*(cells for _, cells in block.values()), strict=True)
        table += [(first, "\t".join(block)), *((first, "\t".join(cells)) for cells in rows)]
    return table


def _named_line(number: int, text: str) -> tuple[int, str, list[str]] | None:
    """Number, name and values of a line that holds one quantity."""
    if not re.search(r"[^\W\d_]{2}", text[:200]):
        return None
    for separator in (*SEPARATORS, SPACE):
        try:
            cells = trimmed(line_cells(text, separator))
        except csv.Error:
            continue
        if len(cells) < 3 or not (number_like(cells[-1]) and number_like(cells[-2])):
            continue
        for place, name in enumerate(cells[:MAX_BEFORE]):
            column, values = recognised(name), cells[place + 1 :]
            if column is None or column.holds not in UNITS or len(values) < 2:
                continue
            if all(map(number_like, values)):
                unit = " (rad)" if column.problem and place == MAX_BEFORE - 1 else ""
                return number, name + unit, values
    return None


LAYOUTS = {"blocks of traces A and B": _trace_blocks, "a line for each quantity": _transposed}
