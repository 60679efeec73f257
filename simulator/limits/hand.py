"""A hand that presses beside the pixels it means, and what is left to be told."""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp, softmax

from ..bounds.readings import CELLS, LARGEST_FACTOR, LEAST_FACTOR, Hypothesis
from ..measure.readout import errors_of, observed
from ..models.network.terminals import reduced_for
from ..models.reduced.cases import Case
from ..models.reduced.model import Reduced
from ..models.reduced.skin import ReducedSkin
from ..press.batch import PressBatch
from ..press.rasterized import Footprints, rasterized
from ..progress import Progress, silent, tracked
from ..scene.frequency import laplace_variable
from ..scene.randomisation import CUT, AnyDistribution, truncated_normal
from ..scene.scene import Scene

RTOL = 1e-3

MOST_TOUCHES = 2
AT_ONCE = 20_000

Array = NDArray[np.float64]


class Hand:
    """Rectangles on a skin, pressed here and there, more or less: what the meter reads of them.

    presses: factors of capacitance. size: sides of a touch along x and y, m. offset: standard
    deviation of its middle from what was meant, along each side, over that side. What would lie
    beyond the skin is cut off.
    """

    def __init__(
        self,
        scene: Scene,
        presses: AnyDistribution,
        *,
        size: tuple[float, float],
        offset: float = 0.0,
        against_rest: int = 0,
    ) -> None:
        """Raises InputError for a meter without noise."""
        skin, pixels = scene.skin, scene.pixels
        self.scene, self._presses, self._offset = scene, presses, offset
        self._sides, self._extent = np.array(size), np.array([skin.length, skin.width])
        self.grid = CELLS * pixels.rows, CELLS * pixels.columns
        self._model = errors_of(scene, against_rest)

    @classmethod
    def of_pixels(
        cls, scene: Scene, presses: AnyDistribution, *, offset: float = 0.0, against_rest: int = 0
    ) -> Self:
        """Touches as large as a pixel. Raises as the constructor."""
        skin, pixels = scene.skin, scene.pixels
        size = skin.length / pixels.columns, skin.width / pixels.rows
        return cls(scene, presses, size=size, offset=offset, against_rest=against_rest)

    def missing(self, offset: float) -> Self:
        """The same hand, by another offset; both press the skin by one model."""
        other = copy(self)
        other._offset, other._skin = offset, self._skin
        return other

    def pressed(self, meant: Hypothesis, random: np.random.Generator, count: int) -> Array:
        """Whitened readings, without noise, of pixels pressed so many times; (press, number)."""
        pixels = self.scene.pixels
        pitch = self._extent / [pixels.columns, pixels.rows]
        middles = np.array([(j + 0.5, i + 0.5) for i, j in meant.pixels]).reshape(-1, 2) * pitch
        aside = truncated_normal(random.random((count, len(middles), 2)), CUT)
        return self.read(middles + self._offset * self._sides * aside, random)

    def anywhere(self, random: np.random.Generator, count: int) -> tuple[Array, Array]:
        """Middles of touches that lie on the skin whole, m, shape (press, 2), and readings."""
        room = self._extent - self._sides
        middles = self._sides / 2 + random.random((count, 2)) * room
        return middles, self.read(middles[:, None], random)

    def read(self, middles: Array, random: np.random.Generator) -> Array:
        """Of touches around middles, m, shape (press, touch, 2), of random strength."""
        factors = self._presses.at(random.random(middles.shape[:2]))
        parts = range(0, len(middles), AT_ONCE)
        return np.concatenate(
            [self._read(middles[k : k + AT_ONCE], factors[k : k + AT_ONCE]) for k in parts]
        )

    def _read(self, middles: Array, factors: Array) -> Array:
        frequency = self.scene.frequencies
        s = laplace_variable(frequency, self.scene.skin.foam.loss)
        Z = self._skin.sweeps(self._rasterized(middles, factors), s)
        return self._model.whitened(observed(self.scene.leads.seen_through(Z, frequency)))

    def _rasterized(self, middles: Array, factors: Array, sides: Array | None = None) -> PressBatch:
        """Touches on cells. sides: m, of each if not all alike."""
        x, y = np.moveaxis(middles, -1, 0)
        width, height = np.moveaxis(self._sides if sides is None else sides, -1, 0)
        touches = np.full(len(middles), middles.shape[1])
        rectangles = Footprints.rectangles(x, y, width, height, factors)
        return rasterized(self.scene, touches, rectangles, self.grid)

    @cached_property
    def _skin(self) -> ReducedSkin:
        return self._reduced.skin(None)

    @cached_property
    def _reduced(self) -> Reduced:
        divided = self.scene.on_grid(*self.grid)
        low, high = float(self._presses.low), float(self._presses.high)
        range_of = min(LEAST_FACTOR, low), max(LARGEST_FACTOR, high)

        def draw(random: np.random.Generator) -> Case:
            touches = int(random.integers(1, MOST_TOUCHES, endpoint=True))
            middles = random.random((1, touches, 2)) * self._extent
            return Case(
                None, *self._rasterized(middles, random.uniform(*range_of, (1, touches))).one(0)
            )

        return reduced_for(divided, RTOL, draw)


