"""Live session: one sweep and one answer after the other, also after failures of the meter."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

import numpy as np

from ...simulator.arrays import Real
from ...simulator.sweeps import UNPRESSED
from ..meter.errors import MeterError
from ..meter.meter_reading import MeterReading
from ..record.measured_sweep import (
    MeasuredSweep,
    Watch,
    flag_remarks,
    frozen_remarks,
    now,
    switching_remarks,
)
from ..record.operators import UNKNOWN
from .live_baseline import LiveBaseline, says_unpressed
from .live_meter import LiveMeter, TimedSwitch
from .session_log import BaselineDataset, SessionLog, model_dataset
from .touch_answer import TouchAnswer

if TYPE_CHECKING:
    import xarray as xr

    from ...localization.filtering.adaptive import AdaptiveSweep
    from ...localization.model.localizer_model import Model
    from .live_localizer import LiveLocalizer

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


RATE_ANSWERS = 10
MAX_BASELINE_TRIALS = 5
END_KEY, BASELINE_KEY = "q", "r"


@dataclass(frozen=True)
class TimedAnswer:
    """One answer with its sweep and times.

    baseline: unpressed sweeps with which it was compared. at: ISO 8601. measuring, localizing: s.
    since_before: s from the start of the previous sound sweep, the longest time from a touch to
    this answer; None for the first. rate: answers per second. failed: sweeps lost so far. remarks:
    notes about this answer.
    """

    answer: TouchAnswer
    sweep: MeasuredSweep
    baseline: tuple[MeasuredSweep, ...]
    at: str
    measuring: float
    localizing: float
    since_before: float | None
    rate: float | None
    failed: int
    remarks: tuple[str, ...] = ()

    @property
    def latency(self) -> float:
        """Seconds from the sweep's start to the answer."""
        return self.measuring + self.localizing


@dataclass(frozen=True)
class TimedSweep:
    """A sweep. begun, ended: s. gap: s since the one before. part: chose its readings, if any."""

    sweep: MeasuredSweep
    begun: float = 0.0
    ended: float = 0.0
    gap: float = 0.0
    part: AdaptiveSweep | None = None

    @property
    def during(self) -> float:
        """Duration, s."""
        return self.ended - self.begun


class SessionDisplay(Protocol):
    """Shows a session. lasting: True if what is shown stays after the session."""

    @property
    def lasting(self) -> bool: ...

    def reading(self, frequency: float, reading: MeterReading) -> None:
        """Show a reading of the present sweep, at a frequency in Hz."""
        ...

    def answer(self, moment: TimedAnswer) -> None:
        """Show an answer."""
        ...

    def no_answer(self, why: str) -> None:
        """Show that there is no answer, and why; the previous answer is no longer valid."""
        ...

    def note(self, text: str) -> None:
        """Show a note; the answer stays."""
        ...


