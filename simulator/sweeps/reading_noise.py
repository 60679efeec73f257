"""Noise of readings, estimated from the readings themselves, and faults of the device.

Faults are digits that repeat themselves, and readings of a wrong range: each of these readings may
be that of a passive skin, together they cannot be.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Complex, Real
from .passivity import Violation, frequencies_text
from .reading_quantities import MAGNITUDE, kind_of
from .reading_subset import read_at
from .schema import complex_readings

if TYPE_CHECKING:
    import xarray as xr

    from ..arrays import Mask

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


STUCK, OUTLYING, FROZEN = "readings differ", "readings follow each other", "sweeps differ"
"""Names of the laws."""
FROZEN_TEXT = (
    "the sweep repeats the one before digit for digit, and other repeated sweeps differ: is the "
    "device stuck?"
)
ROUNDING = 0.01
"""Largest step of a display with three digits, over the reading."""
OUTLIER = 4.0
"""Factor by which a reading of a wrong range is off at least; ranges differ by 10."""
FOLLOWING = 2.0
"""Factor by which the other readings may deviate from a smooth curve."""
WIDE_STEP = 20.0
"""Ratio of two frequencies between which a curve may take any course."""
MIN_DIFFERING = 3
"""Pairs of repeated sweeps that must differ before two equal ones are a fault."""


@dataclass(frozen=True)
class DeviceFault:
    """A fault in one sweep at one interface. at: mask of the readings. text: a sentence."""

    law: str
    at: Mask
    text: str


def device_faults(sweeps: xr.Dataset, two_terminal: bool = True) -> list[Violation]:
    """Faults of the device in all sweeps. two_terminal: see `examine`."""
    phases = kind_of(sweeps.variables) is not MAGNITUDE
    groups = list(zip(sweeps["press"].values, sweeps["session"].values, strict=True))
    found = []
    for name in map(str, sweeps["interface"].values):
        part = read_at(sweeps, name)
        f, readings = part["frequency"].values, complex_readings(part)[:, 0]
        frozen = frozen_sweeps(readings, groups)
        for sweep, Z in enumerate(readings):
            faults = reading_faults(Z, f, phases, two_terminal)
            if frozen[sweep]:
                faults.append(DeviceFault(FROZEN, np.ones(f.shape, dtype=np.bool_), FROZEN_TEXT))
            found += [
                Violation(sweep, name, each.law, tuple(f[each.at].tolist()), each.text)
                for each in faults
            ]
    return found


def reading_faults(
    Z: Complex, frequency: Real, phases: bool = True, two_terminal: bool = True
) -> list[DeviceFault]:
    """Faults of the device within one sweep.

    Z: ohm, or gains, shape (frequency,). frequency: Hz, ascending. phases: False if only magnitudes
    of gains are known. two_terminal: see `examine`.
    """
    if not (np.isfinite(Z).all() and np.abs(Z).all()):
        return []
    found, count = [], frequency.size
    stuck = _stuck(Z, frequency) if phases else _constant(Z)
    if stuck.any():
        where = f"all {count} frequencies" if stuck.all() else frequencies_text(frequency[stuck])
        text = f"the same reading, digit for digit, at {where}: is the device stuck?"
        found.append(DeviceFault(STUCK, stuck, text))
    outlying, factors = _outlying(Z, frequency, two_terminal)
    for k in np.flatnonzero(outlying & ~stuck):
        off = f"{factors[k]:.0f} times" if factors[k] > 1 else f"1/{1 / factors[k]:.0f} of"
        text = (
            f"the reading at {frequency[k]:.6g} Hz is about {off} what the others show: is its "
            "range right?"
        )
        found.append(DeviceFault(OUTLYING, np.arange(count) == k, text))
    return found


def _stuck(Z: Complex, frequency: Real) -> Mask:
    """True for readings that are equal at frequencies between which a skin's must change.

    Two equal readings of a passive RC network are those of a resistor. Where X is not 0, linear
    programs over all such networks give the smallest change of Z from f to r f, over |Z|: at least
    0.7 (X / |Z|)² (r - 1) / (r + 1). The rounding of a display, or the smallest step in the sweep,
    may hide less.
    """
    steps = np.abs(np.diff(np.sort([Z.real, Z.imag])))
    step = min(steps[steps > 0], default=0.0)
    stuck = np.zeros(Z.shape, dtype=np.bool_)
    values, counts = np.unique(Z, return_counts=True)
    for value in values[counts > 1]:
        equal = value == Z
        r = frequency[equal].max() / frequency[equal].min()
        change = 0.7 * value.imag**2 / abs(value) * (r - 1) / (r + 1)
        if change > max(ROUNDING * abs(value), step):
            stuck |= equal
    return stuck


def _constant(Z: Complex) -> Mask:
    """True if the magnitudes at three or more frequencies are all the same."""
    return np.full(Z.shape, Z.size >= 3 and bool((np.abs(Z) == np.abs(Z[0])).all()))


def _outlying(Z: Complex, frequency: Real, two_terminal: bool) -> tuple[Mask, Real]:
    """Mask of readings that are off alone, and the factor by which each is.

    d ln|Z| / d ln f is near the phase over 90 degrees (Bode), which a wrong range leaves as it is.
    Gains of several sources have zeros, so that only a reading that is too large is a fault there.
    """
    factors, none = np.ones(Z.shape), np.zeros(Z.shape, dtype=np.bool_)
    if Z.size < 3:
        return none, factors
    slope = np.angle(Z) / (np.pi / 2) if Z.imag.any() else np.full(Z.shape, -0.5)
    usual = (slope[1:] + slope[:-1]) / 2 * np.diff(np.log(frequency))
    jumps = np.diff(np.log(np.abs(Z))) - usual
    jumps[np.diff(np.log(frequency)) > np.log(WIDE_STEP)] = 0.0
    before, after = np.append(0.0, jumps), np.append(-jumps, 0.0)
    off = np.where(np.abs(before) < np.abs(after), before, after)
    off[0], off[-1] = after[0], before[-1]
    alone = np.abs(before - after) < np.log(FOLLOWING)
    for end, rest in ((0, jumps[1:]), (-1, jumps[:-1])):
        alone[end] = two_terminal and (np.abs(rest) < np.log(FOLLOWING)).all()
    outlying = alone & ((np.abs(off) if two_terminal else off) > np.log(OUTLIER))
    return outlying, np.exp(off)


def frozen_sweeps(Z: Complex, groups: Sequence[Hashable]) -> Mask:
    """True for sweeps that repeat the one before digit for digit, although there is noise.

    Noise shows in repeated sweeps of one press. From the share of equal digits in them follows the
    chance that a whole sweep repeats itself. Without noise, as of a simulated skin, it may always.
    Z: ohm, or gains, shape (sweep, frequency). groups: one for each sweep, equal where repeated.
    """
    parts = np.concatenate([Z.real, Z.imag], axis=1)
    parts = parts[:, np.ptp(parts, axis=0) > 0]
    repeats = np.append(False, (parts[1:] == parts[:-1]).all(axis=1))
    differing, runs = [], 0
    for group in dict.fromkeys(groups):
        members = [k for k, each in enumerate(groups) if each == group]
        pairs = [parts[one] == parts[other] for one, other in pairwise(members)]
        differing += [equal for equal in pairs if not equal.all()]
        whole = [bool(equal.all()) for equal in pairs]
        runs += sum(now and not before for before, now in pairwise([False, *whole]))
    if len(differing) < MIN_DIFFERING * max(runs, 1):
        return np.zeros(len(Z), dtype=np.bool_)
    share = (np.sum(differing) + 1) / (np.size(differing) + 2)
    return repeats & bool(len(Z) * share ** parts.shape[1] < FALSE_ALARM)
