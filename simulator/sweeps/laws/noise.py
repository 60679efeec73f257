"""Noise of readings, estimated from the readings themselves, and limits of outliers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ...arrays import Complex, Real

NEIGHBOURS = 9
"""Number of neighbouring frequencies in one estimate; a meter's noise varies along a sweep."""
MEDIAN_OF_NORMAL = 0.6745
"""Median of |x| of a normal x of standard deviation 1."""
EFFICIENCY = 0.37
"""Efficiency of a median of |x| as an estimate of the standard deviation."""
FALSE_ALARM = 0.01
"""Probability that a file of valid sweeps is flagged at all."""


def scaled_by(scale: Callable[[Complex], Real], deviations: Complex, profile: Real | None) -> Real:
    """A scale of deviations that is at least proportional to a known profile of the noise.

    Neighbours of unequal noise hide that of the noisiest. profile: noise at each frequency up to a
    factor, > 0, shape (frequency,); None: unknown.
    """
    own = scale(deviations)
    return own if profile is None else np.maximum(own, profile * scale(deviations / profile))


def local_scale(deviations: Complex) -> Real:
    """Standard deviation of real and imaginary part at each frequency, from its neighbours.

    A median, so that a few bad readings do not hide themselves. deviations: shape
    (sweep, frequency), NaN where there is none. Returns shape (frequency,).
    """
    parts = np.abs(np.concatenate([deviations.real, deviations.imag]))
    present = np.flatnonzero(np.isfinite(parts).any(axis=0))
    width = min(NEIGHBOURS, present.size)
    starts = np.clip(np.arange(present.size) - width // 2, 0, present.size - width)
    scales = [np.nanmedian(parts[:, present[start : start + width]]) for start in starts]
    everywhere = np.arange(parts.shape[1])
    nearest = np.abs(everywhere[:, None] - present).argmin(axis=1)
    return np.array(scales)[nearest] / MEDIAN_OF_NORMAL


def roughness(deviations: Complex) -> Real:
    """Standard deviation of the changes between neighbouring frequencies; smooth trends drop out.

    From second differences, whose variance is 6 times that of independent readings.
    deviations: shape (sweep, frequency), NaN where there is none. Returns shape (frequency,).
    """
    bends = np.full(deviations.shape, np.nan + 1j * np.nan)
    bends[:, 1:-1] = np.diff(deviations, 2) / np.sqrt(6)
    return local_scale(bends)


def repeatability(Z: Complex, groups: Sequence[object], profile: Real | None = None) -> Real | None:
    """Relative noise of Z at each frequency from repeated sweeps; None if nothing is repeated.

    Unequal strengths of presses and drift between sweeps are smooth in frequency and hardly
    contribute. Z: ohm, shape (sweep, frequency). groups: one for each sweep, equal where repeated.
    profile: see `scaled_by`.
    """
    deviations = []
    for group in dict.fromkeys(groups):
        repeated = Z[[each == group for each in groups]]
        if len(repeated) > 1:
            freedom = np.sqrt(len(repeated) / (len(repeated) - 1))
            deviations.append(freedom * (repeated / repeated.mean(axis=0) - 1))
    if not deviations:
        return None
    return scaled_by(roughness, np.concatenate(deviations), profile)


@dataclass(frozen=True)
class Allowance:
    """Allowed deviation of a reading in standard deviations, for `tests` tests in all.

    tests: number of comparisons. readings: number of readings from which the standard deviation was
    estimated; infinite if it is known.
    """

    tests: int
    readings: float

    @property
    def limit(self) -> float:
        """Quantile of Student's distribution for a probability of FALSE_ALARM over all tests."""
        from scipy.stats import norm, t

        chance = FALSE_ALARM / (2 * self.tests)
        if np.isinf(self.readings):
            return float(norm.isf(chance))
        return float(t.isf(chance, EFFICIENCY * self.readings))
