"""Output of a recording, written from its journal."""

from __future__ import annotations

import logging
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ...simulator.safe_text import say

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    import xarray as xr

    from .recording_journal import JournalEntry, RecordingHeader, RecordingJournal

LOG = logging.getLogger(__name__)


def finish(
    journal: RecordingJournal, header: RecordingHeader, entries: Mapping[int, JournalEntry]
) -> xr.Dataset:
    """Write the output, remove the journal, and return the sweeps."""
    sweeps = write_all(journal.output, header, entries)
    journal.remove()
    return sweeps


def gather(
    recording: Annotated[Path, typer.Argument(help="Output file of the recording.")],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Another OUT.nc or OUT.csv.")
    ] = None,
) -> None:
    """Write the sweeps that a recording or a live session has so far.

    The recording can continue afterwards.
    """
    from ...simulator.sweeps import InputError, checked_output, sizes_text
    from .recording_journal import RecordingJournal

    journal = RecordingJournal(recording)
    header = journal.header()
    entries = journal.entries(header) if header else {}
    if header is None or not entries:
        raise InputError(f"{journal.folder}: holds no sweep of a recording")
    path = checked_output(output or recording)
    sweeps = write_all(path, header, entries)
    whole = f" of {len(header.order)}" if header.order else ""
    say(f"{len(entries)}{whole} sweeps: {sizes_text(sweeps.sizes)} -> {path}")
    _warn_if_meter_changed(journal)


def _warn_if_meter_changed(journal: RecordingJournal) -> None:
    """Log the original settings of a meter that a killed command left changed."""
    from ...simulator.sweeps import InputError
    from ..meter.restoring.original_settings import settings_text

    with suppress(InputError), journal.lock():  # a running recording has the lock
        if found := journal.original_settings():
            LOG.warning(
                "%s: a killed command left the meter's settings changed; the same command restores "
                "the original ones: %s",
                journal.folder,
                settings_text(found[1]),
            )


def write_all(
    output: Path, header: RecordingHeader, entries: Mapping[int, JournalEntry]
) -> xr.Dataset:
    """Write the sweeps of a journal, all or none, and return them."""
    from ...simulator.sweeps import write
    from .recording_dataset import recording_dataset

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
