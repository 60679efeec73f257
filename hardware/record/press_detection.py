"""How far a sweep is from the skin at rest: beside the meter's noise, and along the frequencies."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...simulator.sweeps.laws.examination import FEWEST_FREQUENCIES
from ...simulator.sweeps.laws.noise import local_scale, roughness
from .measured_sweep import MeasuredSweep

DETECTION_FACTOR = 2.5
"""A change whose root mean square is so many times its noise is a press. Noise alone has 1, and up
to 2.1 where it is told from one difference at 20 frequencies."""
RESOLUTION = 1e-4
"""Least relative noise: what the digits leave open that a meter sends."""


def undetected_press(sweep: MeasuredSweep, baselines: Sequence[MeasuredSweep]) -> list[str]:
    """A remark where a sweep cannot be told from the skin at rest at any interface, else none.

    rests: sweeps at rest of the same session, oldest first; compared with the last one.
    """
    if not baselines:
        return []
    at_rest = [
        np.array([rest.traces[k].Z for rest in baselines]) for k, _ in enumerate(sweep.traces)
    ]
    changes = [own.Z / known[-1] - 1 for own, known in zip(sweep.traces, at_rest, strict=True)]
    noises = [_noise(part, known) for part, known in zip(changes, at_rest, strict=True)]
    if any(_rms(part / own) > DETECTION_FACTOR for part, own in zip(changes, noises, strict=True)):
        return []
    change, noise = np.concatenate(changes), np.concatenate(noises)
    return [
        f"no press is seen: the readings are those at rest, to {100 * _rms(change):.2g} %, and "
        f"the meter's noise is {100 * _rms(noise + 1j * noise):.2g} %"
    ]


def percent_change(values: Sequence[float], rest: Sequence[float]) -> NDArray[np.float64]:
    """How far values are above those at rest, in %; NaN where these are 0. Shape of the values."""
    before = np.array(rest[: len(values)])
    ratio = np.full(before.shape, np.nan)
    np.divide(values, before, out=ratio, where=before != 0)
    return 100 * (ratio - 1)


def _rms(change: NDArray[np.complex128]) -> float:
    """Root mean square of real and imaginary parts."""
    return float(np.sqrt(np.mean(np.abs(change) ** 2) / 2))


def _noise(change: NDArray[np.complex128], rests: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Standard deviation of the parts of a change between two sweeps; shape (frequency,).

    What is rough along the frequencies, of changes at rest or else of this one; where there are few
    frequencies, all that has changed at rest. rests: ohm, shape (sweep, frequency).
    """
    at_rest = rests[1:] / rests[:-1] - 1
    if change.size >= FEWEST_FREQUENCIES:
        seen = roughness(at_rest if len(at_rest) else change[None])
    elif len(at_rest):
        seen = local_scale(at_rest)
    else:
        seen = np.zeros(change.size)
    return np.maximum(seen, RESOLUTION)
