"""Hands that come and go on a twin, read through the virtual meter on TCP in the meter's own time.

The meter answers at once, and a clock of its own counts what its readings would take: hands act by
it, and an hour takes minutes. No choice, answer or network is in that time but TALK for a reading.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np
from rcskin.benchmarks.localization.twin_parts.skin import Twin, WithoutCreep
from rcskin.hardware.control_client import send_request
from rcskin.hardware.live.live_localizer import LiveLocalizer
from rcskin.hardware.live.live_meter import LiveMeter
from rcskin.hardware.meter.instruments import open_meter
from rcskin.hardware.record.sweep_checks import SweepLimits
from rcskin.hardware.virtual.control import ControlPort
from rcskin.hardware.virtual.meter_server import run_in_thread
from rcskin.hardware.virtual.served_skin import ServedSkin, instrument
from rcskin.simulator.measure.specimen import MeterSessionErrors
from rcskin.simulator.meters.accuracy_table import ReadingConditions, read_table

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
