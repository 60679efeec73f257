"""Disjoint sets of sweeps for calibration, for additional training, and for the test."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Integer, Mask
from ...simulator.sweeps import InputError


class Split(NamedTuple):
    """Indices of sweeps added to training, and of those tested."""

    added: NDArray[np.intp]
    tested: NDArray[np.intp]


def reserved_for_calibration(row: Integer, column: Integer, touches: int, session: Integer) -> Mask:
    """Half of each session's unpressed sweeps, and one of each of `touches` distant pixels.

    The larger half of an odd number of unpressed sweeps. Shape (sweep,), as the arguments. Raises
    InputError if `touches` is below 0.
    """
    if touches < 0:
        raise InputError(f"`calibration_touches` must be >= 0, got {touches}")
    reserved = np.zeros(row.size, dtype=bool)
    for each in np.unique(session):
        rest = np.flatnonzero((row == 0) & (session == each))
        reserved[rest[: (rest.size + 1) // 2]] = True
    pressed = np.unique(np.stack([row, column], axis=1)[row > 0], axis=0)
    for i, j in _distant(pressed, touches):
        reserved[np.flatnonzero((row == i) & (column == j))[0]] = True
    return reserved


def touch_splits(
    pixel: Integer, reserved: Mask, k: int, draws: int, seed: int
) -> list[Split] | None:
    """`draws` ways to add k sweeps of every pixel to training and to test the others.

    Reserved sweeps are never tested, and are the first of the k. For k = 0 there is one way. Pixels
    with only reserved sweeps are neither added nor tested. None if a pixel has too few sweeps, or
    all are reserved.
    """
    groups = _groups(pixel, reserved)
    if not groups or any(each.size - max(k, kept.sum()) < 1 for each, kept in groups):
        return None
    random = np.random.default_rng([seed, k])
    return [_split(groups, k, random) for _ in range(draws if k else 1)]


def largest_k(pixel: Integer, reserved: Mask) -> int:
    """Largest number of added sweeps of every pixel that leaves one to test."""
    return min((each.size - 1 for each, _ in _groups(pixel, reserved)), default=0)


def _groups(pixel: Integer, reserved: Mask) -> list[tuple[NDArray[np.intp], Mask]]:
    """Sweeps of each pixel that has unreserved ones, and a mask of the reserved ones."""
    groups = [np.flatnonzero(pixel == each) for each in np.unique(pixel)]
    return [(each, reserved[each]) for each in groups if not reserved[each].all()]


def _split(
    groups: Sequence[tuple[NDArray[np.intp], Mask]], k: int, random: np.random.Generator
) -> Split:
    added, tested = [], []
    for each, kept in groups:
        order = np.concatenate([each[kept], random.permutation(each[~kept])])
        added.append(order[:k])
        tested.append(order[max(k, kept.sum()) :])
    return Split(np.sort(np.concatenate(added)), np.sort(np.concatenate(tested)))


def _distant(places: Integer, count: int) -> Integer:
    """The first of the places, and others, each as far as possible from the previous ones."""
    if not len(places) or not count:
        return places[:0]
    chosen = [0]
    distance = np.full(len(places), np.inf)
    while len(chosen) < min(count, len(places)):
        last = np.linalg.norm(places - places[chosen[-1]], axis=1)
        distance = np.minimum(distance, last)
        chosen.append(int(distance.argmax()))
    return places[chosen]
