"""Groups the lines of a table into sweeps with press, interface and session."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...arrays import Mask, Real
from .common_frequencies import CommonFrequencies, common_frequencies
from .labels import LineLabels
from .tables.table import ImportedTable

LONG_RUN = 3
"""Number of readings from which a run of frequencies is a sweep of its own."""


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
    are in none. frequencies: those of the lines.
    """

    sweeps: list[ImportedSweep]
    dropped: list[tuple[str, float]]
    frequencies: CommonFrequencies


def grouped(table: ImportedTable, frequency: Real, failed: Mask, labels: LineLabels) -> Grouping:
    """The sweeps of a table.

    A new sweep begins with every new value in a column that labels sweeps, and when a frequency is
    repeated at the same interface with the same labels. failed: True for lines without a reading.
    Raises InputError naming file and line if labels change within one value of the sweep column,
    or if frequencies turn back to others.
    """
    places = list(zip(labels.keys, labels.interfaces, strict=True))
    common = common_frequencies(frequency, places)
    latest: dict[tuple[str, ...], ImportedSweep] = {}
    sweeps: list[ImportedSweep] = []
    for place, (line, _) in enumerate(table.rows):
        key, pressed = labels.keys[place], labels.presses[place]
        reading = labels.interfaces[place], float(common.frequency[place])
        sweep = latest.get(key)
        if sweep is None or reading in sweep.lines:
            if sweep is not None and labels.by_sweep:
                before = table.rows[sweep.lines[reading]][0]
                message = f"the same sweep has {reading[1]:g} Hz in line {before} already"
                raise table.error(line, message)
            sweep = latest[key] = ImportedSweep(line, *pressed)
            sweeps.append(sweep)
        if (sweep.press, sweep.row, sweep.column, sweep.session) != pressed:
            raise table.error(line, f"has another press or session than line {sweep.line}")
        sweep.lines[reading] = place
    if not labels.by_sweep:
        _refuse_turns(table, sweeps, common)
    dropped = _without_failed(table, sweeps, failed)
    return Grouping(sweeps, dropped, common)


def _refuse_turns(
    table: ImportedTable, sweeps: list[ImportedSweep], common: CommonFrequencies
) -> None:
    """Raises InputError where two long runs of frequencies would be one sweep."""
    for sweep in sweeps:
        by_run: dict[tuple[str, int], list[int]] = {}
        for (interface, _), place in sweep.lines.items():
            by_run.setdefault((interface, int(common.runs[place])), []).append(place)
        starts: dict[str, int] = {}
        for (interface, _), places in by_run.items():
            if len(places) < LONG_RUN:
                continue
            if interface in starts:
                line, first = (table.rows[place][0] for place in (places[0], starts[interface]))
                raise table.error(
                    line,
                    "the frequency turns back here, to others than those of the sweep from line "
                    f"{first} on; a column `sweep` would label sweeps",
                )
            starts[interface] = places[0]


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
