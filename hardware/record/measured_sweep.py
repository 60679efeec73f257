"""Measured sweeps: readings at all interfaces and ascending frequencies, and their checks."""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import pairwise
from typing import Any, Protocol

import numpy as np

from ...simulator.arrays import Complex, Real
from ...simulator.meters.accuracy_table import ReadingConditions, full_scale, outside_band
from ...simulator.sweeps import InputError
from ...simulator.sweeps.examination import MIN_FREQUENCIES
from ...simulator.sweeps.passivity import ErrorBounds, broken_laws, frequencies_text
from ...simulator.sweeps.reading_noise import (
    FROZEN_TEXT,
    frozen_sweeps,
    local_scale,
    reading_faults,
    roughness,
)
from ...simulator.sweeps.reading_quantities import IMPEDANCE, MAGNITUDE, ReadingKind
from ...simulator.sweeps.same_skin import SAME_FREQUENCY
from ..meter.meter_reading import MeterReading, ReadingSource, ReadingStatus
from ..switch.switch import Switch

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


CP_TOLERANCE = 1e-3
ConditionsOf = Callable[[Mapping[str, Any], float, complex, Any], ReadingConditions]


class ErrorTable(Protocol):
    """Bounds on errors of readings: an accuracy table of a meter, or what a reader states."""

    @property
    def name(self) -> str:
        """Name of the table."""
        ...

    def has_range(self, range_number: int) -> bool:
        """True if the bounds of this range are known."""
        ...

    def error_bounds(self, Z: complex, conditions: ReadingConditions) -> tuple[float, float]:
        """Bounds on the errors of |Z| (a fraction) and of the phase (rad)."""
        ...


@dataclass(frozen=True)
class SweepLimits:
    """Allowed deviations of a sweep.

    errors: tolerance of the laws, as a multiple of the bounds on the meter's error. With noise of
    the size of the bounds, 22 of 300 sweeps broke a law at the factor 2, and none at 3.

    repeatability: fraction by which |Z| or a gain may differ from the mean of earlier sweeps of
    the same press. drift: fraction by which it may differ, on the unpressed skin, from that of the
    first baseline sweep. two_terminal: True if all current that enters the skin leaves it through
    the meter; otherwise the laws of passive skins do not apply to the readings.
    """

    errors: float = 4.0
    repeatability: float = 0.05
    drift: float = 0.05
    two_terminal: bool = True


@dataclass(frozen=True)
class SweepChecker:
    """Checks sweeps. settings: the meter's, as in a snapshot.

    conditions: conditions of a reading, see `LcrMeter.conditions`.
    """

    table: ErrorTable
    settings: Mapping[str, Any]
    limits: SweepLimits
    conditions: ConditionsOf

    def remarks(
        self, sweep: MeasuredSweep, earlier: Sequence[MeasuredSweep], unpressed: bool
    ) -> list[str]:
        """Faults of a sweep, in words; empty if it is sound.

        earlier: sound sweeps of the same press, oldest first. unpressed: True for a baseline sweep.
        """
        found: list[str] = []
        for place, trace in enumerate(sweep.traces):
            before = [one.traces[place] for one in earlier]
            where = f"interface {trace.interface}: " if len(sweep.traces) > 1 else ""
            found += [where + remark for remark in self._trace_remarks(trace, before, unpressed)]
        return found

    def _trace_remarks(
        self, trace: InterfaceTrace, earlier: Sequence[InterfaceTrace], unpressed: bool
    ) -> list[str]:
        found = [*self._law_remarks(trace), *_capacitance_remarks(trace)]
        phases, two_terminal = trace.kind is not MAGNITUDE, self.limits.two_terminal
        faults = reading_faults(trace.Z, np.array(trace.frequency), phases, two_terminal)
        found += [each.text for each in faults]
        if earlier and unpressed:
            found += _deviation_remarks(
                trace, earlier[0].Z, self.limits.drift, "the unpressed skin has drifted"
            )
        elif earlier:
            mean = np.mean([one.Z for one in earlier], axis=0)
            found += _deviation_remarks(
                trace, mean, self.limits.repeatability, "differs from earlier repetitions"
            )
        return found

    def error_bounds(self, trace: InterfaceTrace) -> ErrorBounds:
        """Bounds on the meter's error, at each frequency for the reading there."""
        pairs = [
            self.table.error_bounds(z, self._conditions(f, z))
            for f, z in zip(trace.frequency, trace.Z.tolist(), strict=True)
        ]
        return ErrorBounds(*np.array(pairs).T)

    def _conditions(self, frequency: float, Z: complex) -> ReadingConditions:
        return self.conditions(self.settings, frequency, Z, self.table)

    def _law_remarks(self, trace: InterfaceTrace) -> list[str]:
        if not self.limits.two_terminal:
            return []
        frequency, bounds = np.array(trace.frequency), self.error_bounds(trace)
        broken = broken_laws(trace.Z, frequency, bounds.times(self.limits.errors))
        beyond = f"beyond the meter's error{self._unknown_error_note(trace)}" if broken else ""
        return [
            f"{law} is broken at {frequencies_text(frequency[where])}, {beyond}"
            for law, where in broken.items()
        ]

    def _unknown_error_note(self, trace: InterfaceTrace) -> str:
        """Note about used ranges that the accuracy table lacks; empty if it has all."""
        used = {
            self._conditions(f, z).range
            for f, z in zip(trace.frequency, trace.Z.tolist(), strict=True)
        }
        unknown = [f"{full_scale(n):g}" for n in sorted(used) if not self.table.has_range(n)]
        if not unknown:
            return ""
        return f" (estimated: {self.table.name} has no range of {', '.join(unknown)} ohm)"


