"""Checks of a measured sweep: passivity, the device, earlier repetitions, whether it is pressed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from ...simulator.arrays import Complex, Real
from ...simulator.meters.accuracy_table import ReadingConditions, full_scale
from ...simulator.sweeps.examination import MIN_FREQUENCIES
from ...simulator.sweeps.passivity import ErrorBounds, broken_laws, frequencies_text
from ...simulator.sweeps.reading_noise import (
    FROZEN_TEXT,
    frozen_sweeps,
    local_scale,
    reading_faults,
    roughness,
)
from ...simulator.sweeps.reading_quantities import IMPEDANCE, MAGNITUDE
from .measured_sweep import InterfaceTrace, MeasuredSweep

if TYPE_CHECKING:
    from ...simulator.arrays import Complex

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
