"""Twins read: by the scene's error model at once, through the virtual meter on TCP by driver and
recorder as a skin would be, and under hands that come and go in the meter's own time.

The meter answers at once, and a clock of its own counts what its readings would take: hands act by
it, and an hour takes minutes. No choice, answer or network is in that time but TALK for a reading.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from rcskin.benchmarks.localization.twins import Twin, WithoutCreep
from rcskin.hardware.control_client import send_request
from rcskin.hardware.live.live_localizer import LiveLocalizer
from rcskin.hardware.live.live_meter import LiveMeter
from rcskin.hardware.live.live_session import TimedAnswer
from rcskin.hardware.meter.instruments import open_meter
from rcskin.hardware.record.measured_sweep import MeasuredSweep, SweepLimits, Watch
from rcskin.hardware.record.operators import (
    MachineOperator,
    RecordingScreen,
    parse_step,
    press_virtual_skin,
)
from rcskin.hardware.record.recorder import RecordingTask, record
from rcskin.hardware.record.recording_journal import recording_dataset
from rcskin.hardware.record_command import header_of
from rcskin.hardware.virtual.meter_server import ControlPort, run_in_thread
from rcskin.hardware.virtual.served_skin import ServedSkin, instrument
from rcskin.simulator.measure.readout import MeterSession
from rcskin.simulator.measure.specimen import MeterSessionErrors
from rcskin.simulator.meters.accuracy_table import DERIVED_TABLE, ReadingConditions, read_table
from rcskin.simulator.press.press import check_press, parse_press
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.sweeps import build, side_by_side
from rich.console import Console

ONE, OWN, HELD = "one", "own", "held"
"""Gain for all ranges; a gain for each; the same, in the ranges of the first sweep throughout."""


def read_at_once(twin: Twin, presses: list[str], session: int = 0, ranges: str = ONE) -> xr.Dataset:
    """Sweeps of a twin with the meter's errors. ranges: ONE, OWN or HELD."""
    scene = twin.scene
    factor = scene.press.capacitance_factor
    asked = [check_press(parse_press(press, factor), scene.parts.skin) for press in presses]
    Z = np.array([twin.impedances(press, event) for event, press in enumerate(asked)])
    return build(
        _measured(Z, scene, np.random.default_rng([twin.seed, twin.number]), ranges),
        scene.frequencies,
        interface=[each.name for each in scene.interfaces],
        press=[str(press) for press in asked],
        row=[press.pixel[0] for press in asked],
        column=[press.pixel[1] for press in asked],
        session=[session] * len(presses),
    ).dataset()


def _measured(Z: np.ndarray, scene: Scene, random: np.random.Generator, ranges: str) -> np.ndarray:
    table = read_table(DERIVED_TABLE)
    used = np.vectorize(table.fitting_range)(Z) if ranges != ONE else np.zeros(Z.shape)
    if ranges == HELD:
        used = np.broadcast_to(used[:1], Z.shape)
    shown = np.empty_like(Z)
    for number in np.unique(used):
        measured = MeterSession(scene.readout, Z.shape[1], random).measure(Z, scene.frequencies)
        shown[used == number] = measured[used == number]
    return shown


TIMEOUT = 120.0
"""s for a reading: the first one of a foreign twin at several interfaces takes some seconds."""


def recorded(twin: Twin, presses: Sequence[str], interfaces: Sequence[str]) -> xr.Dataset:
    """Sweeps of presses, given as text, at one interface after the other under the same hand."""
    parts = [_at(twin, presses, name) for name in interfaces]
    whole = side_by_side(parts).assign_attrs(twin=twin.number)
    return whole.assign_coords(session=("sweep", [twin.number] * len(presses)))


def _at(twin: Twin, presses: Sequence[str], interface: str) -> xr.Dataset:
    scene = twin.scene
    number = [each.name for each in scene.interfaces].index(interface)
    errors = MeterSessionErrors(scene.parts.meter, seed=1000 * twin.number + number)
    skins = {interface: twin.at(interface)}
    first = scene.sweep.frequencies[0]
    readout = lambda Z, at_hand: errors.read(Z, at_hand.frequency, at_hand.range)  # noqa: E731
    meter = instrument(ServedSkin(skins, readout, *scene.pixels.shape, first), pace=0.0)
    steps = [parse_step(press, *scene.pixels.shape) for press in presses]
    with run_in_thread(meter, ControlPort(meter)) as ports, tempfile.TemporaryDirectory() as folder:
        hand = press_virtual_skin(f"{ports.host}:{ports.control}")
        task = RecordingTask(
            header_of(scene.parts, [interface], steps),
            Path(folder) / "twin.nc",
            lambda: open_meter(ports.resource, TIMEOUT),
            read_table(DERIVED_TABLE),
        )
        header, entries = record(
            task, MachineOperator(hand, RecordingScreen(Console(quiet=True)), retries=0)
        )
    return recording_dataset(header, entries)


TALK = 0.008
"""s of a reading beside measuring: commands and their answers."""
TURN = 0.03
"""s of a turn of the switch, settling of its relays included."""
FIRST_TOUCH = 10.0
"""s of rest at the beginning."""


