"""Labels of the lines of a table: sweep, press, row, column, session and interface."""

from __future__ import annotations

import functools
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...arrays import Real
from ..errors import InputError
from ..press_text import written_pixel
from ..schema import UNKNOWN_PRESS, UNNAMED, UNPRESSED
from .tables.columns import Column
from .tables.table import ImportedTable

UNPRESSED_PIXEL = "0,0"
"""Another name of the unpressed skin in tables."""
KEYS = ("press", "row", "column", "repetition", "cycle")
"""Labels that distinguish sweeps if no column counts them."""
PIXEL = ("row", "column")


@dataclass(frozen=True)
class Defaults:
    """Values for a file without such columns."""

    press: str | None = None
    interface: str | None = None
    session: int | None = None


@dataclass(frozen=True)
class LineLabels:
    """Labels of every line.

    keys: what distinguishes sweeps. presses: press, row, column, session. by_sweep: a column counts
    the sweeps. columns: those that were used. counting: columns that only count the lines. curves:
    number of the curve.
    """

    keys: list[tuple[str, ...]]
    interfaces: list[str]
    presses: list[tuple[str, int, int, int]]
    by_sweep: bool
    columns: list[Column]
    counting: list[Column]
    curves: list[int]


def line_labels(table: ImportedTable, frequency: Real, defaults: Defaults) -> LineLabels:
    """The labels of a table. frequency: Hz, of every line.

    Raises InputError naming file and line if a label is malformed, or if rows and columns are
    counted from 0.
    """
    counting = _counting(table, frequency)
    used = {
        holds: column
        for holds in ("sweep", *KEYS, "interface", "session")
        if (column := table.label(holds)) is not None and column not in counting
    }
    if defaults.interface is not None and _is_constant_channel(table, used.get("interface")):
        del used["interface"]
    names = ["sweep"] if "sweep" in used else list(KEYS)
    texts = [table.text(used[name]) for name in [*names, "session"] if name in used]
    keys = list(zip(*texts, strict=True)) if texts else [()] * len(table.rows)
    interfaces = _column(table, used, "interface", defaults.interface, UNNAMED)
    presses = _line_presses(table, used, defaults)
    return LineLabels(
        keys, interfaces, presses, "sweep" in used, list(used.values()), counting, [0] * len(keys)
    )


def _is_constant_channel(table: ImportedTable, column: Column | None) -> bool:
    """True for a channel of an instrument that is the same in all lines."""
    named = column is None or column.name.strip().casefold() == "interface"
    return column is not None and not named and len(set(table.text(column))) == 1


def joined_labels(parts: Sequence[LineLabels]) -> LineLabels:
    """The labels of several curves of a table, one after the other; each curve is a sweep."""
    first = parts[0]
    return LineLabels(
        [(str(n), *key) for n, each in enumerate(parts) for key in each.keys],
        [name for each in parts for name in each.interfaces],
        [press for each in parts for press in each.presses],
        first.by_sweep,
        first.columns,
        first.counting,
        [n for n, each in enumerate(parts) for _ in each.keys],
    )


def _counting(table: ImportedTable, frequency: Real) -> list[Column]:
    """Columns named like labels that only count the lines, as 1, 2, 3 and so on."""
    found = [table.label(holds) for holds in ("sweep", *KEYS[1:], "interface")]
    count = len(table.rows)
    if count < 3 or len(np.unique(frequency)) < count:
        return []
    both = all(table.label(holds) for holds in PIXEL)
    return [
        column
        for column in found
        if column is not None
        and not (both and column.holds in PIXEL)
        and table.text(column)
        in ([str(n) for n in range(start, start + count)] for start in (0, 1))
    ]


def _line_presses(
    table: ImportedTable, used: dict[str, Column], defaults: Defaults
) -> list[tuple[str, int, int, int]]:
    """Tuple (press, row, column, session) of every line."""
    sessions = _integers(table, used, "session", defaults.session, 0)
    presses = _presses(table, used, defaults.press)
    rows, columns = (_integers(table, used, name, None, None) for name in PIXEL)
    labels = []
    for (line, _), press, row, column, session in zip(
        table.rows, presses, rows, columns, sessions, strict=True
    ):
        if row is not None and column is not None and (row == 0) != (column == 0):
            if min(row, column) >= 0:
                raise table.error(
                    line,
                    f"has row {row} with column {column}; rows and columns count from 1, and 0 "
                    "with 0 is the unpressed skin",
                )
        pixel = _pixel(press)
        place = (pixel[0] if row is None else row, pixel[1] if column is None else column)
        labels.append((press or _press_text(*place), *place, session))
    return labels


def _presses(table: ImportedTable, used: dict[str, Column], given: str | None) -> list[str]:
    """The press of every line; the unpressed skin always has the same name."""
    if given == UNPRESSED_PIXEL:
        raise InputError(f"--press must be {UNPRESSED!r} where nothing is pressed, got {given!r}")
    texts = _column(table, used, "press", given, "")
    return [UNPRESSED if "".join(text.split()) == UNPRESSED_PIXEL else text for text in texts]


def _press_text(row: int, column: int) -> str:
    if (row, column) == (0, 0):
        return UNPRESSED
    return f"{row},{column}" if row > 0 and column > 0 else UNKNOWN_PRESS


@functools.lru_cache(4096)
def _pixel(press: str) -> tuple[int, int]:
    """Row and column of a press in a table; -1 and -1 if it is no single pixel."""
    try:
        return written_pixel(press)
    except InputError:
        return -1, -1


def _column(
    table: ImportedTable, used: dict[str, Column], holds: str, given: str | None, absent: str
) -> list[str]:
    if holds not in used:
        return [absent if given is None else given] * len(table.rows)
    if given is not None:
        raise InputError(
            f"{table.path}: has its own column `{used[holds].name}`, so no {holds} "
            f"may be given, got {given!r}"
        )
    texts = table.text(used[holds])
    if "" in texts:
        raise table.error(table.rows[texts.index("")][0], f"names no {holds}")
    return texts


def _integers(
    table: ImportedTable, used: dict[str, Column], holds: str, given: int | None, absent: int | None
) -> list:
    texts = _column(table, used, holds, None if given is None else str(given), "")
    if holds not in used:
        return [absent if given is None else given] * len(table.rows)
    for (line, _), text in zip(table.rows, texts, strict=True):
        if not re.fullmatch(r"[+-]?\d{1,9}", text, re.ASCII):
            name = used[holds].name
            raise table.error(line, f"`{name}` must be a whole number, got {text!r}")
    return [int(text) for text in texts]
