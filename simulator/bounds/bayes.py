"""Accuracy of the best classifier of one sweep of a known skin: Bayes' decision.

Presses are drawn and read with the meter's errors. The posterior of every hypothesis is its
likelihood, summed over strengths. The mean probability of the likeliest answer is the accuracy of
the best possible classifier; its standard error is that of the draws. The sum over strengths has
steps of at most STEP of the meter's error, at which it is exact to 3e-4. Readings are a smooth
function of the strength of each touch and are interpolated between a few nodes.
"""

from __future__ import annotations

import itertools
import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from typing import NamedTuple

import numpy as np

from ..arrays import Integer, Mask, Real
from ..chebyshev import barycentric, extrema, refined
from ..measure.experiment import own_presses, strengths
from ..method_cache import cached_method
from ..press.batch import PressBatch
from ..progress import ProgressCallback, silent, tracked
from ..scene.parts import SceneParts, Skin
from ..scene.randomisation import AnyDistribution
from ..sweeps import InputError
from ..sweeps.errors import named
from .likelihood import Likelihood
from .posterior import Templates, axes_of, in_tiles, posterior, posterior_of_tiles, starts_of
from .touch_readings import Hypothesis, TouchReadings, hypotheses

STEP = 1.5
FIRST_STRENGTHS = 9
MAX_TEMPLATES = 3_000_000
MAX_RESIDUAL = 0.015
"""Largest error of interpolation, and of the projection on axes, over the meter's error."""
NODES = (3, 65)
"""First and largest number of strengths of a touch between which others are interpolated."""
CACHED = 256
"""Number of counts of strengths whose weights are cached."""


class BayesAccuracy(NamedTuple):
    """Share of correct sweeps, and its standard error by the number of draws."""

    share: float
    error: float


@dataclass(frozen=True)
class DrawScores:
    """Probability that the best answer to each draw is correct, shape (draw,)."""

    correct: Real

    @property
    def accuracy(self) -> BayesAccuracy:
        """The mean, and its standard error by the number of draws."""
        error = self.correct.std(ddof=1) / math.sqrt(len(self.correct))
        return BayesAccuracy(float(self.correct.mean()), float(error))


def bayes(
    readings: TouchReadings,
    among: Sequence[Hypothesis],
    presses: AnyDistribution,
    seed: int,
    draws: int,
    progress: ProgressCallback = silent,
) -> BayesAccuracy:
    """Bayes' accuracy. among: hypotheses by answer. Raises InputError for too small noise."""
    readings.train(progress)
    random = np.random.default_rng(seed)
    drawn = Draws(among, presses, random, draws, _node_count(readings, among, presses))
    each = [
        readings.whitened(drawn.batch([own], readings.parts.skin))
        for own in tracked(among, "readings", progress)
    ]
    nodes = np.stack(each)
    errors = random.standard_normal((draws, nodes.shape[-1]))
    return drawn.score(nodes, errors).accuracy


def _node_count(
    readings: TouchReadings, among: Sequence[Hypothesis], presses: AnyDistribution
) -> int:
    """Number of nodes at which interpolated readings of every single pixel reach MAX_RESIDUAL."""
    low, high = float(presses.low), float(presses.high)
    if low == high:
        return 1
    alone = {single for each in among for single in each.singles}
    if not alone:
        return NODES[0]
    ordered = sorted(alone, key=lambda each: (each.pixels, each.fingers))

    def values(factors: Real) -> Real:
        each = (own.on(readings.parts.skin, f) for f in factors[:, None] - 1 for own in ordered)
        return readings.whitened(PressBatch.of(each)).reshape(len(factors), len(ordered), -1)

    def close(found: Real, truth: Real) -> bool:
        return bool(np.linalg.norm(found - truth, axis=-1).max() <= MAX_RESIDUAL)

    found = refined(values, (low, high), NODES, close)
    if found is None:
        raise InputError(
            f"the meter's noise is too small: interpolation between {NODES[1]} strengths does not "
            f"reach {MAX_RESIDUAL:g} of it"
        )
    return (len(found.nodes) + 1) // 2  # half the intervals were close already


