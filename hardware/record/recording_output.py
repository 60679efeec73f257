"""Output of a recording, written from its journal as a dataset in the schema of sweeps."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...simulator.safe_text import say
from ...simulator.sweeps import build
from ...simulator.sweeps.schema import SESSIONS
from ..meter.meter_reading import sweep_origin
from .measured_sweep import MeasuredSweep, trace_times
from .operators import UNKNOWN, PressStep, parse_step
from .recording_journal import JournalEntry, RecordingHeader

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    import xarray as xr

    from ...simulator.arrays import Mask, Real
    from .recording_journal import RecordingJournal


def recording_dataset(header: RecordingHeader, entries: Sequence[JournalEntry]) -> xr.Dataset:
    """Sweeps at the frequencies that the meter set for those of the scene.

    Attributes hold the scene, the meter and its settings. JSON attributes are `times`,
    `interface_times` (for each interface), `remarks`, `answers` (label and probability, in a live
    session) and `flagged` (sweep, interface, frequency and status of each reading that was not
    normal, as numbers).
    """
    steps = [_step(entry.press, header) for entry in entries]
    answers = [entry.answer or (entry.press, None) for entry in entries]
    sweeps = [entry.sweep for entry in entries]
    answer_attributes = {} if header.order else {"answers": json.dumps(answers)}
    return sweep_dataset(
        sweeps,
        header.frequencies,
        press=[step.press for step in steps],
        row=[step.row for step in steps],
        column=[step.column for step in steps],
        time=[entry.time for entry in entries],
        attributes={
            "scene": header.scene,
            "model": sweep_origin(header.meter),
            "meter": header.meter,
            "settings": json.dumps(header.settings),
            "begun": header.begun,
            "times": json.dumps([[entry.begun, entry.ended] for entry in entries]),
            "interface_times": json.dumps([trace_times(sweep) for sweep in sweeps]),
            "remarks": json.dumps([list(entry.remarks) for entry in entries]),
            "flagged": json.dumps(_flagged_readings(sweeps, header.frequencies)),
            SESSIONS: json.dumps({0: header.session}),
            **answer_attributes,
            "accuracy": header.accuracy,
            "software": f"rcskin {version('rcskin')}",
        },
    )


def sweep_dataset(
    sweeps: Sequence[MeasuredSweep], frequencies: Sequence[float], **more: Any
) -> xr.Dataset:
    """Dataset of sweeps at the same interfaces. more: arguments of `build`.

    frequencies: Hz, ascending, those of all interfaces.
    """
    first = sweeps[0].traces
    kind, taken = first[0].kind, measured_mask([each.frequency for each in first], frequencies)
    read = [[trace.quantities for trace in sweep.traces] for sweep in sweeps]
    shown = {
        name: np.stack([_scattered([own[name] for own in each], taken) for each in read])
        for name in kind.names
    }
    return build(
        kind.reading(shown),
        np.array(frequencies),
        interface=[trace.interface for trace in first],
        shown=shown,
        taken=None if taken.all() else taken,
        kind=kind,
        **more,
    ).dataset()


def measured_mask(own: Iterable[Sequence[float]], frequencies: Sequence[float]) -> Mask:
    """Mask of the measured frequencies, shape (interface, frequency).

    own: frequencies of each interface, Hz, which a meter may have rounded. frequencies: of all
    interfaces, Hz.
    """
    every = np.asarray(frequencies)
    nearest = [np.abs(np.subtract.outer(each, every)).argmin(axis=1) for each in own]
    return np.array([np.isin(np.arange(every.size), places) for places in nearest])


def _scattered(traces: Sequence[Real], taken: Mask) -> Real:
    """Values at their frequencies, NaN elsewhere; shape (interface, frequency)."""
    found = np.full(taken.shape, np.nan)
    found[taken] = np.concatenate(traces)
    return found


def _flagged_readings(
    sweeps: Sequence[MeasuredSweep], frequencies: Sequence[float]
) -> list[tuple[int, int, int, int]]:
    """Readings that are not normal: index of sweep, interface and frequency, and status code."""
    return [
        (number, place, frequencies.index(frequency), reading.status.code)
        for number, sweep in enumerate(sweeps)
        for place, trace in enumerate(sweep.traces)
        for frequency, reading in zip(trace.frequency, trace.readings, strict=True)
        if reading.status.code
    ]


def _step(press: str, header: RecordingHeader) -> PressStep:
    if press == UNKNOWN:
        return PressStep(press, -1, -1)
    return parse_step(press, header.rows, header.columns)


def finish(
    journal: RecordingJournal, header: RecordingHeader, entries: Mapping[int, JournalEntry]
) -> xr.Dataset:
    """Write the output, remove the journal, and return the sweeps."""
    sweeps = write_all(journal.output, header, entries)
    journal.remove()
    return sweeps


def write_all(
    output: Path, header: RecordingHeader, entries: Mapping[int, JournalEntry]
) -> xr.Dataset:
    """Write the sweeps of a journal, all or none, and return them."""
    from ...simulator.sweeps import write

    sweeps = recording_dataset(header, [entries[number] for number in sorted(entries)])
    write(sweeps, output)
    return sweeps


@contextmanager
def explain_resuming(journal: RecordingJournal) -> Iterator[None]:
    """If the block ends early, print what is kept and how to continue."""
    from ..meter.errors import MeterError

    try:
        yield
    except (KeyboardInterrupt, SystemExit, MeterError):
        header = journal.header()
        if header is not None:
            say(
                f"rcskin: {len(journal.entries(header))} of {len(header.order)} sweeps are "
                f"kept in {journal.folder}; the same command continues after them",
                err=True,
            )
        raise


def summary_remarks(entries: Sequence[JournalEntry]) -> list[str]:
    """Number of sweeps with remarks, and the readings that the meter flagged."""
    from .measured_sweep import flag_remarks

    unsound = sum(bool(entry.remarks) for entry in entries)
    flagged = flag_remarks([entry.sweep for entry in entries])
    return [f"{unsound} with remarks", *(f"flagged by the meter: {each}" for each in flagged)]
