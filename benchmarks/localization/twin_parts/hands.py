"""Hands that come and go on a twin, read through the virtual meter on TCP in the meter's own time.

The meter answers at once, and a clock of its own counts what its readings would take: hands act by
it, and an hour takes minutes. No choice, answer or network is in that time but TALK for a reading.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np
from rcskin.benchmarks.localization.twin_parts.recording import scene_data
from rcskin.benchmarks.localization.twin_parts.skin import Twin
from rcskin.hardware.live.answer import Localizer
from rcskin.hardware.live.link import Link
from rcskin.hardware.meter.accuracy import Conditions, read_table
from rcskin.hardware.meter.hioki import open_meter
from rcskin.hardware.record.checks import Limits
from rcskin.hardware.virtual.control import Control
from rcskin.hardware.virtual.server import running
from rcskin.hardware.virtual.serving import instrument, simulated
from rcskin.simulator.measure.specimen import SessionErrors

TALK = 0.008
"""s of a reading beside measuring: commands and their answers."""
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
    """A twin under hands, at a virtual meter. now: s of the meter's own time."""

    twin: Twin
    touches: list[Touch]
    now: float = 0.0
    _held: Touch | None = field(default=None, init=False)
    _press: str = field(default="none", init=False)

    def __post_init__(self) -> None:
        scene = self.twin.scene
        self._bench = self.twin.at(scene.interfaces[0].name)
        self._errors = SessionErrors(scene, seed=1000 * self.twin.number)

    def check(self, press: str) -> str:
        """Whoever presses through the side door presses nothing."""
        return self._bench.check("none")

    def impedance(self, press: str, frequency: float) -> complex:
        """Z in ohm under what the hand does now."""
        held = next((each for each in self.touches if each.begun <= self.now < each.ended), None)
        if held is not self._held:
            self._held = held
            self._press = self._bench.check(f"{held.row},{held.column}" if held else "none")
        return self._bench.impedance(self._press, frequency)

    def read(self, Z: complex, at_hand: Conditions) -> complex:
        """What the meter makes of it, in its time."""
        self.now += at_hand.seconds + TALK
        return self._errors.read(Z, at_hand.range)

    @contextmanager
    def link(self, localizer: Localizer) -> Iterator[Link]:
        """The meter of a live session, on TCP."""
        scene = self.twin.scene
        name = scene.interfaces[0].name
        meter = instrument(simulated(scene_data(scene, name), {name: self}, self.read), pace=0.0)
        with running(meter, Control(meter)) as ports:
            link = Link(
                localizer, lambda: open_meter(ports.resource, 5.0), read_table(), Limits(), 30.0
            )
            self.now = 0.0
            try:
                yield link
            finally:
                link.leave()
        meter.worker.end()
