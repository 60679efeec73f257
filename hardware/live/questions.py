"""A sweep of which each reading decides what is read next."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ..meter.reading import Reading
from ..record.sweep import Sweep, Watch
from .answer import Localizer, Questions
from .link import Link

USUAL = 0.02
"""s that a reading takes where none was taken yet."""


@dataclass
class Pace:
    """How long readings take at each frequency, as they come, by a clock in s.

    show: is told of each, too.
    """

    localizer: Localizer
    show: Watch
    clock: Callable[[], float]
    _latest: dict[float, float] = field(default_factory=dict, init=False)
    _since: float = field(default=0.0, init=False)

    def begin(self) -> None:
        """A sweep begins."""
        self._since = self.clock()

    def reading(self, frequency: float, reading: Reading) -> None:
        """A reading came, at a frequency in Hz."""
        self._latest[frequency] = self.clock() - self._since
        self.show(frequency, reading)
        self._since = self.clock()

    @property
    def seconds(self) -> NDArray[np.float64]:
        """At each of the localizer's frequencies, shape (frequency,)."""
        known = [self._latest.get(f, USUAL) for f in self.localizer.frequencies]
        return np.maximum(known, 1e-4)


def questioned(link: Link, questions: Questions, pace: Pace) -> tuple[NDArray[np.float64], Sweep]:
    """The frequencies in Hz that were read, ascending, and the readings. Raises MeterError."""
    asked: list[float] = []

    def next_ones() -> Iterator[float]:
        while (frequency := questions.next(pace.seconds)) is not None:
            pace.begin()
            asked.append(frequency)
            yield frequency

    def watch(frequency: float, reading: Reading) -> None:
        pace.reading(frequency, reading)
        questions.tell(frequency, complex(reading.Rs, reading.X))

    sweep = link.sweep(watch, next_ones())
    order = np.argsort(asked)

    def sorted_(values: tuple) -> tuple:
        return tuple(values[k] for k in order)

    (trace,) = sweep.traces
    parts = {name: sorted_(getattr(trace, name)) for name in ("Cp", "Rs", "X", "status")}
    return np.array(asked)[order], Sweep((replace(trace, **parts),))
