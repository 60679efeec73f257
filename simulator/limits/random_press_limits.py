"""Limits for presses at random positions: accuracy of pixels, distance of positions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import copy
from functools import cached_property
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from ..arrays import Complex, Integer, Real
from ..bounds.bayes import Templates, axes_of, posterior, starts_of
from ..bounds.likelihood import Likelihood
from ..bounds.touch_readings import CELLS, MAX_FACTOR, MIN_FACTOR, Hypothesis
from ..models.reduced.cases import Case
from ..models.reduced.reduced_model import Reduced
from ..models.reduced.reduced_skin import ReducedSkin
from ..models.terminals import reduced_for
from ..press.batch import PressBatch
from ..press.rasterized import TouchBatch, rasterized
from ..progress import ProgressCallback, silent, tracked
from ..scene.parts import SceneParts
from ..scene.randomisation import CUT, AnyDistribution, truncated_normal
from ..scene.supports import supported

RTOL = 1e-3

MAX_TOUCHES = 2
AT_ONCE = 20_000


class RandomPresses(Likelihood):
    """Random presses of rectangles on a skin, and the meter's readings of them.

    presses: factors of capacitance. size: sides of a touch along x and y, m. offset: standard
    deviation of its middle from that of the pixel, along each side, over that side. Parts of a
    touch outside the skin are cut off.
    """

    def __init__(
        self,
        parts: SceneParts,
        presses: AnyDistribution,
        *,
        size: tuple[float, float],
        offset: float = 0.0,
        against_rest: int = 0,
    ) -> None:
        """Raises InputError for a meter without noise, and for a scene that presses by fingers or
        has walls around touches."""
        supported("a limit with position errors", parts)
        skin = parts.skin
        self.parts, self._presses, self._offset = parts.for_rods, presses, offset
        self._sides, self._extent = np.array(size), np.array([skin.length, skin.width])
        self.grid = skin.grid(CELLS)
        super().__init__(skin, self._solved, self.parts.setup, parts.meter, against_rest)

    @classmethod
    def of_pixels(
        cls,
        parts: SceneParts,
        presses: AnyDistribution,
        *,
        offset: float = 0.0,
        against_rest: int = 0,
    ) -> Self:
        """Presses of the size of a pixel. Raises InputError as the constructor does."""
        skin, pixels = parts.skin, parts.skin.pixels
        size = skin.length / pixels.columns, skin.width / pixels.rows
        return cls(parts, presses, size=size, offset=offset, against_rest=against_rest)

    def with_offset(self, offset: float) -> Self:
        """A copy with another offset that shares the reduced model."""
        other = copy(self)
        other._offset, other._skin = offset, self._skin
        return other

    def pressed(self, hypothesis: Hypothesis, random: np.random.Generator, count: int) -> Real:
        """Whitened readings without noise of `count` presses of pixels, shape (press, number)."""
        pixels = self.parts.skin.pixels
        pitch = self._extent / [pixels.columns, pixels.rows]
        middles = (
            np.array([(j + 0.5, i + 0.5) for i, j in hypothesis.pixels]).reshape(-1, 2) * pitch
        )
        aside = truncated_normal(random.random((count, len(middles), 2)), CUT)
        return self.read(middles + self._offset * self._sides * aside, random)

    def anywhere(self, random: np.random.Generator, count: int) -> tuple[Real, Real]:
        """Middles of random touches inside the skin, m, shape (press, 2), and their readings."""
        room = self._extent - self._sides
        middles = self._sides / 2 + random.random((count, 2)) * room
        return middles, self.read(middles[:, None], random)

    def read(self, middles: Real, random: np.random.Generator) -> Real:
        """Readings of touches of random strength; middles in m, shape (press, touch, 2)."""
        factors = self._presses.at(random.random(middles.shape[:2]))
        parts = range(0, len(middles), AT_ONCE)
        return np.concatenate(
            [self._read(middles[k : k + AT_ONCE], factors[k : k + AT_ONCE]) for k in parts]
        )

    def _read(self, middles: Real, factors: Real) -> Real:
        return self.whitened(self._rasterized(middles, factors))

    def _solved(self, batch: PressBatch) -> Complex:
        return self._skin.sweeps(batch, self.parts.setup.frequency)

    def _rasterized(self, middles: Real, factors: Real, sides: Real | None = None) -> PressBatch:
        """Touches rasterized on cells. sides: of each in m, unless all have the same."""
        x, y = np.moveaxis(middles, -1, 0)
        width, height = np.moveaxis(self._sides if sides is None else sides, -1, 0)
        counts = np.full(len(middles), middles.shape[1])
        rectangles = TouchBatch.rectangles(counts, x, y, width, height, factors)
        return rasterized(self.parts.skin, rectangles, self.grid)

    @cached_property
    def _skin(self) -> ReducedSkin:
        return self._reduced.at(None)

    @cached_property
    def _reduced(self) -> Reduced:
        divided = self.parts.on_grid(*self.grid)
        low, high = float(self._presses.low), float(self._presses.high)
        range_of = min(MIN_FACTOR, low), max(MAX_FACTOR, high)

        def draw(random: np.random.Generator) -> Case:
            touches = int(random.integers(1, MAX_TOUCHES, endpoint=True))
            middles = random.random((1, touches, 2)) * self._extent
            return Case(
                None, *self._rasterized(middles, random.uniform(*range_of, (1, touches))).one(0)
            )

        return reduced_for(divided, RTOL, draw)


MAX_AXES = 16
"""Number of principal directions in which readings are compared; others have only noise."""

AXES_PRESSES = 100
"""Number of presses of each answer that determine these directions."""

PAIRS_AT_ONCE = 2**23
WEISZFELD_STEPS = 40
MIN_DISTANCE = 1e-4
"""m: smallest distance in the iteration for the median of the posterior."""

Single = NDArray[np.float32]
"""Single precision is far below a meter's noise."""


