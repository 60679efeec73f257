"""Measured sweeps: readings at all interfaces and ascending frequencies, under one press."""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.meters.accuracy_table import outside_band
from ...simulator.sweeps import InputError
from ...simulator.sweeps.reading_quantities import ReadingKind
from ...simulator.sweeps.same_skin import SAME_FREQUENCY
from ..meter.meter_reading import MeterReading, ReadingStatus
from ..meter.reading_source import ReadingSource
from ..switch.switch import Switch

if TYPE_CHECKING:
    from ...simulator.arrays import Complex, Real

LOG = logging.getLogger(__name__)
MAX_ROUNDING = 0.01
"""Largest relative difference between a frequency of a scene and the one that a meter sets."""
MAX_PAUSE = 1.0
"""Seconds between two interfaces after which a touch may have changed."""
Watch = Callable[[float, MeterReading], None]
Turn = Callable[[str], None]


@dataclass(frozen=True)
class InterfaceTrace:
    """Readings of one kind at one interface, one at each frequency in Hz, ascending.

    begun, ended: ISO 8601, empty if unknown.
    """

    frequency: tuple[float, ...]
    readings: tuple[MeterReading, ...]
    interface: str = ""
    begun: str = ""
    ended: str = ""

    @property
    def kind(self) -> ReadingKind:
        """Kind of the readings."""
        return self.readings[0].kind

    @property
    def Z(self) -> Complex:
        """Impedances in ohm, or complex gains, shape (frequency,)."""
        return np.array([reading.value for reading in self.readings])

    @property
    def shown(self) -> dict[str, Real]:
        """Quantities that the meter shows with digits of their own, by name."""
        names = self.readings[0].shown
        return {name: np.array([each.shown[name] for each in self.readings]) for name in names}

    @property
    def quantities(self) -> dict[str, Real]:
        """Quantities by name, as the meter shows them or else from the readings."""
        return self.kind.values(self.Z, np.array(self.frequency), self.shown)


@dataclass(frozen=True)
class MeasuredSweep:
    """Readings under one press: a trace per interface, in the order of the recording."""

    traces: tuple[InterfaceTrace, ...]

    def at(self, interface: str) -> InterfaceTrace:
        """Trace at an interface."""
        return next(trace for trace in self.traces if trace.interface == interface)