NUMBERS = 16
"""Directions of most change that readings are compared in; the others hold noise alone."""

LOOKED_AT = 100
"""Presses of each answer that tell these directions."""

PAIRS_AT_ONCE = 2**23
WEISZFELD_STEPS = 40
CLOSEST = 1e-4
"""m, within which the middle of the posterior is found."""

Single = NDArray[np.float32]
"""Enough for what a meter's noise covers."""


class Between(NamedTuple):
    """A limit that lies between two estimates, but for their standard error."""

    least: float
    most: float
    error: float


@dataclass(frozen=True)
class Axes:
    """From whitened readings to few numbers."""

    origin: Array
    turn: Array

    def of(self, readings: Array) -> Single:
        """Shape (reading, number)."""
        return ((readings - self.origin) @ self.turn).astype(np.float32)


def accuracy_of_hand(
    hand: Hand,
    among: Sequence[Hypothesis],
    *,
    seed: int = 1,
    draws: int = 1000,
    samples: int = 4000,
    progress: Progress = silent,
) -> Between:
    """Share of sweeps that the best classifier tells right. samples: presses of each hypothesis."""
    drawing, known = (np.random.default_rng([seed, k]) for k in (0, 1))
    axes = _axes(np.concatenate([hand.pressed(each, known, LOOKED_AT) for each in among]))
    chances = np.array([each.chance for each in among])
    which = np.sort(drawing.choice(len(among), draws, p=chances))
    clean = np.concatenate(
        [hand.pressed(among[k], drawing, int(n)) for k, n in zip(*_counted(which), strict=True)]
    )
    measured = axes.of(clean + drawing.standard_normal(clean.shape))
    likely = np.empty((draws, len(among)))
    for k, each in enumerate(tracked(among, "presses", progress)):
        likely[:, k] = _evidence(measured, axes.of(hand.pressed(each, known, samples)))
    return _judged(likely + np.log(chances), among, which)


def distance_of_hand(
    hand: Hand, *, seed: int = 1, draws: int = 500, samples: int = 40_000
) -> tuple[float, float]:
    """Median distance in m between a touch anywhere and the middle of its posterior, and its
    standard error. The middle is that of least mean distance. With few samples it comes out large.
    """
    drawing, known = (np.random.default_rng([seed, k]) for k in (0, 1))
    places, readings = hand.anywhere(known, samples)
    axes = _axes(readings[: LOOKED_AT * LOOKED_AT])
    templates = axes.of(readings)
    truth, clean = hand.anywhere(drawing, draws)
    measured = axes.of(clean + drawing.standard_normal(clean.shape))
    parts = np.array_split(measured, max(1, draws * samples // PAIRS_AT_ONCE))
    told = np.concatenate([_middle(_log_joint(part, templates), places) for part in parts])
    away = np.hypot(*(told - truth).T)
    again = np.random.default_rng([seed, 2]).choice(away, (200, draws))
    return float(np.median(away)), float(np.median(again, axis=1).std(ddof=1))


def _counted(which: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    return np.unique(which, return_counts=True)


def _axes(readings: Array) -> Axes:
    origin = readings.mean(axis=0)
    centred = readings - origin
    _, turn = np.linalg.eigh(centred.T @ centred)
    return Axes(origin, turn[:, ::-1][:, :NUMBERS])


def _log_joint(measured: Single, templates: Single) -> Single:
    """ln of the likelihood of each template but for a constant, shape (reading, template)."""
    return measured @ templates.T - (templates**2).sum(axis=1) / 2


def _evidence(measured: Single, templates: Single) -> Array:
    """ln of the mean likelihood over templates, shape (reading,)."""
    parts = np.array_split(measured, max(1, len(measured) * len(templates) // PAIRS_AT_ONCE))
    sums = [np.asarray(logsumexp(_log_joint(part, templates), axis=1)) for part in parts]
    return np.concatenate(sums) - math.log(len(templates))


def _judged(likely: Array, among: Sequence[Hypothesis], which: NDArray[np.int64]) -> Between:
    answers = [each.answer for each in among]
    names = sorted(set(answers))
    answer = np.array([names.index(each) for each in answers])
    posterior = softmax(likely, axis=1)
    told = np.stack([posterior[:, answer == k].sum(axis=1) for k in range(len(names))], axis=1)
    best = told.max(axis=1, keepdims=True)
    ties = told >= best * (1 - 1e-6)
    right = ties[np.arange(len(told)), answer[which]] / ties.sum(axis=1)
    error = max(right.std(ddof=1), best.std(ddof=1)) / math.sqrt(len(right))
    return Between(float(right.mean()), float(best.mean()), float(error))


def _middle(log_joint: Single | Array, places: Array) -> Array:
    """Of least mean distance from places so likely, by Weiszfeld's iteration, (reading, 2)."""
    share = np.asarray(softmax(log_joint, axis=1))
    middle = share @ places
    for _ in range(WEISZFELD_STEPS):
        away = np.hypot(*(middle[:, None] - places).transpose(2, 0, 1))
        pull = share / np.maximum(away, CLOSEST)
        middle = pull @ places / pull.sum(axis=1, keepdims=True)
    return middle
