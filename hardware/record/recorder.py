"""Recording: every press of an order, swept, checked, and on the disk before the next begins."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from ...simulator.sweeps import InputError
from ..meter.accuracy import AccuracyTable
from ..meter.errors import MeterError
from ..meter.hioki import Meter
from ..meter.snapshot import apply, require, restore, snapshot
from ..scene_data import SceneData
from .checks import Judge, Limits
from .journal import Entry, Header, Journal, differences
from .operators import Operator
from .order import REST, Step
from .station import Station
from .sweep import check_frequencies, measure_sweep


@dataclass(frozen=True)
class Task:
    """What is to be recorded. connect: opens the meter. settings: to be set before it begins."""

    scene: SceneData
    order: Sequence[Step]
    output: Path
    connect: Callable[[], Meter]
    table: AccuracyTable
    settings: Mapping[str, Any]
    limits: Limits = Limits()


def record(task: Task, operator: Operator) -> tuple[Header, list[Entry]]:
    """Every sweep of the task, those included that an earlier run has finished.

    Raises InputError where the journal beside the output is of another recording or unreadable,
    MeterError where the operator gives up on a sweep; what is finished stays on the disk.
    """
    journal = Journal(task.output)
    header = _resumed(journal, task)
    entries = journal.entries(header.order) if header else {}
    station = Station(task.connect, header)
    try:
        if header is None:
            header = _begun(journal, task, station)
        judge = Judge(np.array(header.frequencies), task.table, header.settings, task.limits)
        for number in range(len(task.order)):
            if number not in entries:
                entry = _recorded(number, task, station, operator, judge, list(entries.values()))
                journal.keep(number, entry)
                entries[number] = entry
    finally:
        station.close()
    return header, [entries[number] for number in range(len(task.order))]


def _resumed(journal: Journal, task: Task) -> Header | None:
    header = journal.header()
    if header is None:
        return None
    different = differences(header, _asked(task))
    if different:
        raise InputError(
            f"{journal.folder}: holds a recording with another {', '.join(different)}; give "
            "another output, or move that folder away"
        )
    return header


def _begun(journal: Journal, task: Task, station: Station) -> Header:
    meter = station.ready()
    check_frequencies(meter, task.scene.frequencies)
    apply(meter, task.settings)
    settings = snapshot(meter)
    restore(meter, settings)
    station.header = Header(
        **_asked(task), meter=meter.identity.text, settings=settings, begun=_now()
    )
    journal.begin(station.header)
    return station.header


def _recorded(
    number: int,
    task: Task,
    station: Station,
    operator: Operator,
    judge: Judge,
    before: Sequence[Entry],
) -> Entry:
    step = task.order[number]
    alike = [one.sweep for one in before if one.press == step.press and not one.remarks]
    while True:
        try:
            entry = _attempt(number, task, station, operator)
        except MeterError as failure:
            station.close()
            if not operator.again(failure):
                raise
            continue
        remarks = judge.remarks(entry.sweep, alike, step == REST)
        if operator.kept(remarks):
            return Entry(entry.press, entry.sweep, entry.begun, entry.ended, tuple(remarks))


def _attempt(number: int, task: Task, station: Station, operator: Operator) -> Entry:
    meter, step = station.ready(), task.order[number]
    operator.press(step, number, len(task.order))
    begun = _now()
    sweep = measure_sweep(meter, task.scene.frequencies, operator.watch)
    assert station.header is not None
    require(meter, station.header.settings)
    return Entry(step.press, sweep, begun, _now())


def _asked(task: Task) -> dict[str, Any]:
    return {
        "scene": task.scene.text,
        "name": task.scene.name,
        "interface": task.scene.interface,
        "frequencies": tuple(task.scene.frequencies),
        "rows": task.scene.rows,
        "columns": task.scene.columns,
        "order": tuple(step.press for step in task.order),
        "asked": dict(task.settings),
    }


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")
