"""Datasets of measured sweeps for a model, and the log of a live session."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.cleanup import temporary_folder
from ...simulator.sweeps import OPENING, UNPRESSED, InputError, read_joined, sizes_text
from ...simulator.sweeps.reading_quantities import kind_of
from ...simulator.sweeps.reading_subset import read_mask
from ...simulator.sweeps.same_skin import check_same_skin, same_frequencies
from ...simulator.sweeps.schema import complex_readings
from ..meter.meter_reading import MeterReading
from ..record.measured_sweep import InterfaceTrace, MeasuredSweep, now
from ..record.operators import UNKNOWN
from ..record.recording_journal import (
    JournalEntry,
    RecordingHeader,
    RecordingJournal,
    finish,
    measured_mask,
    sweep_dataset,
    warn_if_clock_set_back,
    write_all,
)
from .live_baseline import LiveBaseline
from .touch_answer import TouchAnswer, frequencies_of

if TYPE_CHECKING:
    import xarray as xr

    from ...localization.model.localizer_model import Model


def model_dataset(
    sweeps: Sequence[MeasuredSweep], model: Model, press: Sequence[str] | str = UNKNOWN
) -> xr.Dataset:
    """Dataset of sweeps at the model's interfaces and frequencies. press: of each, or of all."""
    presses = [press] * len(sweeps) if isinstance(press, str) else list(press)
    places = [0 if each == UNPRESSED else -1 for each in presses]
    return sweep_dataset(
        sweeps,
        model.frequencies,
        press=presses,
        row=places,
        column=places,
        attributes={"scene": model.problem.scene},
    )


def baseline_dataset(rest: LiveBaseline, model: Model) -> xr.Dataset:
    """Dataset of the unpressed sweeps; the coordinate OPENING marks those of the opening."""
    both = [*rest.opening, *rest.sweeps]
    opening = [True] * len(rest.opening) + [False] * len(rest.sweeps)
    return model_dataset(both, model, UNPRESSED).assign_coords({OPENING: ("sweep", opening)})


@dataclass
class BaselineDataset:
    """Dataset of the unpressed sweeps, built again when they change."""

    rest: LiveBaseline
    model: Model
    _of: tuple[list[MeasuredSweep], list[MeasuredSweep]] = field(
        default_factory=lambda: ([], []), init=False
    )
    _made: xr.Dataset | None = field(default=None, init=False)

    @property
    def sweeps(self) -> xr.Dataset:
        """See `baseline_dataset`."""
        counting = self.rest.opening, list(self.rest.sweeps)
        if self._made is None or counting != self._of:
            self._of, self._made = counting, baseline_dataset(self.rest, self.model)
        return self._made


def read_baselines(
    paths: Sequence[Path], model: Model, *, force: bool = False
) -> list[MeasuredSweep]:
    """Unpressed sweeps from files.

    force: accept files of another skin. Raises InputError if there are none, or if the skin, the
    interfaces or the frequencies differ from the model's.
    """
    sweeps = read_joined(paths)
    path = ", ".join(map(str, paths))
    if not force:
        check_same_skin(str(sweeps.attrs.get("scene", "")), model.problem.scene, path)
    unpressed = sweeps.isel(sweep=np.flatnonzero(sweeps["press"].values == UNPRESSED))
    if not unpressed.sizes["sweep"]:
        raise InputError(f"{path}: holds no unpressed sweep (press `none`)")
    frequencies = unpressed["frequency"].values
    same = len(frequencies) == len(model.frequencies) and bool(
        same_frequencies(frequencies, model.frequencies).all()
    )
    own = frequencies_of(model)
    taken = measured_mask(own.values(), model.frequencies)
    if (
        not same
        or tuple(unpressed["interface"].values) != model.interfaces
        or not np.array_equal(read_mask(unpressed), taken)
    ):
        raise InputError(f"{path}: has other interfaces or frequencies than the model")
    kind = kind_of(unpressed.variables)
    names = [name for name in kind.names if name not in kind.sufficient]
    shown = [unpressed[name].transpose("sweep", "interface", "frequency").values for name in names]
    columns = [complex_readings(unpressed), *shown]

    def trace(number: int, place: int, name: str) -> InterfaceTrace:
        values = zip(*(each[number, place, taken[place]].tolist() for each in columns), strict=True)
        readings = [
            MeterReading(value, kind=kind, shown=dict(zip(names, more, strict=True)))
            for value, *more in values
        ]
        return InterfaceTrace(own[name], tuple(readings), name)

    return [
        MeasuredSweep(tuple(trace(number, place, name) for place, name in enumerate(own)))
        for number in range(unpressed.sizes["sweep"])
    ]


@dataclass
class SessionLog:
    """Log of all sweeps and answers in a journal. Without a journal nothing is kept.

    summary: one line that states what was written, and how the next session can start from its
    baseline.
    """

    journal: RecordingJournal | None = None
    summary: str = field(default="", init=False)
    _kept: int = field(default=0, init=False)
    _latest: JournalEntry | None = field(default=None, init=False)

    def keep(
        self, sweep: MeasuredSweep, press: str, begun: str, header: RecordingHeader | None
    ) -> None:
        """Write a finished sweep. press: `none` for an unpressed sweep."""
        if self.journal is None or header is None:
            return
        if not self._kept:
            self.journal.begin(header)
        before, self._latest = self._latest, JournalEntry(press, sweep, begun, now())
        warn_if_clock_set_back(self._latest, before)
        self.journal.keep(self._kept, self._latest)
        self._kept += 1
        if self._kept == 1:  # loads the libraries for writing, so that the session ends quickly
            with temporary_folder() as folder:
                write_all(folder / "first.nc", header, {0: self._latest})

    def answered(self, answer: TouchAnswer) -> None:
        """Write the answer to the latest sweep."""
        if self.journal is None or self._latest is None:
            return
        self._latest = replace(self._latest, answer=(answer.label, answer.probability))
        self.journal.keep(self._kept - 1, self._latest)

    def write(self, header: RecordingHeader | None) -> None:
        """Write the output, if there are sweeps."""
        if self.journal is None or header is None or not self._kept:
            return
        sweeps = finish(self.journal, header, self.journal.entries(header))
        output, presses = self.journal.output, sweeps["press"].values
        again = (
            f"; --rest-file {output} starts from its unpressed sweeps"
            if UNPRESSED in presses
            else ""
        )
        self.summary = f"{sizes_text(sweeps.sizes)} -> {output}{again}"
