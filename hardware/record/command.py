"""The command that records a skin: its options, and what they mean."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ...simulator.shown import say, terminal
from ..options import (
    Accuracy,
    Baud,
    Interfaces,
    Resource,
    SceneName,
    Settle,
    SwitchName,
    SwitchWith,
    Timeout,
)
from ..scene_data import SceneData
from .output import finish

if TYPE_CHECKING:
    from .journal import Entry
    from .operators import Operator
    from .order import Step
    from .recorder import Task
    from .terminal import Screen


def record_command(
    scene_data: Callable[[str, list[str] | None], SceneData],
) -> Callable[..., None]:
    """The command. scene_data: of a name or path, at interfaces (None: all)."""

    def record(
        scene: SceneName,
        resource: Resource,
        output: Annotated[Path, typer.Option("--output", "-o", help="OUT.nc or OUT.csv.")],
        repetitions: Annotated[int, typer.Option(help="Sweeps of each pixel.")] = 6,
        order: Annotated[Path | None, typer.Option(help="File of presses, one a line.")] = None,
        unattended: Annotated[bool, typer.Option("--unattended", help="Ask nobody.")] = False,
        control: Annotated[
            str | None, typer.Option(help="Press through a virtual meter's HOST:PORT.")
        ] = None,
        press_with: Annotated[
            str | None, typer.Option(help="Press by this command, with {press} filled in.")
        ] = None,
        retries: Annotated[int, typer.Option(help="Unattended repetitions of a sweep.")] = 3,
        interface: Interfaces = None,
        switch: SwitchName = None,
        switch_with: SwitchWith = None,
        settle: Settle = None,
        speed: Annotated[str | None, typer.Option(help="FAST, MEDIUM, SLOW or SLOW2.")] = None,
        averaging: Annotated[int | None, typer.Option(help="Readings averaged, 1-256.")] = None,
        level: Annotated[str | None, typer.Option(help="V, CV or CC.")] = None,
        amplitude: Annotated[float | None, typer.Option(help="Of the level, V or A.")] = None,
        range_: Annotated[int | None, typer.Option("--range", help="1-10; 0 automatic.")] = None,
        delay: Annotated[float | None, typer.Option(help="After the trigger, s.")] = None,
        cable: Annotated[int | None, typer.Option(help="Length of the cable, 0 or 1 m.")] = None,
        repeatability: Annotated[float, typer.Option(help="Allowed between sweeps.")] = 0.05,
        drift: Annotated[float, typer.Option(help="Allowed of the skin at rest.")] = 0.05,
        session: Annotated[
            str, typer.Option(help="Name of this mounting; else the time of its begin.")
        ] = "",
        same_mounting: Annotated[
            bool, typer.Option("--same-mounting", help="Go on days later without being asked.")
        ] = False,
        timeout: Timeout = 5.0,
        baud: Baud = 9600,
        accuracy: Accuracy = None,
    ) -> None:
        """Record sweeps of a scene's presses; run again, it goes on where it was ended."""
        from ...simulator.sweeps import checked_output, counted
        from ..meter.accuracy import DERIVED, read_table
        from ..meter.ending import ending_in_order
        from ..meter.hioki import open_meter
        from ..switch.asked import asked_switch
        from .checks import Limits
        from .journal import Journal
        from .recorder import Task
        from .recorder import record as record_task

        checked_output(output)
        data = scene_data(scene, interface)
        if not (interface or switch or switch_with):
            _check_one_interface(data)
        table = read_table(accuracy or DERIVED)
        steps = _steps(order, data, repetitions)
        settings = _settings(speed, averaging, level, amplitude, range_, delay, cable)
        several = len(data.interfaces) > 1
        screen, operator, ask = _operator(unattended, control, press_with, retries, steps, several)
        task = Task(
            data,
            steps,
            output,
            lambda: open_meter(resource, timeout, baud),
            table,
            settings,
            Limits(repeatability=repeatability, drift=drift),
            session,
            same_mounting,
            asked_switch(switch, switch_with, settle, data.interfaces, ask),
        )
        journal = Journal(output)
        with ending_in_order() as tell, journal.lock(), _how_to_go_on(task):
            checked_output(output)
            with screen:
                header, entries = record_task(replace(task, tell=tell), operator)
            sweeps = finish(journal, header, dict(enumerate(entries)))
            say("; ".join([f"{counted(sweeps.sizes)} -> {output}", *_remarkable(entries)]))

    return record