@dataclass
class LiveSession:
    """A localizer at a meter. key: returns the last pressed key, or an empty string.

    clock: times the sweeps, s.
    """

    localizer: LiveLocalizer
    meter: LiveMeter
    baseline: LiveBaseline
    display: SessionDisplay
    log: SessionLog
    key: Callable[[], str] = lambda: ""
    clock: Callable[[], float] = time.perf_counter
    answers: int = field(default=0, init=False)
    failed: int = field(default=0, init=False)
    _begun: float | None = field(default=None, init=False)
    _ended: float | None = field(default=None, init=False)
    _failure: str = field(default="", init=False)
    _latest: MeasuredSweep | None = field(default=None, init=False)
    _reading_times: ReadingTimes = field(init=False)
    _ends: deque[float] = field(default_factory=lambda: deque(maxlen=RATE_ANSWERS), init=False)
    _baseline_trials: int = field(default=0, init=False)
    _baseline_cache: BaselineDataset = field(init=False)

    def __post_init__(self) -> None:
        self._reading_times = ReadingTimes(
            self.localizer.model, self.display.reading, self.clock, self.meter.switch
        )
        self._baseline_cache = BaselineDataset(self.baseline, self.localizer.model)

    def run(self, answers: int | None = None) -> None:
        """Answer until the given number of answers or the end key.

        Raises MeterError if the meter fails for too long or the unpressed skin is not stable,
        InputError if meter and model do not fit each other.
        """
        self._request_baseline()
        if self.baseline.complete:
            self._prepare()
        while answers is None or self.answers < answers:
            key = self.key()
            if key == END_KEY:
                return
            if key == BASELINE_KEY and self.baseline.wanted:
                self.baseline.forget()
                self._request_baseline()
            self.step()

    def step(self) -> None:
        """Measure once and show the answer, or why there is none. Raises the errors of `run`."""
        try:
            self.meter.ready()
            at, begun = now(), self.clock()
            measured = self._measured(begun)
        except MeterError as failure:
            self._fail(failure)
            return
        unsound = self._remarks(measured) + self._frozen(measured)
        if unsound:
            self.failed += 1
            self.display.no_answer(f"the sweep is unsound: {'; '.join(unsound)}")
            return
        self._failure = ""
        wanted = self.baseline.complete
        if measured.part is None:
            press = UNKNOWN if wanted else UNPRESSED
            self.log.keep(measured.sweep, press, at, self.meter.header)
        if wanted:
            self._answer(measured)
        else:
            self._add_baseline(measured.sweep)

    def _measured(self, begun: float) -> TimedSweep:
        """The next sweep, whole or adaptive."""
        gap = 0.0 if self._ended is None else begun - self._ended
        part = None
        if self.baseline.complete and not self.baseline.renewal_due:
            part = self.localizer.adaptive_sweep(self._baseline_dataset(), gap)
        if part is None:
            times = self._reading_times
            times.begin()
            watch = times.on_reading if self.meter.sweeps else times.reading
            sweep = self.meter.sweep(watch)
        else:
            sweep = measure_adaptively(self.meter, part, self._reading_times)
        return TimedSweep(sweep, begun, self.clock(), gap, part)

    def _fail(self, failure: MeterError) -> None:
        self.failed += 1
        why, before = str(failure), self._failure
        wait = self.meter.wait_after_failure(failure, self.display.lasting and why == before)
        self._failure = why
        until = f" for up to {self.meter.patience:g} s" if wait else ""
        self.display.no_answer(f"{why}; trying again{until}")
        time.sleep(wait)

    def _prepare(self) -> None:
        self._ended = None
        self.localizer.prepare(self._baseline_dataset())

    def _baseline_dataset(self) -> xr.Dataset | None:
        return self._baseline_cache.sweeps if self.baseline.sweeps else None

    def _localize(self, measured: TimedSweep) -> TouchAnswer:
        if measured.part is not None:
            return self.localizer.described(measured.part.answer(measured.during))
        sweep = model_dataset([measured.sweep], self.localizer.model)
        return self.localizer.answer(sweep, self._baseline_dataset(), measured.gap, measured.during)

    def _answer(self, measured: TimedSweep) -> None:
        answer, sweep, begun = self._localize(measured), measured.sweep, measured.begun
        ended = self.clock()
        before, self._begun, self._ended = self._begun, begun, measured.ended
        self._ends.append(ended)
        self.answers += 1
        if measured.part is None:
            self.log.answered(answer)
        self.display.answer(
            TimedAnswer(
                answer,
                sweep,
                tuple(self.baseline.sweeps),
                now(),
                measured.during,
                ended - measured.ended,
                before and ended - before,
                self._rate(),
                self.failed,
                (
                    *flag_remarks([sweep]),
                    *switching_remarks(sweep),
                    *self._drift(measured, answer),
                    *filter(None, [answer.remark]),
                ),
            )
        )
        if self.baseline.follow(sweep if measured.part is None else None, answer):
            self.display.note("baseline renewed by one unpressed sweep, to follow slow drift")

    def _add_baseline(self, sweep: MeasuredSweep) -> None:
        moved = self._remarks(TimedSweep(sweep), self.baseline.first)
        if moved:
            self._baseline_trials += 1
            if self._baseline_trials >= MAX_BASELINE_TRIALS:
                raise MeterError(
                    f"the unpressed skin is not stable in {MAX_BASELINE_TRIALS} trials "
                    f"({moved[0]}); leave it untouched, or allow more by --drift"
                )
            self.baseline.forget()
            self.display.note(
                f"the skin may have been touched: {moved[0]}; measuring the baseline again"
            )
        self.baseline.add(sweep)
        if self.baseline.complete:
            self._baseline_trials = 0
            self._prepare()
            self.display.no_answer("ready: the skin may be touched")
        else:
            self._request_baseline()

    def _request_baseline(self) -> None:
        done, wanted = len(self.baseline.sweeps), self.baseline.wanted
        if done < wanted:
            self.display.no_answer(
                f"leave the skin untouched: unpressed sweep {done + 1} of {wanted}"
            )

    def _remarks(self, measured: TimedSweep, first: MeasuredSweep | None = None) -> list[str]:
        checker = self.meter.checker
        assert checker is not None
        earlier = [first] if first and measured.part is None else []
        return checker.remarks(measured.sweep, earlier, unpressed=True)

    def _frozen(self, measured: TimedSweep) -> list[str]:
        """Remark if the device repeats its last whole sweep digit for digit."""
        if measured.part is not None:
            return []
        before, self._latest = self._latest, measured.sweep
        return frozen_remarks(measured.sweep, before, list(self.baseline.sweeps))

    def _drift(self, measured: TimedSweep, answer: TouchAnswer) -> list[str]:
        return self._remarks(measured, self.baseline.first) if says_unpressed(answer) else []

    def _rate(self) -> float | None:
        if len(self._ends) < 2:
            return None
        return (len(self._ends) - 1) / (self._ends[-1] - self._ends[0])
