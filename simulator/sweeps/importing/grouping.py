"""Groups the lines of a table into sweeps with press, interface and session."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..press_text import written_pixel
from ..schema import UNNAMED, UNPRESSED
from .dialect import ImportedTable

SAME_FREQUENCY = 1e-6
"""Relative difference below which two printed frequencies are the same."""

UNPRESSED_PIXEL = "0,0"
"""Another name of the unpressed skin in tables."""


@dataclass(frozen=True)
class ImportedSweep:
    """One sweep of a table.

    line: line of the file where it begins. press, row, column, session: from its first line. lines:
    row numbers in the table by (interface, frequency in Hz).
    """

    line: int
    press: str
    row: int
    column: int
    session: int
    lines: dict[tuple[str, float], int] = field(default_factory=dict)


@dataclass(frozen=True)
class Defaults:
    """Values for a file without such columns."""

    press: str | None = None
    interface: str | None = None
    session: int | None = None


def grouped(
    table: ImportedTable, frequency: NDArray[np.float64], defaults: Defaults
) -> list[ImportedSweep]:
    """The sweeps of a table in order of appearance.

    A new sweep begins with every new value in a column that labels sweeps, and when a frequency is
    repeated at the same interface with the same labels.
    Raises InputError naming file and line if a label is malformed, or changes within one value of
    the sweep column.
    """
    labels = _labels(table, defaults)
    interfaces = _column(table, "interface", defaults.interface, UNNAMED)
    keys = _keys(table)
    latest: dict[tuple[str, ...], ImportedSweep] = {}
    sweeps: list[ImportedSweep] = []
    for place, (line, _) in enumerate(table.rows):
        reading = interfaces[place], float(frequency[place])
        sweep = latest.get(keys[place])
        if sweep is None or reading in sweep.lines:
            _refuse_again(table, line, sweep, reading)
            sweep = latest[keys[place]] = ImportedSweep(line, *labels[place])
            sweeps.append(sweep)
        if (sweep.press, sweep.row, sweep.column, sweep.session) != labels[place]:
            raise table.error(line, f"has another press or session than line {sweep.line}")
        sweep.lines[reading] = place
    return sweeps


def reading_places(
    table: ImportedTable, sweeps: list[ImportedSweep]
) -> tuple[list[str], NDArray[np.float64], NDArray[np.bool_], NDArray[np.intp]]:
    """Interfaces, ascending frequencies in Hz, mask of readings taken, and row numbers of readings.

    The mask has the shape (interface, frequency). The row numbers have the shape (sweep, interface,
    frequency) and are 0 where nothing was read.
    Raises InputError naming file and line of the first sweep with other readings.
    """
    first = sweeps[0]
    interfaces = list(dict.fromkeys(name for name, _ in first.lines))
    frequency = np.array(sorted({f for _, f in first.lines}))
    taken = np.array([[(name, f) in first.lines for f in frequency] for name in interfaces])
    wanted = [
        (name, f)
        for name, read in zip(interfaces, taken, strict=True)
        for f in frequency[read].tolist()
    ]
    found = np.zeros((len(sweeps), *taken.shape), dtype=np.intp)
    found[:, taken] = [_matching(table, first, each, wanted) for each in sweeps]
    return interfaces, frequency, taken, found


def _matching(
    table: ImportedTable,
    first: ImportedSweep,
    sweep: ImportedSweep,
    wanted: list[tuple[str, float]],
) -> NDArray[np.intp]:
    order = {name: place for place, (name, _) in enumerate(wanted)}
    having = sorted(sweep.lines, key=lambda reading: (order.get(reading[0], -1), reading[1]))
    same = len(having) == len(wanted) and all(
        name == other and abs(f - g) <= SAME_FREQUENCY * g
        for (name, f), (other, g) in zip(having, wanted, strict=True)
    )
    if same:
        return np.array([sweep.lines[reading] for reading in having])
    readings = f"has {len(having)} readings, not the same {len(wanted)} interfaces and frequencies"
    whose = f"as the sweep from line {first.line} on"
    raise table.error(sweep.line, f"the sweep from here on {readings} {whose}")


def _refuse_again(
    table: ImportedTable, line: int, sweep: ImportedSweep | None, reading: tuple[str, float]
) -> None:
    if sweep is not None and "sweep" in table.columns:
        before = table.rows[sweep.lines[reading]][0]
        raise table.error(line, f"the same sweep has {reading[1]:g} Hz in line {before} already")


def _keys(table: ImportedTable) -> list[tuple[str, ...]]:
    """Keys that distinguish sweeps: the sweep column if there is one, else all other labels."""
    names = ["sweep"] if "sweep" in table.columns else ["press", "row", "column", "repetition"]
    texts = [table.text(name) for name in [*names, "session"] if name in table.columns]
    return list(zip(*texts, strict=True)) if texts else [()] * len(table.rows)


def _labels(table: ImportedTable, defaults: Defaults) -> list[tuple[str, int, int, int]]:
    """Tuple (press, row, column, session) of every line."""
    sessions = _integers(table, "session", defaults.session, 0)
    presses = _presses(table, defaults.press)
    rows, columns = (_integers(table, name, None, None) for name in ("row", "column"))
    labels = []
    for press, row, column, session in zip(presses, rows, columns, sessions, strict=True):
        pixel = _pixel(press)
        place = (pixel[0] if row is None else row, pixel[1] if column is None else column)
        labels.append((press or _press_text(*place), *place, session))
    return labels


def _presses(table: ImportedTable, given: str | None) -> list[str]:
    """The press of every line; the unpressed skin always has the same name."""
    if given == UNPRESSED_PIXEL:
        raise InputError(f"--press must be {UNPRESSED!r} where nothing is pressed, got {given!r}")
    texts = _column(table, "press", given, "")
    return [UNPRESSED if "".join(text.split()) == UNPRESSED_PIXEL else text for text in texts]


def _press_text(row: int, column: int) -> str:
    if (row, column) == (0, 0):
        return UNPRESSED
    return f"{row},{column}" if row > 0 and column > 0 else "unknown"


def _pixel(press: str) -> tuple[int, int]:
    """Row and column of a press in a table; -1 and -1 if it is no single pixel."""
    try:
        return written_pixel(press)
    except InputError:
        return -1, -1


def _column(table: ImportedTable, holds: str, given: str | None, absent: str) -> list[str]:
    if holds not in table.columns:
        return [absent if given is None else given] * len(table.rows)
    if given is not None:
        raise InputError(
            f"{table.path}: has its own column `{table.columns[holds].name}`, so no {holds} "
            f"may be given, got {given!r}"
        )
    texts = table.text(holds)
    if "" in texts:
        raise table.error(table.rows[texts.index("")][0], f"names no {holds}")
    return texts


def _integers(table: ImportedTable, holds: str, given: int | None, absent: int | None) -> list:
    texts = _column(table, holds, None if given is None else str(given), "")
    if holds not in table.columns:
        return [absent if given is None else given] * len(table.rows)
    for (line, _), text in zip(table.rows, texts, strict=True):
        if not re.fullmatch(r"[+-]?\d{1,9}", text, re.ASCII):
            name = table.columns[holds].name
            raise table.error(line, f"`{name}` must be a whole number, got {text!r}")
    return [int(text) for text in texts]