class Draws:
    """Random presses of hypotheses, and the scores of the best classifier on their readings."""

    def __init__(
        self,
        among: Sequence[Hypothesis],
        presses: AnyDistribution,
        random: np.random.Generator,
        draws: int,
        nodes: int,
    ) -> None:
        """among: hypotheses ordered by answer. nodes: number of strengths of each touch."""
        self._among, self._presses = among, presses
        self._which = random.choice(len(among), draws, p=[each.chance for each in among])
        self._touches = max(1, *(len(each.pixels) for each in among))
        self._factors: Real = presses.at(random.random((draws, self._touches)))
        low, high = float(presses.low), float(presses.high)
        self._nodes = extrema(low, high, nodes) if low < high else np.array([low])

    def __len__(self) -> int:
        return len(self._which)

    def batch(self, among: Sequence[Hypothesis], skin: Skin) -> PressBatch:
        """All hypotheses at all combinations of nodes, as presses on the pixels of a scene."""
        combinations = np.array(list(itertools.product(self._nodes, repeat=self._touches)))
        return PressBatch.of(each.on(skin, rises) for each in among for rises in combinations - 1)

    def score(self, nodes: Real, errors: Real) -> DrawScores:
        """Scores of all draws.

        nodes: whitened readings of `batch`, shape (hypothesis, combination, number). errors:
        whitened errors of the meter, shape (draw, number). Raises InputError for too small noise.
        """
        axes = axes_of(nodes.reshape(-1, nodes.shape[-1]), MAX_RESIDUAL)
        nodes = axes.of(nodes)
        clean = np.einsum("dk,dkn->dn", self._at_draws, nodes[self._which])
        measured = clean + errors @ axes.turn
        known, tiles = self._templates(nodes)
        if self._touches == 1:
            return DrawScores(posterior(known, measured).max(axis=1))
        return DrawScores(posterior_of_tiles(known, tiles, measured).max(axis=1))

    @cached_property
    def _at_draws(self) -> Real:
        """Interpolation from all combinations of nodes to the draws, shape (draw, combination)."""
        found = np.ones((len(self._factors), 1))
        for factors in self._factors.T:
            more = self._between(factors)
            found = (found[:, :, None] * more[:, None, :]).reshape(len(found), -1)
        return found

    def _between(self, factors: Real) -> Real:
        """Interpolation from nodes of one touch to factors, shape (factor, node)."""
        if len(self._nodes) == 1:
            return np.ones((len(factors), 1))
        return barycentric(self._nodes, factors)

    @cached_method(CACHED)
    def _strengths(self, count: int) -> tuple[Real, Real]:
        """Interpolation from nodes of one touch to `count` strengths, shape (strength, node).

        Also returns the weight of each strength.
        """
        found = strengths(self._presses, count)
        return self._between(found.factor), found.weight

    def _templates(self, nodes: Real) -> tuple[Templates, Integer]:
        """Templates of all hypotheses at all strengths, and the starts of their tiles."""
        counts = [self._steps(own) for own in nodes]
        sizes = [math.prod(own) for own in counts]
        if sum(sizes) > MAX_TEMPLATES:
            raise InputError(
                f"the meter's noise is too small for a sum over strengths: {sum(sizes)} templates, "
                f"at most {MAX_TEMPLATES} are supported"
            )
        readings, chance, tiles = [], [], []
        for own, each, count in zip(nodes, self._among, counts, strict=True):
            order, starts, weight = self._tiled(count)
            readings.append(self._at_strengths(own, count)[order])
            chance.append(each.chance * weight)
            tiles.append(starts)
        begun = np.repeat(np.cumsum([0, *sizes[:-1]]), [len(own) for own in tiles])
        answers = starts_of([each.answer for each in self._among], sizes)
        known = Templates(np.concatenate(readings), np.concatenate(chance), answers)
        return known, begun + np.concatenate(tiles)

    @cached_method(CACHED)
    def _tiled(self, counts: tuple[int, ...]) -> tuple[Integer, Integer, Real]:
        """Order and starts of `in_tiles`, and the weight of each strength in that order."""
        order, starts = in_tiles(counts)
        weight = reduce(np.multiply.outer, [self._strengths(count)[1] for count in counts])
        return order, starts, weight.ravel()[order]

    def _at_strengths(self, nodes: Real, counts: Sequence[int]) -> Real:
        """Readings of one hypothesis at all combinations of `counts` strengths of each touch."""
        found = self._by_touch(nodes)
        for touch, count in enumerate(counts):
            turned = np.tensordot(self._strengths(count)[0], found, axes=(1, touch))
            found = np.moveaxis(turned, 0, touch)
        return found.reshape(-1, found.shape[-1])

    def _steps(self, nodes: Real) -> tuple[int, ...]:
        """Numbers of strengths of each touch with steps of at most STEP of the meter's error.

        This holds at all strengths of the other touch.
        """
        if len(self._nodes) == 1:
            return (1,) * self._touches
        found, (turn, _), counts = self._by_touch(nodes), self._strengths(FIRST_STRENGTHS), []
        for touch in range(self._touches):
            steps = np.diff(np.tensordot(turn, found, axes=(1, touch)), axis=0)
            speed = float(np.linalg.norm(steps, axis=-1).max())
            counts.append(max(1, math.ceil(speed * FIRST_STRENGTHS / STEP)))
        return tuple(counts)

    def _by_touch(self, nodes: Real) -> Real:
        """Readings of one hypothesis, shape (node of the first touch, ..., number)."""
        return nodes.reshape(*(len(self._nodes),) * self._touches, -1)


