"""Detection of a press: change of a sweep against the unpressed skin and the meter's noise."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...simulator.arrays import Complex, Real
from ...simulator.sweeps.laws.examination import MIN_FREQUENCIES
from ...simulator.sweeps.laws.noise import local_scale, roughness
from .measured_sweep import MeasuredSweep

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