def _capacitance_remarks(trace: InterfaceTrace) -> list[str]:
    """Remark if a meter shows a Cp that does not follow from what else it shows."""
    frequency = np.array(trace.frequency)
    computed = trace.kind.values(trace.Z, frequency)
    return [
        f"{name} does not follow from Rs, X and f at {frequencies_text(frequency[wrong])}"
        for name, shown in trace.shown.items()
        if (wrong := np.abs(shown - computed[name]) > CP_TOLERANCE * np.abs(computed[name])).any()
    ]


def _deviation_remarks(trace: InterfaceTrace, usual: Complex, limit: float, what: str) -> list[str]:
    departure = np.abs(trace.Z / usual - 1)
    worst = int(departure.argmax())
    if departure[worst] <= limit:
        return []
    size = "|Z|" if trace.kind is IMPEDANCE else "|V / V_s|"
    return [
        f"{what} by {100 * departure[worst]:.1f} % of {size} at {trace.frequency[worst]:.5g} Hz "
        f"(allowed: {100 * limit:g} %)"
    ]


def frozen_remarks(
    sweep: MeasuredSweep, before: MeasuredSweep | None, baselines: Sequence[MeasuredSweep]
) -> list[str]:
    """Remark if a sweep repeats the one before digit for digit, although unpressed sweeps differ.

    before: the sound sweep before it. baselines: unpressed sweeps, whose differences are noise.
    """
    if before is None:
        return []
    groups = [*(0 for _ in baselines), 1, 2]
    found = []
    for place, trace in enumerate(sweep.traces):
        of_all = [one.traces[place].Z for one in (*baselines, before)]
        if frozen_sweeps(np.array([*of_all, trace.Z]), groups)[-1]:
            where = f"interface {trace.interface}: " if len(sweep.traces) > 1 else ""
            found.append(where + FROZEN_TEXT)
    return found


DETECTION_FACTOR = 2.5
"""A change is a press if its root mean square exceeds its noise by this factor. Noise alone gives
1, and up to 2.1 if estimated from one difference at 20 frequencies."""
RESOLUTION = 1e-4
"""Lower limit of the relative noise: the rounding of the digits that a meter sends."""


def undetected_press(sweep: MeasuredSweep, baselines: Sequence[MeasuredSweep]) -> list[str]:
    """Remark if a sweep does not differ from the unpressed skin at any interface; else empty.

    baselines: unpressed sweeps of the same session, oldest first. The last one is compared.
    """
    if not baselines:
        return []
    unpressed = [
        np.array([rest.traces[k].Z for rest in baselines]) for k, _ in enumerate(sweep.traces)
    ]
    changes = [own.Z / known[-1] - 1 for own, known in zip(sweep.traces, unpressed, strict=True)]
    noises = [_noise(part, known) for part, known in zip(changes, unpressed, strict=True)]
    if any(_rms(part / own) > DETECTION_FACTOR for part, own in zip(changes, noises, strict=True)):
        return []
    change, noise = np.concatenate(changes), np.concatenate(noises)
    return [
        f"no press detected: the readings differ from the unpressed skin by "
        f"{100 * _rms(change):.2g} %, and the meter's noise is "
        f"{100 * _rms(noise + 1j * noise):.2g} %"
    ]


def percent_change(values: Real, baseline: Real) -> Real:
    """Change of values against the unpressed skin, %; NaN where that is 0. Shape of the values."""
    before = baseline[: len(values)]
    ratio = np.full(before.shape, np.nan)
    np.divide(values, before, out=ratio, where=before != 0)
    return 100 * (ratio - 1)


def _rms(change: Complex) -> float:
    """Root mean square of real and imaginary parts."""
    return float(np.sqrt(np.mean(np.abs(change) ** 2) / 2))


def _noise(change: Complex, baselines: Complex) -> Real:
    """Standard deviation of real and imaginary part of a change; shape (frequency,).

    With enough frequencies it is the roughness along the frequency axis: of the changes between
    baseline sweeps or, with a single one, of this change. With few frequencies it is the size of
    the changes between baseline sweeps. baselines: ohm, shape (sweep, frequency).
    """
    drift = baselines[1:] / baselines[:-1] - 1
    if change.size >= MIN_FREQUENCIES:
        noise = roughness(drift if len(drift) else change[None])
    elif len(drift):
        noise = local_scale(drift)
    else:
        noise = np.zeros(change.size)
    return np.maximum(noise, RESOLUTION)
