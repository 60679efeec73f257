"""Accuracy of the best classifier of one sweep of a known skin: Bayes' decision.

Presses are drawn and read with the meter's errors. The posterior of every hypothesis is its
likelihood, summed over strengths. The mean probability of the likeliest answer is the accuracy of
the best possible classifier; its standard error is that of the draws. The sum over strengths has
steps of at most STEP of the meter's error, at which it is exact to 3e-4. Readings are a smooth
function of the strength of each touch and are interpolated between a few nodes.

Errors of readings are independent and normal with standard deviation 1. Templates are expected
readings; the posterior probability of an answer is the sum of those of its templates.
"""

from __future__ import annotations

import itertools
import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Integer, Mask, Real
from ..chebyshev import barycentric, extrema, refined
from ..measure.experiment import strengths
from ..method_cache import cached_method
from ..press.batch import NOTHING, PressBatch
from ..progress import ProgressCallback, silent, tracked
from ..scene.parts import Skin
from ..scene.randomisation import AnyDistribution
from ..sweeps import InputError
from .likelihood import Likelihood
from .touch_readings import Hypothesis

Array = NDArray[Any]
"""Array of float64, or of float32 where that precision is enough."""

AT_ONCE = 20_000_000
"""Largest number of values in memory at once."""


class Axes(NamedTuple):
    """Projection of readings on few orthogonal axes (`turn`), shape (number, axis)."""

    origin: Array
    turn: Array

    def of(self, readings: Array) -> Array:
        """Coordinates of readings, shape (..., number) to (..., axis)."""
        return (readings - self.origin) @ self.turn


def axes_of(readings: Array, left_out: float = 0.0, most: int | None = None) -> Axes:
    """Principal axes of readings, until no residual exceeds `left_out`; at most `most` axes."""
    origin = readings.mean(axis=0)
    centred = readings - origin
    _, turn = np.linalg.eigh(centred.T @ centred)
    turn = turn[:, ::-1]
    left = ((centred @ turn)[:, ::-1] ** 2).cumsum(axis=1)[:, ::-1].max(axis=0)
    return Axes(origin, turn[:, : max(1, int((left > left_out**2).sum()))][:, :most])


class Templates(NamedTuple):
    """Expected readings, grouped by answer.

    readings: shape (template, number). chance: prior of each, shape (template,). starts: index of
    the first template of each answer.
    """

    readings: Array
    chance: Array
    starts: Integer

    @property
    def prior(self) -> Array:
        """Logarithm of the part of the likelihood without the reading, shape (template,)."""
        with np.errstate(divide="ignore"):
            return np.log(self.chance) - (self.readings**2).sum(axis=1) / 2


def starts_of(answers: Sequence[object], counts: Sequence[int]) -> Integer:
    """Index of the first template of each answer.

    answers: of the hypotheses, equal ones next to each other. counts: templates of each hypothesis.
    """
    begun = [k for k in range(len(answers)) if k == 0 or answers[k] != answers[k - 1]]
    return np.cumsum([0, *counts])[begun]


