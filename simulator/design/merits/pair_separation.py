"""Separation of pairs of presses in the meter's errors, with the effect of unknown strengths."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...arrays import Integer, Real
from ...bounds.touch_readings import Hypothesis
from ...mesh.pixel_coverage import pixel_coverage
from ...press.batch import PressBatch
from ...scene.parts import Pressing, Skin
from ...sweeps.free_space import check_memory
from ..skin_readout import SkinReadout

NEAREST = 10
"""Number of nearest hypotheses that are compared with each; more distant ones hardly matter."""
BYTES_FOR_NUMBER = 16
"""Memory for each pair of presses, doubled while their equations are solved."""
SAME = 1e-3
"""Separation in the meter's errors below which presses are equal, as mirror images are."""


@dataclass(frozen=True)
class Pairs:
    """Pairs of hypotheses of one skin that have different answers.

    separation: difference of their readings, then its change by one standard deviation of each
    strength, over the noise; shape (pair, reading, frequency, 2, 1 + strengths). weight: share of
    all sweeps that is wrong if a pair is always confused, shape (pair,).
    """

    separation: Real
    weight: Real

    def of(self, readings: Sequence[int], frequencies: Sequence[int]) -> Pairs:
        """The pairs at some of the readings and frequencies."""
        return Pairs(_some(_some(self.separation, readings, 1), frequencies, 2), self.weight)


def check_comparable(skin: Skin, target: str) -> None:
    """Raises InputError where all pairs of hypotheses of a target do not fit in memory."""
    touches = 2 if target == "pair" else 1
    count = math.comb(len(pixel_coverage(skin).numbers), touches)
    check_memory(
        BYTES_FOR_NUMBER * (count * (1 + 2 * touches)) ** 2,
        "a comparison of all pairs of presses on {} x {} pixels".format(*skin.pixels.shape),
        "give fewer `pixels`",
    )


def _some(values: Real, which: Sequence[int], axis: int) -> Real:
    """Some entries along an axis; the (large) array itself where all are wanted in order."""
    every = range(values.shape[axis])
    return values if [*which] == [*every] else np.take(values, which, axis)


def pairs(
    on: SkinReadout, among: Sequence[Hypothesis], frequency: Real, against_rest: int
) -> Pairs:
    """Nearest pairs of hypotheses, at all candidates of a skin.

    against_rest: number of averaged baseline sweeps that are subtracted, 0 for none. The noise is
    that of readings of the unpressed skin.
    """
    middle, slopes = _expected(on, among, frequency, against_rest)
    chosen = _nearest(middle, slopes, [each.answer for each in among])
    one, other = chosen.T
    parts = [middle[one] - middle[other], *np.moveaxis(slopes[one], 1, 0)]
    parts += list(-np.moveaxis(slopes[other], 1, 0))
    chance = np.array([each.chance for each in among])
    return Pairs(np.stack(parts, axis=-1), chance[one] + chance[other])


def _expected(
    on: SkinReadout, among: Sequence[Hypothesis], frequency: Real, against_rest: int
) -> tuple[Real, Real]:
    """Readings (hypothesis, reading, frequency, 2) and slopes (hypothesis, touch, ...) over noise.

    Strengths of the touches are one standard deviation above or below their mean, in all
    combinations. The mean over these is the reading, differences are the slopes.
    """
    touches = max(len(each.pixels) for each in among)
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=touches))).reshape(-1, touches)
    likelihood = on.likelihood(frequency, against_rest)
    found = likelihood.observed(_presses(on.parts.skin, on.parts.plan.press, among, signs))
    shape = len(among), len(signs), 2, -1, len(frequency)
    scale = np.moveaxis(likelihood.errors.noise, 0, -1)
    each = np.moveaxis(found.reshape(shape), 2, -1) / scale
    slopes = np.einsum("hs...,st->ht...", each, signs / len(signs))
    return each.mean(axis=1), slopes


def _presses(skin: Skin, press: Pressing, among: Sequence[Hypothesis], signs: Real) -> PressBatch:
    """All combinations of hypotheses and signs of strength."""
    rises = (press.capacitance_factor - 1) * (1 + press.factor_spread * signs)
    return PressBatch.of(each.on(skin, rise) for each in among for rise in rises)


def _nearest(middle: Real, slopes: Real, answers: Sequence[tuple[int, ...]]) -> Integer:
    """Index pairs (one, other), one < other: each hypothesis with its NEAREST others."""
    names = {answer: k for k, answer in enumerate(dict.fromkeys(answers))}
    number = np.array([names[answer] for answer in answers])
    squared = _profiled(middle, slopes)
    squared[number[:, None] == number] = np.inf
    nearest = np.argsort(squared, axis=1, kind="stable")[:, :NEAREST]
    one = np.repeat(np.arange(len(middle)), nearest.shape[1])
    other, found = nearest.ravel(), np.take_along_axis(squared, nearest, axis=1).ravel()
    kept = np.isfinite(found) & (found > SAME**2)
    return np.unique(np.sort(np.column_stack([one, other])[kept], axis=1), axis=0)


def _profiled(middle: Real, slopes: Real) -> Real:
    """Squared distances at the strengths that minimize them, shape (one, other).

    All terms are products of readings and slopes, which are computed once.
    """
    count, touches = slopes.shape[:2]
    flat, turned = middle.reshape(count, -1), slopes.reshape(count * touches, -1)
    flat = flat - flat.mean(axis=0)
    of_middle = flat @ flat.T
    across = (turned @ flat.T).reshape(count, touches, count)
    of_slopes = (turned @ turned.T).reshape(count, touches, count, touches)
    own = np.diagonal(of_middle)
    squared = own[:, None] + own - 2 * of_middle
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
    return squared - hidden