class LimitInterval(NamedTuple):
    """Interval that contains a limit, up to a standard error."""

    lower: float
    upper: float
    error: float


def accuracy_of_presses(
    presses: RandomPresses,
    among: Sequence[Hypothesis],
    *,
    seed: int = 1,
    draws: int = 1000,
    samples: int = 4000,
    progress: ProgressCallback = silent,
) -> LimitInterval:
    """Accuracy of the best classifier of random presses.

    among: hypotheses ordered by answer. samples: presses of each hypothesis.
    """
    drawing, known = (np.random.default_rng([seed, k]) for k in (0, 1))
    looked_at = np.concatenate([presses.pressed(each, known, AXES_PRESSES) for each in among])
    axes = axes_of(looked_at, most=MAX_AXES)
    which = np.sort(drawing.choice(len(among), draws, p=[each.chance for each in among]))
    pressed, counts = np.unique(which, return_counts=True)
    clean = np.concatenate(
        [presses.pressed(among[k], drawing, int(n)) for k, n in zip(pressed, counts, strict=True)]
    )
    measured = _single(axes.of(clean + drawing.standard_normal(clean.shape)))
    each = [
        _single(axes.of(presses.pressed(own, known, samples)))
        for own in tracked(among, "presses", progress)
    ]
    chance = np.repeat([own.chance / samples for own in among], samples)
    starts = starts_of([own.answer for own in among], [samples] * len(among))
    found = posterior(Templates(np.concatenate(each), _single(chance), starts), measured)
    return _accuracy_interval(found, np.searchsorted(starts, samples * which, side="right") - 1)


def distance_of_presses(
    presses: RandomPresses, *, seed: int = 1, draws: int = 500, samples: int = 40_000
) -> tuple[float, float]:
    """Median distance in m between a random touch and its posterior's median, with standard error.

    The median is the point of smallest mean distance. With few samples the result is too large.
    """
    drawing, known = (np.random.default_rng([seed, k]) for k in (0, 1))
    places, readings = presses.anywhere(known, samples)
    axes = axes_of(readings[: AXES_PRESSES * AXES_PRESSES], most=MAX_AXES)
    uniform = np.full(samples, 1 / samples, dtype=np.float32)
    templates = Templates(_single(axes.of(readings)), uniform, np.arange(samples))
    truth, clean = presses.anywhere(drawing, draws)
    measured = _single(axes.of(clean + drawing.standard_normal(clean.shape)))
    parts = np.array_split(measured, max(1, draws * samples // PAIRS_AT_ONCE))
    estimates = np.concatenate(
        [_geometric_medians(posterior(templates, part), places) for part in parts]
    )
    away = np.hypot(*(estimates - truth).T)
    again = np.random.default_rng([seed, 2]).choice(away, (200, draws))
    return float(np.median(away)), float(np.median(again, axis=1).std(ddof=1))


def _single(values: Real) -> Single:
    return values.astype(np.float32)


def _accuracy_interval(probability: Real, answer: Integer) -> LimitInterval:
    """Lower and upper estimates of the accuracy.

    probability: that of each answer, shape (reading, answer). answer: the correct one.
    """
    best = probability.max(axis=1, keepdims=True)
    ties = probability >= best * (1 - 1e-6)
    right = ties[np.arange(len(probability)), answer] / ties.sum(axis=1)
    error = max(right.std(ddof=1), best.std(ddof=1)) / math.sqrt(len(right))
    return LimitInterval(float(right.mean()), float(best.mean()), float(error))


def _geometric_medians(share: Real, places: Real) -> Real:
    """Geometric medians of weighted positions by Weiszfeld's iteration, shape (reading, 2)."""
    middle = share @ places
    for _ in range(WEISZFELD_STEPS):
        away = np.hypot(*(middle[:, None] - places).transpose(2, 0, 1))
        pull = share / np.maximum(away, MIN_DISTANCE)
        middle = pull @ places / pull.sum(axis=1, keepdims=True)
    return middle