def now() -> str:
    """Present time as ISO 8601 with milliseconds, UTC."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


def trace_times(sweep: MeasuredSweep) -> list[tuple[str, str]]:
    """Start and end of the readings at each interface."""
    return [(trace.begun, trace.ended) for trace in sweep.traces]


def switching_remarks(sweep: MeasuredSweep) -> list[str]:
    """Remark about the longest pause between two interfaces, if it exceeds MAX_PAUSE."""
    spans = sorted(trace_times(sweep))
    waits = [
        (datetime.fromisoformat(after) - datetime.fromisoformat(before)).total_seconds()
        for (_, before), (after, _) in pairwise(spans)
    ]
    if max(waits, default=0.0) <= MAX_PAUSE:
        return []
    return [f"the switch took {max(waits):.1f} s: a touch may have changed between the interfaces"]


def flag_remarks(sweeps: Sequence[MeasuredSweep]) -> list[str]:
    """Number of flagged readings for each status, in words."""
    traces = [trace for sweep in sweeps for trace in sweep.traces]
    counts = Counter(reading.status for trace in traces for reading in trace.readings)
    return [
        f"{count} reading{'s' if count > 1 else ''}: {status.meaning}"
        for status, count in sorted(counts.items(), key=lambda each: each[0].code)
        if status is not ReadingStatus.NORMAL
    ]


def measure_sweep(
    meter: ReadingSource,
    frequencies: Mapping[str, Sequence[float]],
    switch: Switch | None = None,
    watch: Watch = lambda frequency, reading: None,
    turn: Turn = lambda interface: None,
) -> MeasuredSweep:
    """Measure at frequencies [Hz] of each interface; no reading is older than this call.

    The connected interface comes first, which saves one turn of the switch per sweep. switch:
    selects interfaces, and is checked after each; None: the meter stays where it is. turn: called
    with each interface before the switch turns. watch: called with each reading. Raises InputError
    if the meter lacks a frequency, MeterError if a reading or the switch fails.
    """
    traces: dict[str, InterfaceTrace] = {}
    for name in sorted(frequencies, key=lambda name: switch is None or name != switch.selected):
        turn(name)
        if switch:
            switch.select(name)
        traces[name] = _trace(meter, frequencies[name], name, watch)
        if switch:
            switch.check_stayed()
    return MeasuredSweep(tuple(traces[name] for name in frequencies))


def measure_readings(
    meter: ReadingSource,
    requests: Iterable[tuple[str, float]],
    switch: Switch | None = None,
    watch: Watch = lambda frequency, reading: None,
) -> MeasuredSweep:
    """Measure at (interface, frequency in Hz); each request is made after the reading before.

    Traces are sorted by the name of their interface, readings by frequency. The switch is selected
    at the first reading and at each change of interface. Raises the errors of `measure_sweep`.
    """
    found: dict[str, dict[float, MeterReading]] = {}
    times: dict[str, tuple[str, str]] = {}
    here = None
    for interface, frequency in requests:
        if switch and interface != here:
            if here is not None:
                switch.check_stayed()
            switch.select(interface)
        here, begun = interface, times.get(interface, (now(),))[0]
        found.setdefault(interface, {})[frequency] = _at(meter, frequency, watch)
        times[interface] = begun, now()
    if switch and here is not None:
        switch.check_stayed()
    return MeasuredSweep(
        tuple(
            InterfaceTrace(
                tuple(sorted(own)), tuple(own[f] for f in sorted(own)), name, *times[name]
            )
            for name, own in sorted(found.items())
        )
    )


def check_frequencies(meter: ReadingSource, frequencies: Sequence[float]) -> dict[float, float]:
    """Frequencies at which the meter measures, by the requested one, Hz.

    Logs a warning if the meter rounds one. Raises InputError if the model does not reach a
    frequency, rounds it by more than MAX_ROUNDING, or rounds two to the same one.
    """
    change = "change `sweep.frequencies` of the scene"
    beyond = outside_band(meter.model, frequencies, meter.band)
    if beyond:
        raise InputError(f"{beyond}; {change}")
    measured = {f: meter.nearest(f) for f in frequencies}
    rounded = [f for f, g in measured.items() if abs(g / f - 1) > SAME_FREQUENCY]
    for f in rounded:
        twice = list(measured.values()).count(measured[f]) > 1
        if twice or not abs(measured[f] / f - 1) <= MAX_ROUNDING:
            also = ", as another frequency of the scene" if twice else ""
            raise InputError(
                f"meter {meter.model} sets {f:.7g} Hz as {measured[f]:.7g} Hz{also}; {change}"
            )
    if rounded:
        LOG.warning(
            "meter %s sets %.7g Hz as %.7g Hz, and %d of %d frequencies of the scene to other ones "
            "in all; the sweeps have the frequencies that the meter sets",
            meter.model,
            rounded[0],
            measured[rounded[0]],
            len(rounded),
            len(measured),
        )
    return measured


def _trace(
    meter: ReadingSource, frequencies: Sequence[float], interface: str, watch: Watch
) -> InterfaceTrace:
    begun, wanted = now(), tuple(map(float, frequencies))
    if meter.sweeps:
        readings = meter.read_sweep(wanted)
        for frequency, reading in zip(wanted, readings, strict=True):
            watch(frequency, reading)
    else:
        readings = [_at(meter, frequency, watch) for frequency in wanted]
    return InterfaceTrace(wanted, tuple(readings), interface, begun, now())


def _at(meter: ReadingSource, frequency: float, watch: Watch) -> MeterReading:
    reading = meter.read_at(frequency)
    watch(frequency, reading)
    return reading
