"""Readings of a sensor at a moment, and the times at which its meter takes them without end.

Times are whole femtoseconds, independent of how a sensor's steps are divided.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..arrays import Mask, Real
from ..measure.foam_state import reading_spans
from ..scene.parts import Meter, Setup
from ..sweeps.reading_quantities import reading_name
from .given_press import PressLabel

PER_SECOND = 10**15
"""Ticks of the clock per second: steps of 1 s, 1/60 s or 1/1000 s add up without an error."""


def in_ticks(seconds: float) -> int:
    """Time in whole ticks of the clock."""
    return round(seconds * PER_SECOND)


class ReadingSlot(NamedTuple):
    """One reading of a sweep, or all tones of a multisine at one interface.

    frequencies: range of their numbers. middle, end: ticks after the start of the sweep.
    """

    interface: int
    frequencies: slice
    middle: int
    end: int


class DueReading(NamedTuple):
    """A reading at its time. number: counted over all sweeps from 0. middle, end: ticks."""

    number: int
    slot: ReadingSlot
    middle: int
    end: int


@dataclass(frozen=True)
class ReadingClock:
    """Slots of one sweep in the order of the meter, and the ticks of a whole sweep."""

    slots: tuple[ReadingSlot, ...]
    period: int

    @classmethod
    def of(cls, setup: Setup, meter: Meter) -> ReadingClock:
        """Clock of a scene's meter; sweeps follow each other without a pause."""
        starts, durations, whole = reading_spans(setup, meter)
        taken, slots = setup.read, []
        for interface in range(len(taken)):
            own = np.flatnonzero(taken[interface]).tolist()
            together = [slice(0, len(own))] if meter.readout.multisine else map(_alone, own)
            for some in together:
                start, takes = (float(each[interface, some.start]) for each in (starts, durations))
                middle, end = in_ticks(start + takes / 2), in_ticks(start + takes)
                slots.append(ReadingSlot(interface, some, middle, end))
        return cls(tuple(slots), in_ticks(whole))

    def due(self, after: int, until: int) -> Iterator[DueReading]:
        """Readings whose middle lies after one time and not after another, ticks."""
        number = self._first_after(after)
        while True:
            sweep, slot = divmod(number, len(self.slots))
            start, own = sweep * self.period, self.slots[slot]
            if start + own.middle > until:
                return
            yield DueReading(number, own, start + own.middle, start + own.end)
            number += 1

    def _first_after(self, time: int) -> int:
        sweep, rest = divmod(time, self.period)
        return sweep * len(self.slots) + bisect_right(self._middles, rest)

    @cached_property
    def _middles(self) -> list[int]:
        return [slot.middle for slot in self.slots]


def _alone(frequency: int) -> slice:
    return slice(frequency, frequency + 1)


class TakenReading(NamedTuple):
    """A reading whose middle is past. values: shape (quantity, skin, frequency)."""

    due: DueReading
    values: Real
    labels: tuple[PressLabel, ...]


@dataclass(frozen=True, eq=False)
class VectorLayout:
    """Order of the numbers in `SensorReading.vector`: quantity by quantity, in the meter's order.

    read: mask of the readings, shape (interface, frequency).
    """

    quantities: tuple[str, ...]
    names: tuple[str, ...]
    units: tuple[str, ...]
    read: Mask

    @classmethod
    def of(cls, setup: Setup) -> VectorLayout:
        """Layout for the readings of a scene."""
        each = [
            (
                reading_name(quantity.name, setup.interfaces[i].name, float(setup.frequency[k])),
                quantity.units,
            )
            for quantity in setup.kind.quantities
            for i, k in np.argwhere(setup.read)
        ]
        names, units = zip(*each, strict=True)
        return cls(setup.kind.names, names, units, setup.read)


@dataclass(frozen=True, eq=False)
class SensorReading:
    """Latest value of each reading of a batch of skins, NaN before the first one.

    time: time by the sensor's clock, s. values: shape (quantity, skin, interface, frequency),
    read-only. taken_at: end of each reading, s, shape (interface, frequency), NaN before the first
    one. fresh: True for readings that ended within the last step, shape (interface, frequency).
    limited: True for skins whose contacts would compress the foam further than it can be, or than
    the model covers, and are limited to that, shape (skin,). beside: force that touches the body of
    a mounted skin and not the skin, N, shape (skin,).
    """

    time: float
    values: Real
    taken_at: Real
    fresh: Mask
    limited: Mask
    layout: VectorLayout
    beside: Real

    @property
    def Rs(self) -> Real:
        """Series resistance, ohm, shape (skin, interface, frequency)."""
        return self._quantity("Rs")

    @property
    def X(self) -> Real:
        """Series reactance, ohm, shape (skin, interface, frequency)."""
        return self._quantity("X")

    @property
    def Cp(self) -> Real:
        """Parallel capacitance, F, shape (skin, interface, frequency)."""
        return self._quantity("Cp")

    @property
    def gain(self) -> Real:
        """Gain at the node, |V / V_s|, shape (skin, interface, frequency)."""
        return self._quantity("gain")

    @property
    def gain_phase(self) -> Real:
        """Phase of V / V_s, rad, shape (skin, interface, frequency)."""
        return self._quantity("gain_phase")

    @cached_property
    def vector(self) -> Real:
        """All readings of each skin in the order of `Sensor.names`, shape (skin, n)."""
        read = self.values[:, :, self.layout.read]
        return np.ascontiguousarray(read.swapaxes(0, 1)).reshape(read.shape[1], -1)

    def _quantity(self, name: str) -> Real:
        if name not in self.layout.quantities:
            known = ", ".join(self.layout.quantities)
            raise AttributeError(f"readings of this scene have no {name}: they have {known}")
        return self.values[self.layout.quantities.index(name)]
