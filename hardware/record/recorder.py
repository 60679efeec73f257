"""Recorder: measures and checks each press of an order, and saves it before the next."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from ...simulator.sweeps import InputError
from ..meter.errors import MeterError
from ..meter.instruments import instrument_of
from ..meter.lcr_meter import require_settings, restore_settings
from ..meter.meter_reading import ReadingSource
from ..meter.termination import interruptible
from ..switch.switch import Switch
from .managed_meter import ManagedMeter
from .measured_sweep import (
    ConditionsOf,
    ErrorTable,
    MeasuredSweep,
    SweepChecker,
    SweepLimits,
    check_frequencies,
    frozen_remarks,
    measure_sweep,
    now,
    undetected_press,
)
from .operators import UNPRESSED_STEP, Operator, PressStep, StepStatus, parse_step
from .recording_journal import (
    JournalEntry,
    RecordingHeader,
    RecordingJournal,
    differences,
    warn_if_clock_set_back,
)

ETA_STEPS = 12
"""Number of latest steps that the estimate of the time left uses."""
REMOUNT_HOURS = 12.0
"""Hours after which the skin may have been mounted anew."""


@dataclass(frozen=True)
class RecordingTask:
    """Specification of a recording. connect: opens the meter.

    header: with the fields that are known before the meter is connected; an empty session becomes
    the start time. same_mounting: True if the user said that the skin was not mounted anew. switch:
    connects the meter to one of the interfaces; None if there is one. report: reports settings that
    could not be restored. conditions: of a reading; None: those of the meter that answers.
    """

    header: RecordingHeader
    output: Path
    connect: Callable[[], ReadingSource]
    table: ErrorTable
    limits: SweepLimits = SweepLimits()
    same_mounting: bool = False
    switch: Switch | None = None
    report: Callable[[str], None] = lambda text: None
    conditions: ConditionsOf | None = None

    @cached_property
    def order(self) -> list[PressStep]:
        """Presses in their order."""
        header = self.header
        return [parse_step(press, header.rows, header.columns) for press in header.order]


def record(task: RecordingTask, operator: Operator) -> tuple[RecordingHeader, list[JournalEntry]]:
    """Record all sweeps of the task. Returns them with those of earlier runs.

    Raises InputError if the journal next to the output belongs to another recording or mounting or
    is unreadable, MeterError if the operator gives up on a sweep, KeyboardInterrupt if the operator
    ends the recording. Finished sweeps stay on the disk.
    """
    journal = RecordingJournal(task.output)
    with interruptible():
        header = _resumed_header(journal, task)
        entries = journal.entries(header) if header else {}
        if entries and len(entries) < len(task.order) and not task.same_mounting:
            _confirm_mounting(journal, entries.values(), operator)
    station = ManagedMeter(task.connect, header, task.report, journal, task.switch)
    with station, interruptible():
        if header is None:
            header = _start(journal, task, station)
        judge = SweepChecker(
            task.table,
            header.settings,
            task.limits,
            task.conditions or instrument_of(header.meter).conditions,
        )
        run = RecordingRun(task, station, operator, judge, entries)
        missing = deque(number for number in range(len(task.order)) if number not in entries)
        while missing:
            entry = run.step(missing[0])
            if entry is None:
                missing.appendleft(max(missing[0] - 1, 0))
                continue
            journal.keep(missing[0], entry)
            warn_if_clock_set_back(entry, entries.get(missing[0] - 1))
            entries[missing.popleft()] = entry
    return header, [entries[number] for number in range(len(task.order))]


@dataclass
class RecordingRun:
    """One run of a task. entries: finished sweeps by their place in the order."""

    task: RecordingTask
    station: ManagedMeter
    operator: Operator
    judge: SweepChecker
    entries: Mapping[int, JournalEntry]
    _ends: list[float] = field(default_factory=lambda: [time.monotonic()], init=False)

    def step(self, number: int) -> JournalEntry | None:
        """Sweep that the operator keeps; None if the step before is to be repeated.

        Raises MeterError if the operator gives up, KeyboardInterrupt if the operator ends it.
        """
        step = self.task.order[number]
        before = [entry for place, entry in sorted(self.entries.items()) if place < number]
        sound = [entry for entry in before if not entry.remarks]
        same_press = [entry.sweep for entry in sound if entry.press == step.press]
        baselines = [entry.sweep for entry in sound if entry.press == UNPRESSED_STEP.press]
        progress = self._progress(number, baselines)
        while True:
            try:
                entry = self._attempt(step, progress)
            except MeterError as failure:
                self.station.close()
                if not self.operator.again(failure):
                    raise
                continue
            if entry is None:
                return None
            remarks = self.judge.remarks(entry.sweep, same_press, step == UNPRESSED_STEP)
            remarks += frozen_remarks(entry.sweep, sound[-1].sweep if sound else None, baselines)
            if step != UNPRESSED_STEP:
                remarks += undetected_press(entry.sweep, baselines)
            if self.operator.kept(remarks):
                self._ends.append(time.monotonic())
                return replace(entry, remarks=tuple(remarks))

    def _attempt(self, step: PressStep, progress: StepStatus) -> JournalEntry | None:
        meter, task = self.station.ready(), self.task
        if not self.operator.press(step, progress):
            return None
        begun = now()
        header = self.station.header
        assert header is not None
        show = self.operator.show
        sweep = measure_sweep(meter, header.by_interface, task.switch, show.reading, show.turn)
        require_settings(meter, header.settings)
        return JournalEntry(step.press, sweep, begun, now())

    def _progress(self, number: int, baselines: Sequence[MeasuredSweep]) -> StepStatus:
        """Progress; the time left is estimated by the median of this run's latest steps."""
        total = len(self.task.order)
        taken = np.diff(self._ends[-ETA_STEPS:])
        left = float(np.median(taken)) * (total - number) if taken.size else None
        return StepStatus(number, total, left, baselines[-1] if baselines else None)


def _resumed_header(journal: RecordingJournal, task: RecordingTask) -> RecordingHeader | None:
    header = journal.header()
    if header is None:
        return None
    different = differences(header, task.header)
    if different:
        raise InputError(
            f"{journal.folder}: holds a recording that differs in {', '.join(different)}; give "
            "another output, or move that folder away"
        )
    return header


def _confirm_mounting(
    journal: RecordingJournal, entries: Iterable[JournalEntry], operator: Operator
) -> None:
    hours = (time.time() - max(entry.time for entry in entries)) / 3600
    ago = f"{hours:.0f} hours ago" if hours < 48 else f"{hours / 24:.0f} days ago"
    if hours > REMOUNT_HOURS and not operator.same_mounting(ago):
        raise InputError(
            f"{journal.folder}: the last sweep was taken {ago}; --same-mounting continues if the "
            "skin was not mounted anew. A new mounting is a session of its own: `rcskin meter "
            f"gather {journal.output}` writes the sweeps so far, `rcskin join` joins the files"
        )


def _start(
    journal: RecordingJournal, task: RecordingTask, station: ManagedMeter
) -> RecordingHeader:
    meter = station.ready()
    measured = check_frequencies(meter, task.header.frequencies)
    meter.apply_settings(task.header.asked)
    settings = meter.snapshot()
    restore_settings(meter, settings)
    begun = now()
    station.header = replace(
        task.header.at(measured),
        meter=meter.identity.text,
        settings=settings,
        begun=begun,
        session=task.header.session or begun,
        accuracy=task.table.name,
    )
    journal.begin(station.header)
    return station.header
