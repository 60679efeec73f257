"""The commands `rcskin meter record` and `rcskin meter gather`."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..simulator.requests.number_ranges import REPETITIONS, SHARE, AllowedRange, any_finite
from ..simulator.requests.options import SCENE
from ..simulator.requests.request import Writing, argument, typed
from ..simulator.safe_text import say, terminal
from .options import (
    ACCURACY_TABLE,
    BAUD,
    DRIFT,
    INTERFACES,
    READER_FILE,
    SETTLE_TIME,
    SOURCE,
    SWITCH_NAME,
    SWITCH_WITH,
    TIMEOUT,
)

if TYPE_CHECKING:
    from ..simulator.scene.parts import SceneParts, Setup, Skin
    from .record.operators import Operator, PressStep, RecordingScreen
    from .record.recording_journal import RecordingHeader, RecordingJournal


class Record(
    Writing, example="meter record sheet-5x5 --resource TCPIP0::127.0.0.1::3500::SOCKET -o run.nc"
):
    """Record sweeps of a scene's presses. The same command continues a stopped recording."""

    scene: str = argument(SCENE)
    resource: str = typed(SOURCE)
    output: Path = typed("OUT.nc or OUT.csv.", "--output", "-o")
    repetitions: int = typed("Sweeps of each pixel.", within=REPETITIONS, default=6)
    order: Path | None = typed("File with one press per line.", default=None)
    unattended: bool = typed("Never ask.", default=False)
    control: str | None = typed("Press by the virtual meter at HOST:PORT.", default=None)
    press_with: str | None = typed("Command that presses; {press} is replaced.", default=None)
    retries: int = typed(
        "Repetitions of a sweep without a person.",
        within=AllowedRange(0, 1000, "after so many failures, check the meter"),
        default=3,
    )
    interface: Sequence[str] | None = typed(INTERFACES, default=None)
    switch: str | None = typed(SWITCH_NAME, default=None)
    switch_with: str | None = typed(SWITCH_WITH, default=None)
    settle: float | None = typed(SETTLE_TIME, default=None)
    speed: str | None = typed("FAST to SLOW2 (Hioki), SHORT to LONG (Keysight).", default=None)
    averaging: int | None = typed("Readings averaged, 1-256.", default=None)
    level: str | None = typed("V, CV or CC.", default=None)
    amplitude: float | None = typed(
        "Amplitude of the level, V or A.", within=any_finite(None), default=None
    )
    range_: float | None = typed(
        "Range 1-10 (Hioki) or ohm (Keysight); 0: automatic.",
        "--range",
        within=any_finite("ohm"),
        default=None,
    )
    delay: float | None = typed("Delay after the trigger, s.", within=any_finite("s"), default=None)
    cable: int | None = typed("Cable length, m.", within=any_finite("m"), default=None)
    repeatability: float = typed(
        "Allowed change of |Z| between repetitions.", within=SHARE, default=0.05
    )
    drift: float = typed(DRIFT, default=0.05)
    session: str = typed("Name of this mounting; default: the start time.", default="")
    same_mounting: bool = typed("Continue days later without a question.", default=False)
    timeout: float = typed(TIMEOUT, default=5.0)
    baud: int = typed(BAUD, default=9600)
    accuracy: Path | None = typed(ACCURACY_TABLE, default=None)
    reader: Path | None = typed(READER_FILE, default=None)

    def run(self) -> None:
        from ..simulator.requests.requested_scene import requested_scene, warn_of_earth
        from ..simulator.sweeps import checked_output, sizes_text
        from .event_counter import EventCounter
        from .meter.termination import interruptible, orderly_termination
        from .record.managed_meter import SourceOptions, source_setup
        from .record.measured_sweep import SweepLimits
        from .record.recorder import RecordingTask
        from .record.recorder import record as record_task
        from .record.recording_journal import (
            RecordingJournal,
            explain_resuming,
            finish,
            summary_remarks,
        )
        from .switch.switch_options import switch_from_options

        checked_output(self.output)
        requested = requested_scene(self.scene)
        interfaces = requested.parts.setup.checked_names(self.interface)
        options = SourceOptions(self.resource, self.timeout, self.baud, self.accuracy, self.reader)
        if not (self.interface or self.switch or self.switch_with or options.is_reader):
            _check_one_interface(requested.parts.skin, requested.parts.setup)
        steps = _steps(self.order, requested.parts.skin, self.repetitions)
        settings = _settings(
            self.speed,
            self.averaging,
            self.level,
            self.amplitude,
            self.range_,
            self.delay,
            self.cable,
        )
        several = len(interfaces) > 1
        header = header_of(requested.parts, interfaces, steps, settings, self.session)
        faults = EventCounter(lambda text: say(f"rcskin: {text}", err=True))
        source = source_setup(
            options,
            header.by_interface,
            report=faults,
            settings=settings,
            kind=requested.parts.setup.kind,
        )
        screen, operator, ask = _operator(
            self.unattended, self.control, self.press_with, self.retries, steps, several
        )
        task = RecordingTask(
            header,
            self.output,
            source.connect,
            source.table,
            SweepLimits(
                repeatability=self.repeatability,
                drift=self.drift,
                two_terminal=requested.parts.skin.two_terminal and source.checks_laws,
            ),
            self.same_mounting,
            source.switch_or(
                lambda: switch_from_options(
                    self.switch, self.switch_with, self.settle, interfaces, ask
                ),
                any((self.switch, self.switch_with, self.settle is not None)),
            ),
            conditions=source.conditions,
        )
        warn_of_earth(self.scene, requested.parts.skin)
        journal = RecordingJournal(self.output)
        with orderly_termination() as report, journal.lock(), explain_resuming(journal):
            checked_output(self.output)
            with screen:
                header, entries = record_task(replace(task, report=report), operator)
                faults.close()
            with interruptible():
                sweeps = finish(journal, header, dict(enumerate(entries)))
            say(
                "; ".join(
                    [f"{sizes_text(sweeps.sizes)} -> {self.output}", *summary_remarks(entries)]
                )
            )


