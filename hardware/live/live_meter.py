"""Meter of a live session: connected, measured, reconnected after failures, and restored."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ...simulator.sweeps import InputError
from ..meter.errors import FailedReadingError, MeterError, NoConnectionError
from ..meter.instruments import instrument_of
from ..meter.lcr_meter import require_settings, restore_settings
from ..meter.meter_reading import ReadingSource
from ..record.managed_meter import ManagedMeter
from ..record.measured_sweep import (
    ConditionsOf,
    ErrorTable,
    MeasuredSweep,
    SweepChecker,
    SweepLimits,
    Watch,
    check_frequencies,
    measure_readings,
    measure_sweep,
    now,
)
from ..record.recording_journal import RecordingHeader, RecordingJournal
from ..switch.switch import NoSwitchError, Switch, SwitchError
from .touch_answer import frequencies_of

if TYPE_CHECKING:
    from .live_localizer import LiveLocalizer

DEFAULT_SECONDS = 0.1
"""Assumed time of a turn before the first one, s."""


@dataclass
class TimedSwitch:
    """A switch whose turns are timed by a clock in s. last_seconds: time of the latest turn, s.

    total_seconds: total time of all calls, s.
    """

    switch: Switch
    clock: Callable[[], float]
    last_seconds: float = field(default=DEFAULT_SECONDS, init=False)
    total_seconds: float = field(default=0.0, init=False)

    @property
    def selected(self) -> str | None:
        """Connected interface, or None if unknown."""
        return self.switch.selected

    def select(self, name: str) -> None:
        """Connect an interface, and time it. Raises SwitchError."""
        before, begun = self.selected, self.clock()
        try:
            self.switch.select(name)
        finally:
            took = self.clock() - begun
            self.total_seconds += took
        if before not in (None, name):
            self.last_seconds = took

    def check_stayed(self) -> None:
        """Check that the switch has not turned, and time it. Raises SwitchError."""
        begun = self.clock()
        self.switch.check_stayed()
        self.total_seconds += self.clock() - begun

    def close(self) -> None:
        """Close the switch."""
        self.switch.close()


FIRST_WAIT, LONGEST_WAIT = 0.25, 4.0
CHECK_INTERVAL = 1.0


class LiveMeter:
    """One meter that keeps the settings of the session's start and is reconnected when it fails.

    station: releases the meter and the switch, see `ManagedMeter`. patience: s without a whole
    sweep until the session gives up. switch: connects the meter to one of the localizer's
    interfaces, if there are several.
    """

    def __init__(
        self,
        localizer: LiveLocalizer,
        connect: Callable[[], ReadingSource],
        table: ErrorTable,
        limits: SweepLimits,
        patience: float,
        switch: Switch | None = None,
        report: Callable[[str], None] = lambda text: None,
        clock: Callable[[], float] = time.perf_counter,
        journal: RecordingJournal | None = None,
        conditions: ConditionsOf | None = None,
    ) -> None:
        """report, journal: arguments of `ManagedMeter`. clock: times the turns, s.

        conditions: of a reading; None: those of the meter that answers.
        """
        if not 0 < patience <= 1e6:
            raise InputError(f"`patience` must be in (0, 1e6] s, got {patience:g}")
        self._localizer, self._table, self._limits = localizer, table, limits
        self._conditions = conditions
        self.patience = patience
        self.switch = TimedSwitch(switch, clock) if switch else None
        self.station = ManagedMeter(connect, None, report, journal, self.switch)
        self._failing_since: float | None = None
        self._wait, self._checked_at = FIRST_WAIT, 0.0
        self.checker: SweepChecker | None = None

    @property
    def header(self) -> RecordingHeader | None:
        """Facts of the session's beginning; None before the first connection."""
        return self.station.header

    def ready(self) -> None:
        """Connect the meter, if necessary, with the settings of the beginning.

        Raises MeterError if that fails, InputError if it lacks a frequency of the model.
        """
        meter = self.station.ready()
        if self.station.header is None:
            self._begin(meter)

    def sweep(self, watch: Watch) -> MeasuredSweep:
        """Measure a whole sweep and check that the settings are unchanged. Raises MeterError."""
        requested = frequencies_of(self._localizer.model)
        sweep = measure_sweep(self._meter, requested, self.switch, watch)
        self._check_settings()
        return sweep

    def readings(self, watch: Watch, requests: Iterable[tuple[str, float]]) -> MeasuredSweep:
        """Measure at the requested (interface, frequency in Hz). Raises MeterError.

        The settings are checked once in CHECK_INTERVAL seconds.
        """
        sweep = measure_readings(self._meter, requests, self.switch, watch)
        if time.monotonic() - self._checked_at > CHECK_INTERVAL:
            self._check_settings()
        self._recovered()
        return sweep

    @property
    def sweeps(self) -> bool:
        """True if the meter sweeps by itself, so that readings have no times of their own."""
        return self._meter.sweeps

    @property
    def _meter(self) -> ReadingSource:
        meter = self.station.meter
        assert meter is not None
        return meter

    def _check_settings(self) -> None:
        assert self.header is not None
        require_settings(self._meter, self.header.settings)
        self._checked_at = time.monotonic()
        self._recovered()

    def wait_after_failure(self, failure: MeterError, shown: bool = False) -> float:
        """Time to wait before the next sweep, s; longer after each successive failure.

        shown: True if the user has read of this failure. Raises NoConnectionError or NoSwitchError
        when patience is over; the error then names a failure that was not shown. A reading that
        failed by the meter's own status causes no reconnection. A failed switch does not disconnect
        the meter.
        """
        if isinstance(failure, FailedReadingError):
            self._recovered()
            return 0.0
        gone, what = NoConnectionError, "meter"
        if isinstance(failure, SwitchError):
            gone, what = NoSwitchError, "switch"
        else:
            self.station.close()
        self._failing_since = self._failing_since or time.monotonic()
        left = self._failing_since + self.patience - time.monotonic()
        if left <= 0:
            last = "" if shown else f"; the last failure: {failure}"
            raise gone(f"the {what} gave no sweep for {self.patience:g} s{last}") from failure
        wait, self._wait = min(self._wait, left), min(2 * self._wait, LONGEST_WAIT)
        return wait

    def _begin(self, meter: ReadingSource) -> None:
        model, pixels = self._localizer.model, self._localizer.parts.skin.pixels
        measured = check_frequencies(meter, model.frequencies)
        settings = meter.snapshot()
        restore_settings(meter, settings)
        header = RecordingHeader(
            scene=model.problem.scene,
            name="live",
            interfaces=model.interfaces,
            frequencies=model.frequencies,
            rows=pixels.rows,
            columns=pixels.columns,
            order=(),
            asked={},
            meter=meter.identity.text,
            settings=settings,
            begun=(begun := now()),
            session=begun,
            accuracy=self._table.name,
            of_each=model.own_frequencies,
        )
        self.station.header = header.at(measured)
        self.checker = SweepChecker(
            self._table,
            settings,
            self._limits,
            self._conditions or instrument_of(meter.identity.text).conditions,
        )

    def _recovered(self) -> None:
        self._failing_since, self._wait = None, FIRST_WAIT
