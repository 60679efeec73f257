"""Pairs of presses, their distance, and the effects of their unknown strengths on it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from ..arrays import Integer, Real
from ..measure.readout import ErrorModel
from ..mesh.pixel_coverage import pixel_coverage
from ..press.batch import PressBatch
from ..scene.parts import Pressing, Skin
from ..sweeps.free_space import check_memory
from .likelihood import Likelihood, LinearLikelihood, over_noise
from .touch_readings import Hypothesis

NEAREST = 10
"""Number of nearest hypotheses that are compared with each; more distant ones hardly matter."""
BYTES_FOR_NUMBER = 16
"""Memory for each pair of presses, doubled while their equations are solved."""
SAME = 1e-3
"""Separation in the meter's errors below which presses are equal, as mirror images are."""


def pair_likelihood(
    middle: Real, slopes: Real, pairs: Integer, weight: Real | None, model: ErrorModel
) -> LinearLikelihood:
    """Pairs of presses as cases: the first unknown is their difference, then come strengths.

    middle: readings of the presses over the noise, shape (press, interface, frequency, 2). slopes:
    by one standard deviation of the strength of each touch, shape (press, touch, interface,
    frequency, 2). pairs: indices of both presses, shape (pair, 2). weight: see `LinearLikelihood`.
    """
    one, other = pairs.T
    parts = [middle[one] - middle[other], *np.moveaxis(slopes[one], 1, 0)]
    parts += list(-np.moveaxis(slopes[other], 1, 0))
    prior = np.array([0.0] + [1.0] * (len(parts) - 1))
    return LinearLikelihood.of_cases(np.stack(parts, axis=-1), model, prior, weight)


def nearest_pairs(
    known: Likelihood, among: Sequence[Hypothesis], pressing: Pressing
) -> LinearLikelihood:
    """Nearest pairs of hypotheses with different answers.

    The weight of a pair is the share of all sweeps that is wrong if it is always confused.
    """
    middle, slopes = expected(known, among, pressing)
    pairs = nearest(middle, slopes, [each.answer for each in among])
    chance = np.array([each.chance for each in among])
    return pair_likelihood(middle, slopes, pairs, chance[pairs].sum(axis=1), known.errors)


def expected(
    known: Likelihood, among: Sequence[Hypothesis], pressing: Pressing
) -> tuple[Real, Real]:
    """Readings of hypotheses and their slopes, as `pair_likelihood` takes them.

    Strengths of the touches are one standard deviation above or below their mean, in all
    combinations. The mean over these is the reading, differences are the slopes.
    """
    touches = max(len(each.pixels) for each in among)
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=touches))).reshape(-1, touches)
    rises = (pressing.capacitance_factor - 1) * (1 + pressing.factor_spread * signs)
    presses = PressBatch.of(each.on(known.skin, rise) for each in among for rise in rises)
    found = over_noise(known.observed(presses), known.errors)
    each = found.reshape(len(among), len(signs), *found.shape[1:])
    return each.mean(axis=1), np.einsum("hs...,st->ht...", each, signs / len(signs))


def check_comparable(skin: Skin, target: str) -> None:
    """Raises InputError where all pairs of hypotheses of a target do not fit in memory."""
    touches = 2 if target == "pair" else 1
    count = math.comb(len(pixel_coverage(skin).numbers), touches)
    check_memory(
        BYTES_FOR_NUMBER * (count * (1 + 2 * touches)) ** 2,
        "a comparison of all pairs of presses on {} x {} pixels".format(*skin.pixels.shape),
        "give fewer `pixels`",
    )


def nearest(middle: Real, slopes: Real, answers: Sequence[tuple[int, ...]]) -> Integer:
    """Index pairs (one, other), one < other: each hypothesis with its NEAREST others.

    Arguments: see `pair_likelihood`; answers of the hypotheses.
    """
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