def header_of(
    parts: SceneParts,
    interfaces: Sequence[str],
    steps: Sequence[PressStep],
    settings: Mapping[str, Any] | None = None,
    session: str = "",
) -> RecordingHeader:
    """Header of a recording before a meter is connected.

    settings: requested settings of the meter. session: name of the mounting, or empty.
    """
    from .record.recording_journal import RecordingHeader

    setup = parts.setup.of(interfaces)
    whole = tuple(setup.frequency.tolist())
    own = {name: tuple(each) for name, each in setup.own.items()}
    return RecordingHeader(
        scene=parts.text,
        name=parts.skin.name,
        interfaces=tuple(interfaces),
        frequencies=whole,
        rows=parts.skin.pixels.rows,
        columns=parts.skin.pixels.columns,
        order=tuple(step.press for step in steps),
        asked=dict(settings or {}),
        session=session,
        of_each={name: each for name, each in own.items() if each != whole},
    )


def _check_one_interface(skin: Skin, setup: Setup) -> None:
    """Raises InputError if the scene has several interfaces and no option selects any."""
    from ..simulator.sweeps import InputError

    names = setup.names
    if len(names) > 1:
        raise InputError(
            f"{skin.name}: has the interfaces {', '.join(names)}, and a meter connects to one "
            "at a time; --switch or --switch-with measures all in turn (--switch ask: you "
            f"reconnect the meter), --interface {names[0]} measures that one alone"
        )


def _steps(order: Path | None, skin: Skin, repetitions: int) -> list[PressStep]:
    from itertools import product

    from ..simulator.press.pixels import pixels_with_skin
    from .record.operators import read_order, standard_order

    rows, columns = skin.pixels.shape
    if order:
        return read_order(order, rows, columns)
    every = product(range(1, rows + 1), range(1, columns + 1))
    without = set(every) - set(pixels_with_skin(skin))
    return standard_order(rows, columns, repetitions, without)


