"""Times of a meter's readings that follow each other without end, in whole femtoseconds.

Whole numbers make the times independent of how a sensor's steps are divided.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..measure.creeping_sweeps import reading_spans
from ..scene.parts import Meter, Setup

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
