"""Adaptive sweep: each reading decides the next frequency and interface."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.arrays import Real
from ..meter.meter_reading import MeterReading
from ..record.measured_sweep import MeasuredSweep, Watch
from .live_meter import LiveMeter
from .timed_switch import TimedSwitch

if TYPE_CHECKING:
    from ...localization.filtering.adaptive_sweep import AdaptiveSweep
    from ...localization.model.localizer_model import Model

DEFAULT_SECONDS = 0.02
"""Assumed time of a reading before the first one, s."""


@dataclass
class ReadingTimes:
    """Times of readings at each frequency, measured by a clock in s.

    on_reading: called with each reading. switch: measures the times of turns, which are no part of
    a reading's time; None without a switch.
    """

    model: Model
    on_reading: Watch
    clock: Callable[[], float]
    switch: TimedSwitch | None = None
    _latest: dict[float, float] = field(default_factory=dict, init=False)
    _since: float = field(default=0.0, init=False)

    def begin(self) -> None:
        """Note the start of a reading."""
        self._since = self._now()

    def reading(self, frequency: float, reading: MeterReading) -> None:
        """Note a reading at a frequency in Hz."""
        self._latest[frequency] = self._now() - self._since
        self.on_reading(frequency, reading)
        self._since = self._now()

    @property
    def seconds(self) -> Real:
        """Expected times at the model's readings, s, shape (interface, frequency)."""
        known = [self._latest.get(f, DEFAULT_SECONDS) for f in self.model.frequencies]
        names = self.model.interfaces
        turning = np.zeros(len(names))
        if self.switch is not None:
            away = np.array([name != self.switch.selected for name in names])
            turning = np.where(away, self.switch.last_seconds, 0.0)
        return np.maximum(known, 1e-4) + turning[:, None]

    def _now(self) -> float:
        """Present time without the turns of the switch, s."""
        return self.clock() - (self.switch.total_seconds if self.switch else 0.0)


def measure_adaptively(
    meter: LiveMeter, adaptive_sweep: AdaptiveSweep, times: ReadingTimes
) -> MeasuredSweep:
    """Measure what the adaptive sweep requests, until it is certain. Raises MeterError."""
    requested: list[tuple[str, float]] = []

    def next_ones() -> Iterator[tuple[str, float]]:
        while (wanted := adaptive_sweep.next(times.seconds)) is not None:
            times.begin()
            requested.append(wanted)
            yield wanted

    def watch(frequency: float, reading: MeterReading) -> None:
        times.reading(frequency, reading)
        adaptive_sweep.add_reading(*requested[-1], reading.value)

    return meter.readings(watch, next_ones())