def posterior(known: Templates, measured: Array) -> Array:
    """Probability of each answer to each reading, shape (reading, answer)."""
    chunk, prior = max(1, AT_ONCE // len(known.chance)), known.prior
    parts = [measured[k : k + chunk] for k in range(0, len(measured), chunk)]
    return np.concatenate([_posterior(known, prior, part) for part in parts])


def _posterior(known: Templates, prior: Array, measured: Array) -> Array:
    likely = measured @ known.readings.T
    likely += prior
    likely -= likely.max(axis=1, keepdims=True)
    found = np.add.reduceat(np.exp(likely, out=likely), known.starts, axis=1)
    return found / found.sum(axis=1, keepdims=True)


SIDE = 8
"""Number of strengths of each touch in a tile."""
NEGLIGIBLE = 1e-12
"""Largest relative likelihood of a skipped tile."""


class Balls(NamedTuple):
    """Balls around tiles: middle (ball, number), radius, and prior of all templates (ball,)."""

    middle: Array
    radius: Array
    chance: Array


def in_tiles(counts: tuple[int, ...]) -> tuple[Integer, Integer]:
    """Order of all combinations of strengths by tile, and the start of each tile in it.

    The combinations are numbered with the last touch's strength changing first.
    """
    each = np.indices(counts).reshape(len(counts), -1)
    tile = np.ravel_multi_index(tuple(each // SIDE), tuple(-(-n // SIDE) for n in counts))
    order = np.argsort(tile, kind="stable")
    starts = np.flatnonzero(np.diff(tile[order], prepend=-1))
    return order, starts


def posterior_of_tiles(known: Templates, tiles: Integer, measured: Array) -> Array:
    """Result of `posterior` with a relative error of NEGLIGIBLE times the number of tiles.

    tiles: index of the first template of each, ascending; each tile has one answer.
    """
    balls = _balls(known, tiles)
    step = max(1, AT_ONCE // len(tiles))
    parts = [measured[k : k + step] for k in range(0, len(measured), step)]
    return np.concatenate([_posterior_of_tiles(known, tiles, balls, part) for part in parts])


def _balls(known: Templates, tiles: Integer) -> Balls:
    ends = np.append(tiles[1:], len(known.chance))
    middle = known.readings[(tiles + ends) // 2]
    away = known.readings - np.repeat(middle, ends - tiles, axis=0)
    radius = np.sqrt(np.maximum.reduceat((away**2).sum(axis=1), tiles))
    return Balls(middle, radius, np.add.reduceat(known.chance, tiles))


def _posterior_of_tiles(known: Templates, tiles: Integer, balls: Balls, measured: Array) -> Array:
    near, lower_bound = _near(known, tiles, balls, measured)
    ends = np.append(tiles[1:], len(known.chance))
    answers = np.searchsorted(known.starts, tiles, side="right") - 1
    prior = known.prior
    own = (measured**2).sum(axis=1) / 2 + lower_bound
    total = np.zeros((len(known.starts), len(measured)))
    for tile in np.flatnonzero(near.any(axis=1)).tolist():
        rows, part = np.flatnonzero(near[tile]), slice(tiles[tile], ends[tile])
        likely = measured[rows] @ known.readings[part].T + prior[part] - own[rows, None]
        total[answers[tile], rows] += np.exp(likely).sum(axis=1)
    return (total / total.sum(axis=0)).T


def _near(known: Templates, tiles: Integer, balls: Balls, measured: Array) -> tuple[Mask, Array]:
    """Tiles to evaluate, shape (tile, reading), and a lower bound of the log likelihood."""
    ends = np.append(tiles[1:], len(known.chance))
    squared = (balls.middle**2).sum(axis=1)[:, None] + (measured**2).sum(axis=1)
    squared -= 2 * balls.middle @ measured.T
    np.maximum(squared, 0.0, out=squared)
    with np.errstate(divide="ignore"):
        middle, whole = np.log(known.chance[(tiles + ends) // 2]), np.log(balls.chance)
    lower_bound = (middle[:, None] - squared / 2).max(axis=0)
    gap = np.maximum(np.sqrt(squared) - balls.radius[:, None], 0.0)
    return whole[:, None] - gap**2 / 2 > lower_bound + math.log(NEGLIGIBLE), lower_bound


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
    known: Likelihood,
    among: Sequence[Hypothesis],
    presses: AnyDistribution,
    seed: int,
    draws: int,
    progress: ProgressCallback = silent,
) -> BayesAccuracy:
    """Bayes' accuracy. among: hypotheses by answer. Raises InputError for too small noise."""
    train(known, progress)
    drawn = Draws(among, presses, seed, draws, _node_count(known, among, presses))
    each = [
        known.whitened(drawn.batch([own], known.skin))
        for own in tracked(among, "readings", progress)
    ]
    nodes = np.stack(each)
    errors = drawn.random.standard_normal((draws, nodes.shape[-1]))
    return drawn.score_nodes(nodes, errors).accuracy


def train(known: Likelihood, progress: ProgressCallback = silent) -> None:
    """Trains the likelihood's model, unless it is trained, and reports progress."""
    for _ in tracked([known.skin.name], "training", progress):
        known.impedances(PressBatch.of([NOTHING]))


def _node_count(known: Likelihood, among: Sequence[Hypothesis], presses: AnyDistribution) -> int:
    """Number of nodes at which interpolated readings of every single pixel reach MAX_RESIDUAL."""
    low, high = float(presses.low), float(presses.high)
    if low == high:
        return 1
    alone = {single for each in among for single in each.singles}
    if not alone:
        return NODES[0]
    ordered = sorted(alone, key=lambda each: (each.pixels, each.fingers))

    def values(factors: Real) -> Real:
        each = (own.on(known.skin, f) for f in factors[:, None] - 1 for own in ordered)
        return known.whitened(PressBatch.of(each)).reshape(len(factors), len(ordered), -1)

    def close(found: Real, truth: Real) -> bool:
        return bool(np.linalg.norm(found - truth, axis=-1).max() <= MAX_RESIDUAL)

    found = refined(values, (low, high), NODES, close)
    if found is None:
        raise InputError(
            f"the meter's noise is too small: interpolation between {NODES[1]} strengths does not "
            f"reach {MAX_RESIDUAL:g} of it"
        )
    return (len(found.nodes) + 1) // 2  # half the intervals were close already


COMMON_NODES = 6
"""Number of strengths of each touch, the same for all skins. Interpolation between them has an
error far below the meter's."""
CACHED_ERRORS = 256
"""Number of interfaces whose errors are cached."""


class Draws:
    """Random presses of hypotheses, and the scores of the best classifier on their readings."""

    def __init__(
        self,
        among: Sequence[Hypothesis],
        presses: AnyDistribution,
        seed: int = 1,
        draws: int = 2000,
        nodes: int = COMMON_NODES,
    ) -> None:
        """among: hypotheses ordered by answer. nodes: number of strengths of each touch."""
        self._among, self._presses, self._seed = among, presses, seed
        self.random = random = np.random.default_rng(seed)
        self._which = random.choice(len(among), draws, p=[each.chance for each in among])
        self._touches = max(1, *(len(each.pixels) for each in among))
        self._factors: Real = presses.at(random.random((draws, self._touches)))
        low, high = float(presses.low), float(presses.high)
        self._nodes = extrema(low, high, nodes) if low < high else np.array([low])

    def batch(self, among: Sequence[Hypothesis], skin: Skin) -> PressBatch:
        """All hypotheses at all combinations of nodes, as presses on the pixels of a scene."""
        combinations = np.array(list(itertools.product(self._nodes, repeat=self._touches)))
        return PressBatch.of(each.on(skin, rises) for each in among for rises in combinations - 1)

    def score(self, known: Likelihood) -> DrawScores:
        """Scores for the likelihood of a skin; errors of the meter are the same for all skins."""
        nodes, values = known.whitened(self.batch(self._among, known.skin)), known.errors.values
        errors = np.zeros((len(self._which), *values.shape))
        for k, (name, read) in enumerate(zip(known.setup.names, values[0], strict=True)):
            errors[:, :, k, read] = self._errors(name, int(read.sum()))
        return self.score_nodes(
            nodes.reshape(len(self._among), -1, nodes.shape[-1]), errors[:, values]
        )

    @cached_method(CACHED_ERRORS)
    def _errors(self, interface: str, frequencies: int) -> Real:
        """Whitened errors of one interface, shape (draw, 2, frequency)."""
        random = np.random.default_rng([self._seed, zlib.crc32(interface.encode())])
        return random.standard_normal((len(self._which), 2, frequencies))

    def score_nodes(self, nodes: Real, errors: Real) -> DrawScores:
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