COMMON_NODES = 6
"""Number of strengths of each touch, the same for all skins. Interpolation between them has an
error far below the meter's."""
TARGETS = ("column", "row", "pixel", "pair")
CACHED_ERRORS = 256
"""Number of interfaces whose errors are cached."""


class CommonDraws:
    """Random presses and errors of the meter, and the scores of the best classifier on them."""

    def __init__(
        self,
        parts: SceneParts,
        target: str = "pixel",
        presses: AnyDistribution | None = None,
        *,
        seed: int = 1,
        draws: int = 2000,
    ) -> None:
        """parts: for their pixels. Other arguments: see `bayes_accuracy`.

        Raises InputError for a target other than column, row, pixel and pair.
        """
        if target not in TARGETS:
            raise InputError(
                f"{named('target')} must be one of {', '.join(TARGETS)}, got {target!r}"
            )
        self._skin, self._seed = parts.skin, seed
        self._among = hypotheses(parts.skin, parts.plan, target)
        random = np.random.default_rng(seed)
        self._draws = Draws(
            self._among,
            presses or own_presses(parts.skin, parts.plan.press),
            random,
            draws,
            COMMON_NODES,
        )

    def score(self, known: Likelihood) -> DrawScores:
        """Scores for the likelihood of one skin."""
        nodes = known.whitened(self._draws.batch(self._among, self._skin))
        return self._draws.score(
            nodes.reshape(len(self._among), -1, nodes.shape[-1]),
            self._errors(known.setup.names, known.errors.values),
        )

    def _errors(self, interfaces: Sequence[str], values: Mask) -> Real:
        """Whitened errors, shape (draw, number). values: see `ErrorModel`."""
        found = np.zeros((len(self._draws), *values.shape))
        for k, (name, read) in enumerate(zip(interfaces, values[0], strict=True)):
            found[:, :, k, read] = self._noise(name, int(read.sum()))
        return found[:, values]

    @cached_method(CACHED_ERRORS)
    def _noise(self, interface: str, frequencies: int) -> Real:
        """Whitened errors of one interface, shape (draw, 2, frequency)."""
        random = np.random.default_rng([self._seed, zlib.crc32(interface.encode())])
        return random.standard_normal((len(self._draws), 2, frequencies))
