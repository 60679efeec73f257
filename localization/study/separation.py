"""Separation of classes of presses, in units of the meter's error.

The distance of two readings is the difference of ln |Z| and that of the phase, each over the
deviation of the meter's noise, root-sum-square over interfaces and frequencies. This is the
Mahalanobis distance for independent noise. The meter's accuracy, fixed for a session, multiplies
every |Z| by one factor and shifts every phase equally, so it cancels. The spread of presses and the
displayed digits are left out.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from scipy.spatial.distance import cdist

from ...simulator.arrays import Complex, Mask, Real
from ...simulator.bounds.likelihood import over_noise
from ...simulator.measure.readout import ErrorModel, observed
from ...simulator.measure.symmetry import Pixel
from ...simulator.scene.meter import Readout
from ...simulator.sweeps import InputError

Label = tuple[int, ...]
Target = Literal["column", "row", "pixel"]
TARGETS: tuple[str, ...] = get_args(Target)
BAND_SHARE = 4


@dataclass(frozen=True)
class Separation:
    """Distances between classes, in units of the meter's error.

    least, median: over all pairs of classes, each at its two nearest presses. band_start,
    band_stop: Hz, ends of the run of a quarter of the frequencies in which the nearest two
    neighbouring classes lie farthest apart. band_separation: that distance.
    """

    least: float
    median: float
    band_start: float
    band_stop: float
    band_separation: float


def label_of(pixel: Pixel, target: str) -> Label:
    """The class of a pressed pixel: its column, its row or both; zeros for the unpressed skin."""
    row, column = pixel
    return {"column": (column,), "row": (row,), "pixel": (row, column)}[target]


def in_units_of_error(
    Z: Complex, readout: Readout, frequency: Real, taken: Mask | None = None, phases: bool = True
) -> Real:
    """ln |Z| and phase over the meter's noise, shape (press, frequency, 2 * interface).

    The noise is that of the first press's readings, so that distances do not depend on their
    order in a pair. Z: ohm, shape (press, interface, frequency). frequency: Hz. taken: True where
    an interface is read at a frequency, None for all; elsewhere the result is 0 for every press.
    phases: False for ln |Z| alone, shape (press, frequency, interface).
    Raises InputError if a noise is zero.
    """
    require_noise_for_study(readout)
    read = np.ones(Z.shape[1:], dtype=bool) if taken is None else taken
    Z = np.where(read, Z, 1.0)
    errors = ErrorModel(readout, read, reading=Z[0], frequency=frequency, phases=phases)
    each = over_noise(observed(Z), errors)[..., : 2 if phases else 1]
    return each.transpose(0, 2, 3, 1).reshape(*each.shape[:3:2], -1)


def require_noise_for_study(readout: Readout) -> None:
    """Raises InputError if a noise of the meter is zero."""
    for name in ("magnitude_noise", "phase_noise"):
        if not readout.noisy and not getattr(readout, name) > 0:
            raise InputError(f"`readout.{name}` must be > 0 for a study, got 0")


def separation(readings: Real, labels: Sequence[Label], frequency: Real) -> Separation:
    """Separation of the classes of these readings.

    readings: as in `in_units_of_error`. labels: label of each press, at least two different ones.
    frequency: Hz, ascending.
    """
    classes = sorted(set(labels))
    pairs = list(itertools.combinations(range(len(classes)), 2))
    all_pairs = _over(class_distances(readings, labels), pairs)
    nearby = [(i, j) for i, j in pairs if _are_neighbours(classes[i], classes[j])] or pairs
    width = math.ceil(len(frequency) / BAND_SHARE)
    bands = [
        _over(class_distances(readings[:, start : start + width], labels), nearby).min()
        for start in range(len(frequency) - width + 1)
    ]
    best = int(np.argmax(bands))
    return Separation(
        least=float(all_pairs.min()),
        median=float(np.median(all_pairs)),
        band_start=float(frequency[best]),
        band_stop=float(frequency[best + width - 1]),
        band_separation=float(bands[best]),
    )


def class_distances(readings: Real, labels: Sequence[Label]) -> Real:
    """Distance of each pair of classes at their two nearest presses, shape (class, class)."""
    classes = sorted(set(labels))
    number = np.array([classes.index(label) for label in labels])
    order = np.argsort(number, kind="stable")
    first = np.searchsorted(number[order], np.arange(len(classes)))
    flat = readings[order].reshape(len(labels), -1)
    to_class = np.minimum.reduceat(cdist(flat, flat), first, axis=1)
    return np.minimum.reduceat(to_class, first, axis=0)


def _over(distances: Real, pairs: Sequence[tuple[int, int]]) -> Real:
    return np.array([distances[pair] for pair in pairs])


def _are_neighbours(one: Label, other: Label) -> bool:
    """True if they are adjacent columns, rows or pixels; the unpressed skin has no neighbours."""
    pressed = any(one) and any(other)
    return pressed and sum(abs(a - b) for a, b in zip(one, other, strict=True)) == 1
