"""Frequencies that sweeps have in common, and where a sweep turns back."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...arrays import Real
from ..same_frequency import tolerance

JITTER = 1e-3
"""Largest relative difference between the frequencies that a meter reports for the same setting."""

COARSE = 10.0
"""Steps of a sweep over JITTER from which a step within JITTER begins another sweep."""


@dataclass(frozen=True)
class CommonFrequencies:
    """Frequency of every line in Hz, rounded to that of the first sweep, and how far it was off.

    runs: number of the run of ascending or descending frequencies, for every line. jitter: largest
    relative difference, 0 where all are equal but for SAME_FREQUENCY or the digits.
    """

    frequency: Real
    runs: NDArray[np.intp]
    jitter: float


def common_frequencies(frequency: Real, keys: Sequence[Hashable]) -> CommonFrequencies:
    """Frequencies of lines with those that are nearly equal made equal.

    Frequencies within `tolerance` are one. Those within JITTER are one too if they never occur in
    one run, so that a fine grid is kept. keys: what else distinguishes lines, such as the press.
    """
    values, inverse = np.unique(frequency, return_inverse=True)
    exact = _joined(values, tolerance(values))[inverse]
    runs = _runs(exact, keys)
    rough = _joined(values, np.full(values.shape, JITTER))[inverse]
    pairs = np.unique(np.stack([runs.astype(float), rough]), axis=1).shape[1]
    fine = np.unique(np.stack([runs.astype(float), exact]), axis=1).shape[1]
    found = rough if pairs == fine else exact
    found = _first(found, frequency)
    differences = np.abs(frequency / found - 1)
    beyond = differences > tolerance(values)[inverse]
    return CommonFrequencies(found, runs, float(differences[beyond].max(initial=0.0)))


def continues(first: Sequence[float], second: Sequence[float]) -> bool:
    """True if a second run of frequencies begins within or behind the first and ends beyond it."""
    if len(first) < 2 or len(second) < 2:
        return False
    direction = np.sign(first[-1] - first[0])
    a, b = direction * np.array(first), direction * np.array(second)
    return bool((np.diff(b) > 0).all() and b[0] > a[0] and b[-1] > a.max())


def _joined(values: Real, tolerances: Real) -> Real:
    """Ascending values with each group of neighbours within tolerance replaced by its first."""
    apart = np.append(True, np.diff(values) > tolerances[1:] * values[:-1])
    return values[np.flatnonzero(apart)[np.cumsum(apart) - 1]]


def _first(groups: Real, frequency: Real) -> Real:
    """The first frequency of each group, for every line."""
    _, first, inverse = np.unique(groups, return_index=True, return_inverse=True)
    return frequency[first][inverse]


def _runs(frequency: Real, keys: Sequence[Hashable]) -> NDArray[np.intp]:
    """Number of the monotone run of every line, among the lines with the same key."""
    runs = np.empty(len(frequency), dtype=np.intp)
    latest: dict[Hashable, tuple[int, float, float]] = {}
    count = 0
    for place, (f, key) in enumerate(zip(frequency.tolist(), keys, strict=True)):
        run, before, last = latest.get(key, (-1, f, 0.0))
        step = f / before - 1
        stays = abs(step) <= JITTER and abs(last) > COARSE * JITTER
        if run < 0 or step == 0 or step * last < 0 or stays:
            run, count, step = count, count + 1, 0.0
        runs[place] = run
        latest[key] = run, f, step
    return runs