@dataclass(frozen=True)
class Touch:
    """A press of a pixel in column `column` from `begun` to `ended`, s."""

    begun: float
    ended: float
    row: int
    column: int


def visits(random: np.random.Generator, pixels: int, count: int) -> list[Touch]:
    """So many touches of 0.8 to 4 s, 1.5 to 8 s apart, after a time of rest."""
    found, now = [], FIRST_TOUCH
    for _ in range(count):
        begun = now + random.uniform(1.5, 8.0)
        now = begun + random.uniform(0.8, 4.0)
        row, column = random.integers(1, pixels + 1, 2).tolist()
        found.append(Touch(begun, now, row, column))
    return found


@dataclass
class Stage:
    """A twin under hands, at a virtual meter. now: s of the meter's own time.

    interfaces: those that are read; a switch turns between several.
    """

    twin: Twin
    touches: list[Touch]
    interfaces: tuple[str, ...]
    now: float = 0.0
    _held: Touch | None = field(default=None, init=False)
    _press: str = field(default="none", init=False)
    _here: str = field(default="", init=False)

    def __post_init__(self) -> None:
        scene, number = self.twin.scene, 1000 * self.twin.number
        self._benches = {name: self.twin.at(name) for name in self.interfaces}
        self._errors = {
            name: MeterSessionErrors(scene.parts.meter, seed=number + k)
            for k, name in enumerate(self.interfaces)
        }

    def pressed(self, asked: str) -> str:
        """What the hand makes of a press, the same at every interface."""
        (made,) = {bench.check(asked) for bench in self._benches.values()}
        return made

    def impedance(self, interface: str, frequency: float) -> complex:
        """Z in ohm under what the hand does now."""
        self._here = interface
        held = next((each for each in self.touches if each.begun <= self.now < each.ended), None)
        if held is not self._held:
            self._held = held
            self._press = self.pressed(f"{held.row},{held.column}" if held else "none")
        return self._benches[interface].impedance(self._press, frequency)

    def read(self, Z: complex, at_hand: ReadingConditions) -> complex:
        """What the meter makes of it, in its time."""
        self.now += at_hand.seconds + TALK
        return self._errors[self._here].read(Z, at_hand.frequency, at_hand.range)

    @contextmanager
    def link(self, localizer: LiveLocalizer) -> Iterator[LiveMeter]:
        """The meter of a live session, on TCP."""
        scene = self.twin.scene
        seats = {name: Seat(self, name) for name in self.interfaces}
        first = scene.sweep.frequencies[0]
        exhibit = ServedSkin(seats, self.read, *scene.pixels.shape, first)
        meter = instrument(exhibit, pace=0.0)
        with run_in_thread(meter, ControlPort(meter)) as ports:
            switch = Relays(self, f"{ports.host}:{ports.control}")
            link = LiveMeter(
                localizer,
                lambda: open_meter(ports.resource, 5.0),
                read_table(),
                SweepLimits(),
                30.0,
                switch if len(self.interfaces) > 1 else None,
                clock=lambda: self.now,
            )
            self.now = 0.0
            try:
                yield link
            finally:
                link.station.release()
        meter.worker.end()


@dataclass(frozen=True)
class Seat(WithoutCreep):
    """The stage as one of its interfaces sees it."""

    stage: Stage
    interface: str

    def check(self, press: str) -> str:
        """Whoever presses through the control port presses nothing."""
        return self.stage.pressed("none")

    def impedance(self, press: str, frequency: float) -> complex:
        """Z in ohm under what the hand does now."""
        return self.stage.impedance(self.interface, frequency)


@dataclass
class Relays:
    """The virtual meter's switch, whose turns take TURN of the meter's own time."""

    stage: Stage
    control: str
    selected: str | None = field(default=None, init=False)

    def select(self, name: str) -> None:
        """Turn, where it is elsewhere."""
        if name != self.selected:
            send_request(self.control, "select", interface=name)
            self.stage.now += TURN
            self.selected = name

    def check_stayed(self) -> None:
        """Nobody else turns it."""

    def close(self) -> None:
        """Nothing is held."""


@dataclass
class Told:
    """What is shown: answers with the times when they came, s."""

    stage: Any

    def __post_init__(self) -> None:
        self.answers: list[tuple[float, str]] = []

    def reading(self, frequency: float, reading: object) -> None:
        """Not of interest."""

    def answer(self, moment: TimedAnswer) -> None:
        """An answer came."""
        self.answers.append((self.stage.now, moment.answer.label))

    def no_answer(self, why: str) -> None:
        """Not of interest."""

    def note(self, text: str) -> None:
        """Not of interest."""


class Replay:
    """A link whose sweeps were measured before: (begun, ended, sweep). now: s."""

    sweeps = False
    """The readings had times of their own, as of a meter that does not sweep by itself."""

    def __init__(self, link: LiveMeter, sweeps: list[tuple[float, float, MeasuredSweep]]) -> None:
        self.checker, self.header, self.now, self.switch = link.checker, link.header, 0.0, None
        self.left = list(reversed(sweeps))

    def ready(self) -> None:
        """When the next sweep begins."""
        self.now = self.left[-1][0]

    def sweep(self, watch: Watch) -> MeasuredSweep:
        """The next."""
        _, self.now, sweep = self.left.pop()
        return sweep
