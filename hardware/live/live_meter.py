"""The meter of a live session: connected, swept, lost, waited for, given up, and left as found."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.sweeps import InputError
from ..meter.accuracy_table import AccuracyTable
from ..meter.errors import FailedReadingError, MeterError, NoConnectionError
from ..meter.hioki import Meter
from ..meter.settings_snapshot import require_settings, restore_settings, snapshot
from ..meter.termination import shielded
from ..record.managed_meter import ManagedMeter
from ..record.measured_sweep import (
    MeasuredSweep,
    Watch,
    check_frequencies,
    measure_readings,
    measure_sweep,
    now,
)
from ..record.recording_journal import RecordingHeader, RecordingJournal
from ..record.sweep_checks import SweepChecker, SweepLimits
from ..switch.errors import NoSwitchError, SwitchError
from ..switch.switch import Switch
from .timed_switch import TimedSwitch

if TYPE_CHECKING:
    from .live_localizer import LiveLocalizer

FIRST_WAIT, LONGEST_WAIT = 0.25, 4.0
LOOKED_AT = 1.0


class LiveMeter:
    """One meter, with the settings it had at the beginning; reconnected when it fails.

    patience: s without a whole sweep after which it is given up. switch: connects it to one of the
    localizer's interfaces, where there are several.
    """

    def __init__(
        self,
        localizer: LiveLocalizer,
        connect: Callable[[], Meter],
        table: AccuracyTable,
        limits: SweepLimits,
        patience: float,
        switch: Switch | None = None,
        tell: Callable[[str], None] = lambda text: None,
        clock: Callable[[], float] = time.perf_counter,
        journal: RecordingJournal | None = None,
    ) -> None:
        """tell, journal: as of `Station`. clock: s, of turns."""
        if not 0 < patience <= 1e6:
            raise InputError(f"`patience` must be in (0, 1e6] s, got {patience:g}")
        self._localizer, self._table, self._limits = localizer, table, limits
        self._station, self._patience = ManagedMeter(connect, tell=tell, journal=journal), patience
        self.turns = TimedSwitch(switch, clock) if switch else None
        self._failing_since: float | None = None
        self._wait, self._looked = FIRST_WAIT, 0.0
        self.judge: SweepChecker | None = None

    @property
    def header(self) -> RecordingHeader | None:
        """What the session began with; None before the first connection."""
        return self._station.header

    def ready(self) -> None:
        """Have the meter connected, with the settings of the beginning.

        Raises MeterError where that fails, InputError where it has not the model's frequencies.
        """
        meter = self._station.ready()
        if self._station.header is None:
            self._begin(meter)

    def sweep(self, watch: Watch) -> MeasuredSweep:
        """Readings that were all measured with those settings, once ready. Raises MeterError."""
        model = self._localizer.model
        sweep = measure_sweep(
            self._meter,
            model.frequencies,
            model.interfaces,
            self.turns,
            watch,
            of_each=model.own_frequencies,
        )
        self._look()
        return sweep

    def readings(self, watch: Watch, requests: Iterable[tuple[str, float]]) -> MeasuredSweep:
        """Those at (interface, frequency in Hz) that are asked for. Raises MeterError.

        The settings are looked at once in LOOKED_AT seconds.
        """
        sweep = measure_readings(self._meter, requests, self.turns, watch)
        if time.monotonic() - self._looked > LOOKED_AT:
            self._look()
        self._recovered()
        return sweep

    @property
    def _meter(self) -> Meter:
        meter = self._station.meter
        assert meter is not None
        return meter

    def _look(self) -> None:
        assert self.header is not None
        require_settings(self._meter, self.header.settings)
        self._looked = time.monotonic()
        self._recovered()

    def failed(self, failure: MeterError) -> float:
        """Seconds to wait before the next sweep, longer with each failure in a row.

        Raises NoConnectionError or NoSwitchError where patience is at its end. A reading that the
        meter itself calls failed is no reason to connect anew, or to give up; nor is a switch that
        fails one to let the meter go.
        """
        if isinstance(failure, FailedReadingError):
            self._recovered()
            return 0.0
        gone, what = NoConnectionError, "meter"
        if isinstance(failure, SwitchError):
            gone, what = NoSwitchError, "switch"
        else:
            self._station.close()
        self._failing_since = self._failing_since or time.monotonic()
        left = self._failing_since + self._patience - time.monotonic()
        if left <= 0:
            raise gone(
                f"given up after {self._patience:g} s without the {what}; at last: {failure}"
            ) from failure
        wait, self._wait = min(self._wait, left), min(2 * self._wait, LONGEST_WAIT)
        return wait

    def leave(self) -> None:
        """Let the meter and the switch go as they were found, as far as they answer."""
        with shielded():
            self._station.release()
            if self.turns:
                self.turns.close()

    def _begin(self, meter: Meter) -> None:
        model, pixels = self._localizer.model, self._localizer.scene.pixels
        check_frequencies(meter, model.frequencies)
        settings = snapshot(meter)
        restore_settings(meter, settings)
        self._station.header = RecordingHeader(
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
            of_each=dict(model.own_frequencies),
        )
        frequency = np.array(model.frequencies)
        self.judge = SweepChecker(
            frequency, self._table, settings, self._limits, model.own_frequencies
        )

    def _recovered(self) -> None:
        self._failing_since, self._wait = None, FIRST_WAIT
