"""Groups the lines of a table into sweeps by their labels: press, pixel, session, interface."""

from __future__ import annotations

import functools
import re
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...arrays import Mask, Real
from ..errors import InputError
from ..press_text import written_pixel
from ..same_skin import tolerance
from ..schema import UNKNOWN_PRESS, UNNAMED, UNPRESSED
from .columns import Column
from .table import ImportedTable

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


JITTER = 1e-3
"""Largest relative difference between the frequencies that a meter reports for the same setting."""
COARSE = 10.0
"""Steps of a sweep over JITTER from which a step within JITTER begins another sweep."""
LONG_RUN = 3
"""Number of readings from which a run of frequencies is a sweep of its own."""


@dataclass(frozen=True)
class CommonFrequencies:
    """Frequency of every line in Hz, rounded to that of the first sweep, and how far it was off.

    runs: number of the run of ascending or descending frequencies, for every line. jitter: largest
    relative difference, 0 where all are equal but for SAME_FREQUENCY or the digits.
    """

    frequency: Real
    runs: NDArray[np.intp]
    jitter: float


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
class Grouping:
    """Sweeps in order of appearance, with all readings that did not fail.

    dropped: frequencies in Hz at interfaces at which a reading failed in some sweep, so that they
    are in none. frequencies: those of the lines. repeated: row numbers of readings at a frequency
    that two segments of a spectrum share, that which is kept and the other. joined: segments had
    other labels.
    """

    sweeps: list[ImportedSweep]
    dropped: list[tuple[str, float]]
    frequencies: CommonFrequencies
    repeated: list[tuple[int, int]]
    joined: bool


def grouped(table: ImportedTable, frequency: Real, failed: Mask, labels: LineLabels) -> Grouping:
    """The sweeps of a table.

    A new sweep begins with every new value in a column that labels sweeps, and when a frequency is
    repeated at the same interface with the same labels. But frequencies that begin within those of
    a sweep and go on beyond them, in the same direction, are a further segment of it.
    failed: True for lines without a reading.
    Raises InputError naming file and line if labels change within one value of the sweep column,
    or if frequencies turn back to others.
    """
    common = common_frequencies(frequency, list(zip(labels.keys, labels.interfaces, strict=True)))
    keys = _keys_of_spectra(labels, common)
    latest: dict[tuple[str, ...], ImportedSweep] = {}
    sweeps: list[ImportedSweep] = []
    repeated: list[tuple[int, int]] = []
    for place, (line, _) in enumerate(table.rows):
        key, pressed = keys[place], labels.presses[place]
        interface, f = labels.interfaces[place], float(common.frequency[place])
        sweep = latest.get(key)
        before = None if sweep is None else sweep.lines.get((interface, f))
        if sweep is not None and before is not None:
            if _is_segment(sweep, interface, place, common):
                kept, other = (place, before) if failed[before] else (before, place)
                sweep.lines[interface, f] = kept
                repeated.append((kept, other))
                continue
            if labels.by_sweep:
                message = f"the same sweep has {f:g} Hz in line {table.rows[before][0]} already"
                raise table.error(line, message)
        if sweep is None or before is not None:
            sweep = latest[key] = ImportedSweep(line, *pressed)
            sweeps.append(sweep)
        if (sweep.press, sweep.row, sweep.column, sweep.session) != pressed:
            raise table.error(line, f"has another press or session than line {sweep.line}")
        sweep.lines[interface, f] = place
    if not labels.by_sweep:
        _refuse_turns(table, sweeps, common)
    dropped = _without_failed(table, sweeps, failed)
    return Grouping(sweeps, dropped, common, repeated, keys != labels.keys)


def _keys_of_spectra(labels: LineLabels, common: CommonFrequencies) -> list[tuple[str, ...]]:
    """The key of every line, where segments of one spectrum have that of its first segment."""
    found: list[tuple[str, ...]] = []
    same: dict[tuple[str, ...], tuple[str, ...]] = {}
    latest: dict[object, tuple[tuple[str, ...], list[float]]] = {}
    for place, key in enumerate(labels.keys):
        where = labels.presses[place], labels.interfaces[place], labels.curves[place]
        before, spectrum = latest.get(where, (key, []))
        if key not in same:
            run = common.frequency[common.runs == common.runs[place]].tolist()
            same[key] = same[before] if before in same and continues(spectrum, run) else key
        if same[key] != before:
            spectrum = []
        spectrum.append(float(common.frequency[place]))
        latest[where] = same[key], spectrum
        found.append(same[key])
    return found


def _is_segment(
    sweep: ImportedSweep, interface: str, place: int, common: CommonFrequencies
) -> bool:
    """True if the run of a line goes on beyond the frequencies of a sweep at the interface."""
    run = common.frequency[common.runs == common.runs[place]].tolist()
    further = set(run[1:])
    return continues([f for name, f in sweep.lines if name == interface and f not in further], run)