def _settings(
    speed: str | None,
    averaging: int | None,
    level: str | None,
    amplitude: float | None,
    range_: float | None,
    delay: float | None,
    cable: int | None,
) -> dict[str, Any]:
    from ..simulator.sweeps import InputError

    amplitudes = {"V": "voltage", "CV": "constant_voltage", "CC": "constant_current"}
    quantity = (level or "V").upper()
    if quantity not in amplitudes:
        raise InputError(f"`level` must be one of {', '.join(amplitudes)}, got {level}")
    requested = {
        "level": level and quantity,
        amplitudes[quantity]: amplitude,
        "range": range_ or None,
        "auto_range": None if range_ is None else range_ == 0,
        "speed": speed and speed.upper(),
        "averaging": averaging,
        "trigger_delay": delay,
        "cable": cable,
    }
    return {name: value for name, value in requested.items() if value is not None}


def _operator(
    unattended: bool,
    control: str | None,
    press_with: str | None,
    retries: int,
    steps: list[PressStep],
    several: bool,
) -> tuple[RecordingScreen, Operator, Callable[[str], None] | None]:
    """Screen, operator, and the prompt that asks a person to connect an interface, or None."""

    from ..simulator.sweeps import InputError
    from .record.operators import (
        MachineOperator,
        PersonOperator,
        RecordingScreen,
        press_by_command,
        press_virtual_skin,
    )

    console = terminal(stderr=True, highlight=False)
    if control and press_with:
        raise InputError("`control` and `press-with` cannot both press the skin")
    if not (control or press_with or unattended):
        screen = RecordingScreen(console, plain=True, several=several)
        person = PersonOperator(console, screen)
        return screen, person, person.connect
    if not (control or press_with) and any(step.row for step in steps):
        raise InputError("--unattended needs --control or --press-with to press the skin")
    screen, by = RecordingScreen(console, several=several), _press_nothing
    if control:
        by = press_virtual_skin(control)
    elif press_with:
        by = press_by_command(press_with)
    return screen, MachineOperator(by, screen, retries), None


def _press_nothing(step: PressStep) -> None:
    """Leave the skin untouched."""


class Gather(Writing, example="meter gather run.nc -o so-far.nc"):
    """Write the sweeps that a recording or a live session has so far.

    The recording can continue afterwards.
    """

    recording: Path = argument("Output file of the recording.")
    output: Path | None = typed("Another OUT.nc or OUT.csv.", "--output", "-o", default=None)

    def run(self) -> None:
        from ..simulator.sweeps import InputError, checked_output, sizes_text
        from .record.recording_journal import RecordingJournal, write_all

        journal = RecordingJournal(self.recording)
        header = journal.header()
        entries = journal.entries(header) if header else {}
        if header is None or not entries:
            raise InputError(f"{journal.folder}: holds no sweep of a recording")
        path = checked_output(self.output or self.recording)
        sweeps = write_all(path, header, entries)
        whole = f" of {len(header.order)}" if header.order else ""
        say(f"{len(entries)}{whole} sweeps: {sizes_text(sweeps.sizes)} -> {path}")
        _warn_if_meter_changed(journal)


def _warn_if_meter_changed(journal: RecordingJournal) -> None:
    """Log the original settings of a meter that a killed command left changed."""
    from ..simulator.sweeps import InputError
    from .meter.lcr_meter import settings_text

    with suppress(InputError), journal.lock():  # a running recording has the lock
        if found := journal.original_settings():
            logging.getLogger(__name__).warning(
                "%s: a killed command left the meter's settings changed; the same command restores "
                "the original ones: %s",
                journal.folder,
                settings_text(found[1]),
            )
