"""What pairs of presses differ by, in the meter's errors, and how their strengths hide it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bounds.readings import Hypothesis
from ..mesh.held import held
from ..press.batch import PressBatch
from ..scene.scene import Scene
from ..sweeps.free_space import check_memory
from .on_skin import OnSkin

NEAREST = 10
"""Other hypotheses that each may be mistaken for; those further off hardly ever are."""
BYTES_FOR_NUMBER = 16
"""Those of every two presses, and once more while equations of them are solved."""
SAME = 1e-3
"""Of the meter's errors: presses that no candidates tell apart, mirror images above all."""


@dataclass(frozen=True)
class Pairs:
    """Pairs of hypotheses with different answers, of one skin.

    apart: from one to the other, then how either strength changes that, each by its standard
    deviation, over the noise: shape (pair, reading, frequency, 2, 1 + strengths). weight: what
    share of all sweeps is lost where a pair is always mistaken, shape (pair,).
    """

    apart: NDArray[np.float64]
    weight: NDArray[np.float64]

    def of(self, readings: Sequence[int], frequencies: Sequence[int]) -> Pairs:
        """At some of the readings and frequencies."""
        return Pairs(_some(_some(self.apart, readings, 1), frequencies, 2), self.weight)


def check_comparable(scene: Scene, target: str) -> None:
    """Raises InputError where every two hypotheses of a target would not fit in memory."""
    touches = 2 if target == "pair" else 1
    count = math.comb(len(held(scene).numbers), touches)
    check_memory(
        BYTES_FOR_NUMBER * (count * (1 + 2 * touches)) ** 2,
        "{} x {} pixels, every two presses compared,".format(*scene.pixels.shape),
        "give fewer `pixels`",
    )


def _some(values: NDArray[np.float64], which: Sequence[int], axis: int) -> NDArray[np.float64]:
    """Entries along an axis; the array itself, which is large, for all of them in their order."""
    every = range(values.shape[axis])
    return values if [*which] == [*every] else np.take(values, which, axis)


def pairs(
    on: OnSkin, among: Sequence[Hypothesis], frequency: NDArray[np.float64], noise: float
) -> Pairs:
    """All candidates of a skin; noise: of a reading over that of a single one."""
    middle, slopes = _expected(on, among, frequency, noise)
    chosen = _nearest(middle, slopes, [each.answer for each in among])
    one, other = chosen.T
    parts = [middle[one] - middle[other], *np.moveaxis(slopes[one], 1, 0)]
    parts += list(-np.moveaxis(slopes[other], 1, 0))
    chance = np.array([each.chance for each in among])
    return Pairs(np.stack(parts, axis=-1), chance[one] + chance[other])


def _expected(
    on: OnSkin, among: Sequence[Hypothesis], frequency: NDArray[np.float64], noise: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Readings (hypothesis, reading, frequency, 2) and slopes (hypothesis, touch, ...) in noise.

    All touches are pressed a standard deviation more or less, in all ways: means of these are the
    reading, differences the slope.
    """
    touches = max(len(each.pixels) for each in among)
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=touches))).reshape(-1, touches)
    found = on.observed(_presses(on.scene, among, signs), frequency)
    shape = len(among), len(signs), 2, -1, len(frequency)
    readout = on.scene.readout
    scale = noise * np.array([readout.magnitude_noise, readout.phase_noise])
    each = np.moveaxis(found.reshape(shape), 2, -1) / scale
    slopes = np.einsum("hs...,st->ht...", each, signs / len(signs))
    return each.mean(axis=1), slopes


def _presses(scene: Scene, among: Sequence[Hypothesis], signs: NDArray[np.float64]) -> PressBatch:
    """Each hypothesis in all ways in turn."""
    press = scene.press
    rises = (press.capacitance_factor - 1) * (1 + press.factor_spread * signs)
    return PressBatch.of(each.on(scene, rise) for each in among for rise in rises)


def _nearest(
    middle: NDArray[np.float64], slopes: NDArray[np.float64], answers: Sequence[tuple[int, ...]]
) -> NDArray[np.int64]:
    """Pairs (one, other) by number, one < other: of each hypothesis those of its NEAREST others."""
    names = {answer: k for k, answer in enumerate(dict.fromkeys(answers))}
    number = np.array([names[answer] for answer in answers])
    apart = _profiled(middle, slopes)
    apart[number[:, None] == number] = np.inf
    nearest = np.argsort(apart, axis=1, kind="stable")[:, :NEAREST]
    one = np.repeat(np.arange(len(middle)), nearest.shape[1])
    other, found = nearest.ravel(), np.take_along_axis(apart, nearest, axis=1).ravel()
    kept = np.isfinite(found) & (found > SAME**2)
    return np.unique(np.sort(np.column_stack([one, other])[kept], axis=1), axis=0)


def _profiled(middle: NDArray[np.float64], slopes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Squares of distances at the strengths that bring each two nearest, shape (one, other).

    All of it is products of readings and slopes, and these are made once.
    """
    count, touches = slopes.shape[:2]
    flat, turned = middle.reshape(count, -1), slopes.reshape(count * touches, -1)
    flat = flat - flat.mean(axis=0)
    of_middle = flat @ flat.T
    across = (turned @ flat.T).reshape(count, touches, count)
    of_slopes = (turned @ turned.T).reshape(count, touches, count, touches)
    own = np.diagonal(of_middle)
    apart = own[:, None] + own - 2 * of_middle
    at = np.arange(count)
    along = across[at, :, at][:, None] - across.transpose(0, 2, 1)
    along = np.concatenate([along, along.transpose(1, 0, 2)], axis=2)
    gram = np.empty((count, count, 2 * touches, 2 * touches))
    gram[..., :touches, :touches] = of_slopes[at, :, at][:, None]
    gram[..., touches:, touches:] = of_slopes[at, :, at]
    gram[..., :touches, touches:] = -of_slopes.transpose(0, 2, 1, 3)
    gram[..., touches:, :touches] = -of_slopes.transpose(0, 2, 3, 1)
    gram += np.eye(2 * touches)
    hidden = (along * np.linalg.solve(gram, along[..., None])[..., 0]).sum(axis=-1)
    return apart - hidden