def _refuse_turns(
    table: ImportedTable, sweeps: list[ImportedSweep], common: CommonFrequencies
) -> None:
    """Raises InputError where two long runs of frequencies would be one sweep."""
    for sweep in sweeps:
        by_run: dict[tuple[str, int], list[int]] = {}
        for (interface, _), place in sweep.lines.items():
            by_run.setdefault((interface, int(common.runs[place])), []).append(place)
        latest: dict[str, list[int]] = {}
        for (interface, _), places in by_run.items():
            if len(places) < LONG_RUN:
                continue
            before = latest.get(interface, places)
            runs = (common.frequency[each].tolist() for each in (before, places))
            if before is not places and not continues(*runs):
                line, first = table.rows[places[0]][0], table.rows[before[0]][0]
                raise table.error(
                    line,
                    "the frequency turns back here, to others than those of the sweep from line "
                    f"{first} on; a column `sweep` would label sweeps",
                )
            latest[interface] = places


def _without_failed(
    table: ImportedTable, sweeps: list[ImportedSweep], failed: Mask
) -> list[tuple[str, float]]:
    """Removes from all sweeps the readings that failed in one.

    Raises InputError if a sweep has none left.
    """
    dropped = dict.fromkeys(
        reading for sweep in sweeps for reading, place in sweep.lines.items() if failed[place]
    )
    for sweep in sweeps:
        for reading in dropped:
            sweep.lines.pop(reading, None)
        if not sweep.lines:
            raise table.error(
                sweep.line,
                "the sweep from here on has no reading at a frequency at which all sweeps have one",
            )
    return list(dropped)


def reading_places(
    table: ImportedTable, sweeps: list[ImportedSweep], hint: str = ""
) -> tuple[list[str], Real, Mask, NDArray[np.intp]]:
    """Interfaces, ascending frequencies in Hz, mask of readings taken, and row numbers of readings.

    The mask has the shape (interface, frequency). The row numbers have the shape (sweep, interface,
    frequency) and are 0 where nothing was read.
    Raises InputError naming file and line of the first sweep with other readings, and the hint.
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
    found[:, taken] = [_matching(table, first, each, wanted, hint) for each in sweeps]
    return interfaces, frequency, taken, found


def _matching(
    table: ImportedTable,
    first: ImportedSweep,
    sweep: ImportedSweep,
    wanted: list[tuple[str, float]],
    hint: str,
) -> list[int]:
    if sweep.lines.keys() == set(wanted):
        return [sweep.lines[reading] for reading in wanted]
    readings = f"has {len(sweep.lines)} readings, not the same {len(wanted)} interfaces and "
    missing = [f"{f:g} Hz" for name, f in wanted if (name, f) not in sweep.lines][:1]
    without = f" ({missing[0]} is missing)" if missing else ""
    whose = f"as the sweep from line {first.line} on"
    raise table.error(
        sweep.line, f"the sweep from here on {readings}frequencies {whose}{without}{hint}"
    )


def common_frequencies(frequency: Real, keys: Sequence[Hashable]) -> CommonFrequencies:
    """Frequencies of lines with those that are nearly equal made equal.

    Frequencies within `tolerance` are one. Those within JITTER are one too if they never occur in
    one run, so that a fine grid is kept. keys: what else distinguishes lines, such as the press.
    """
    values, inverse = np.unique(frequency, return_inverse=True)
    exact = _joined(values, tolerance(values))[inverse]
    runs = _runs(exact, keys)
    rough = _joined(values, np.full(values.shape, JITTER))[inverse]
    pairs = np.unique(np.stack([runs.astype(float), rough]), axis=1).shape[1]
    fine = np.unique(np.stack([runs.astype(float), exact]), axis=1).shape[1]
    found = rough if pairs == fine else exact
    found = _first(found, frequency)
    differences = np.abs(frequency / found - 1)
    beyond = differences > tolerance(values)[inverse]
    return CommonFrequencies(found, runs, float(differences[beyond].max(initial=0.0)))


def continues(first: Sequence[float], second: Sequence[float]) -> bool:
    """True if a second run of frequencies begins within or behind the first and ends beyond it."""
    if len(first) < 2 or len(second) < 2:
        return False
    direction = np.sign(first[-1] - first[0])
    a, b = direction * np.array(first), direction * np.array(second)
    return bool((np.diff(b) > 0).all() and b[0] > a[0] and b[-1] > a.max())


def _joined(values: Real, tolerances: Real) -> Real:
    """Ascending values with each group of neighbours within tolerance replaced by its first."""
    apart = np.append(True, np.diff(values) > tolerances[1:] * values[:-1])
    return values[np.flatnonzero(apart)[np.cumsum(apart) - 1]]


def _first(groups: Real, frequency: Real) -> Real:
    """The first frequency of each group, for every line."""
    _, first, inverse = np.unique(groups, return_index=True, return_inverse=True)
    return frequency[first][inverse]


def _runs(frequency: Real, keys: Sequence[Hashable]) -> NDArray[np.intp]:
    """Number of the monotone run of every line, among the lines with the same key."""
    runs = np.empty(len(frequency), dtype=np.intp)
    latest: dict[Hashable, tuple[int, float, float]] = {}
    count = 0
    for place, (f, key) in enumerate(zip(frequency.tolist(), keys, strict=True)):
        run, before, last = latest.get(key, (-1, f, 0.0))
        step = f / before - 1
        stays = abs(step) <= JITTER and abs(last) > COARSE * JITTER
        if run < 0 or step == 0 or step * last < 0 or stays:
            run, count, step = count, count + 1, 0.0
        runs[place] = run
        latest[key] = run, f, step
    return runs