def _check_one_interface(data: SceneData) -> None:
    """Raises InputError where the scene has several, and nothing says which are measured."""
    from ...simulator.sweeps import InputError

    if len(data.interfaces) > 1:
        raise InputError(
            f"{data.name}: has the interfaces {', '.join(data.interfaces)}, and a meter is at one "
            "at a time; --switch or --switch-with measures all in turn (--switch ask: you "
            f"reconnect it), --interface {data.interfaces[0]} that one alone"
        )


def _steps(order: Path | None, data: SceneData, repetitions: int) -> list[Step]:
    from .order import read_order, standard_order

    if order:
        return read_order(order, data.rows, data.columns)
    return standard_order(data.rows, data.columns, repetitions, data.without_skin)


def _settings(
    speed: str | None,
    averaging: int | None,
    level: str | None,
    amplitude: float | None,
    range_: int | None,
    delay: float | None,
    cable: int | None,
) -> dict[str, Any]:
    from ...simulator.sweeps import InputError

    amplitudes = {"V": "voltage", "CV": "constant_voltage", "CC": "constant_current"}
    held = (level or "V").upper()
    if held not in amplitudes:
        raise InputError(f"`level` must be one of {', '.join(amplitudes)}, got {level}")
    asked = {
        "level": level and held,
        amplitudes[held]: amplitude,
        "range": range_ or None,
        "auto_range": None if range_ is None else range_ == 0,
        "speed": speed and speed.upper(),
        "averaging": averaging,
        "trigger_delay": delay,
        "cable": cable,
    }
    return {name: value for name, value in asked.items() if value is not None}


def _operator(
    unattended: bool,
    control: str | None,
    press_with: str | None,
    retries: int,
    steps: list[Step],
    several: bool,
) -> tuple[Screen, Operator, Callable[[str], None] | None]:
    """Where it is shown, who presses, and a person who connects interfaces, where one is there."""

    from ...simulator.sweeps import InputError
    from .operators import Machine, pressing_by_command, pressing_virtually
    from .terminal import Person, Screen

    console = terminal(stderr=True, highlight=False)
    if control and press_with:
        raise InputError("`control` and `press-with` cannot both press the skin")
    if not (control or press_with or unattended):
        screen = Screen(console, plain=True, several=several)
        person = Person(console, screen)
        return screen, person, person.connect
    if not (control or press_with) and any(step.row for step in steps):
        raise InputError("unattended, a recording is pressed by --control or --press-with")
    screen, by = Screen(console, several=several), _untouched
    if control:
        by = pressing_virtually(control)
    elif press_with:
        by = pressing_by_command(press_with)
    return screen, Machine(by, screen, retries), None


def _untouched(step: Step) -> None:
    """Nothing is pressed by anyone."""


@contextmanager
def _how_to_go_on(task: Task) -> Iterator[None]:
    """Where the block ends early, tell what is kept and how to go on with it."""
    from ..meter.errors import MeterError
    from .journal import Journal

    try:
        yield
    except (KeyboardInterrupt, SystemExit, MeterError):
        journal = Journal(task.output)
        header = journal.header()
        if header is not None:
            say(
                f"rcskin: {len(journal.entries(header))} of {len(header.order)} sweeps are "
                f"kept in {journal.folder}; the same command goes on after them",
                err=True,
            )
        raise


def _remarkable(entries: list[Entry]) -> list[str]:
    """How many sweeps have remarks, and what the meter flagged."""
    from .sweep import flags

    unsound = sum(bool(entry.remarks) for entry in entries)
    flagged = flags([entry.sweep for entry in entries])
    return [f"{unsound} with remarks", *(f"flagged by the meter: {each}" for each in flagged)]
