"""Hypotheses of touches, and the meter's readings of each."""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, get_args

import numpy as np

from ..arrays import Complex, Real
from ..mesh.pixel_coverage import pixel_coverage
from ..models.mechanics.force_depths import pressed_by_factors
from ..models.reduced.cases import Case, pixel_touches
from ..models.reduced.reduced_model import Reduced
from ..models.reduced.touches import scene_spreads_presses
from ..models.terminals import reduced_for
from ..press.batch import PressBatch, TouchedCells
from ..press.finger import finger_capacitance
from ..press.parts import parts_of
from ..press.touch import Place, Rectangle, Touch
from ..scene.parts import Plan, Pressing, SceneParts, Skin
from ..scene.randomisation import AnyDistribution
from ..scene.supports import supported
from ..sweeps import InputError
from ..sweeps.errors import named
from ..sweeps.free_space import check_memory
from .likelihood import Likelihood
from .pixel_touches import (
    DepthPixelTouches,
    SharpPixelTouches,
    middles,
    rasterized_with_fingers,
    touches_around_pixels,
)
from .rasterization_errors import RasterizationErrors, rasterization_errors, sample_indices

Target = Literal["column", "row", "pixel", "pair", "touches"]
TARGETS: tuple[str, ...] = get_args(Target)

Pixel = tuple[int, int]

BYTES_FOR_HYPOTHESIS = 400
"""Memory for a pair, its container and its answer as Python objects."""

UNPRESSED = (-1, -1)
"""Pixel of the unpressed skin, which becomes row and column 0."""


@dataclass(frozen=True)
class Hypothesis:
    """Touched pixels, (row, column) from 0, with the correct answer and the prior (`chance`).

    fingers: capacitance of each touch to earth, F; empty for rods. presses: True if touches also
    press.
    """

    pixels: tuple[Pixel, ...]
    answer: tuple[int, ...]
    chance: float
    fingers: tuple[float, ...] = ()
    presses: bool = True

    def on(self, skin: Skin, rises: Real) -> TouchedCells:
        """Touched parts (see `Parts`) at these rises, shape (touch,)."""
        columns = skin.pixels.columns
        cells = np.array([i * columns + j for i, j in self.pixels], dtype=np.int64)
        rises = rises[: len(cells)] * self.presses
        if not self.fingers:
            return TouchedCells(cells, rises)
        own = parts_of(skin).finger(cells)
        return TouchedCells(np.concatenate([cells, own]), np.concatenate([rises, self.fingers]))

    @property
    def singles(self) -> list[Hypothesis]:
        """Each of its pressing touches as a hypothesis of its own."""
        fingers = self.fingers or (0.0,) * len(self.pixels)
        each = zip(self.pixels, fingers, strict=True)
        return [
            Hypothesis((pixel,), (), 1.0, (finger,) if finger else ())
            for pixel, finger in each
            if self.presses
        ]


def by_rod(hypothesis: Hypothesis) -> Hypothesis:
    """The hypothesis pressed by a rod, without capacitance to earth."""
    return replace(hypothesis, fingers=())


def touched_alone(hypothesis: Hypothesis) -> Hypothesis:
    """The hypothesis touched by fingers that do not press."""
    return replace(hypothesis, presses=False)


def hypotheses(skin: Skin, plan: Plan, target: str, size: float | None = None) -> list[Hypothesis]:
    """All hypotheses of a target, ordered by answer, with the finger of the scene's `press`.

    column, row, pixel: any one pixel, or none where the scene has a class for the unpressed skin;
    pair: any two; touches: none, one or two, with equal priors. size: see `TouchReadings`. Raises
    InputError for another target, or too few pixels.
    """
    if target not in TARGETS:
        raise InputError(f"{named('target')} must be one of {', '.join(TARGETS)}, got {target!r}")
    pixels = [
        divmod(number, skin.pixels.columns) for number in pixel_coverage(skin).numbers.tolist()
    ]
    if target in ("pair", "touches") and len(pixels) < 2:
        raise InputError(
            f"{named('target')} {target} needs two pixels or more, {skin.name} has one"
        )
    found = _pressed(plan, target, pixels)
    if plan.press.finger:
        found = [_with_fingers(skin, plan.press, each, size) for each in found]
    return sorted(found, key=lambda each: each.answer)


def best_guess(among: Sequence[Hypothesis]) -> float:
    """Accuracy of the best answer without a sweep: the largest probability of an answer."""
    chances: dict[tuple[int, ...], float] = defaultdict(float)
    for each in among:
        chances[each.answer] += each.chance
    return max(chances.values())


def kinds(skin: Skin, plan: Plan, size: float | None = None) -> list[Hypothesis]:
    """Hypotheses of the kind of touch: a rod, a finger that presses, or one that only touches.

    Any one pixel is touched. size: see `TouchReadings`.
    """
    pixels = [each for each in hypotheses(skin, plan, "pixel", size) if each.pixels]
    changes = by_rod, lambda each: each, touched_alone
    return [
        replace(change(each), answer=(number,), chance=1 / (len(changes) * len(pixels)))
        for number, change in enumerate(changes)
        for each in pixels
    ]


def _with_fingers(
    skin: Skin, pressing: Pressing, hypothesis: Hypothesis, size: float | None
) -> Hypothesis:
    how = pressing.finger
    assert how is not None
    places = [place_about(skin, pixel, size) for pixel in hypothesis.pixels]
    fingers = tuple(finger_capacitance(skin, place, how) for place in places)
    return replace(hypothesis, fingers=fingers)


def place_about(skin: Skin, pixel: Pixel, size: float | None) -> Place:
    """A whole pixel, or a square of a size in m around its middle."""
    if size is None:
        return Touch(pixel[0] + 1, pixel[1] + 1, 1.0)
    x, y = middles(skin)[pixel[0] * skin.pixels.columns + pixel[1]]
    return Rectangle(x, y, size, size, 1.0)


def _pressed(plan: Plan, target: str, pixels: list[Pixel]) -> list[Hypothesis]:
    if target == "pair":
        pairs = _pairs(pixels)
        return [Hypothesis(pair, (number,), 1 / len(pairs)) for number, pair in enumerate(pairs)]
    if target == "touches":
        pairs = _pairs(pixels)
        kinds = [[()], [(pixel,) for pixel in pixels], pairs]
        return [
            Hypothesis(pressed, (count,), 1 / (len(kinds) * len(kind)))
            for count, kind in enumerate(kinds)
            for pressed in kind
        ]
    pressed = [((), _answer(target, UNPRESSED))] if plan.unpressed else []
    pressed += [((pixel,), _answer(target, pixel)) for pixel in pixels]
    return [Hypothesis(each, answer, 1 / len(pressed)) for each, answer in pressed]


def _pairs(pixels: list[Pixel]) -> list[tuple[Pixel, ...]]:
    """All pairs of these pixels. Raises InputError where they do not fit in memory."""
    count = math.comb(len(pixels), 2)
    check_memory(BYTES_FOR_HYPOTHESIS * count, f"{count} pairs of pixels", "give fewer `pixels`")
    return list(itertools.combinations(pixels, 2))


def _answer(target: str, pixel: Pixel) -> tuple[int, ...]:
    row, column = (index + 1 for index in pixel)
    return {"column": (column,), "row": (row,), "pixel": (row, column)}[target]


RTOL = 1e-4
CELLS = 3
"""Number of cells along each side of a pixel, for touches of another size."""

MIN_FACTOR, MAX_FACTOR = 0.5, 3.0
"""Smallest range of factors for training."""


class TouchReadings(Likelihood):
    """Likelihood of touches of pixels of a known skin, by its reduced model."""

    def __init__(
        self,
        parts: SceneParts,
        presses: AnyDistribution,
        against_rest: int = 0,
        size: float | None = None,
    ) -> None:
        """presses: distribution of factors. size: side in m of a square touch around the middle of
        each pixel, instead of the whole pixel. Raises InputError for a meter without noise."""
        if size is not None:
            supported("touches of a size", parts)
        self.parts, self._size = parts.for_rods, size
        skin, setup = self.parts.skin, self.parts.setup
        super().__init__(skin, self._solved, setup, parts.meter, against_rest)
        self._factors = (
            min(MIN_FACTOR, float(presses.low)),
            max(MAX_FACTOR, float(presses.high)),
        )
        if size is not None and scene_spreads_presses(parts.skin, parts.plan.press):
            self._factors = 1.0, max(min(MAX_FACTOR, parts.skin.max_factor), float(presses.high))

    def rasterization_errors(self, presses: AnyDistribution) -> RasterizationErrors | None:
        """Errors of touches by depth rasterized on cells, for a sample of pixels and strengths.

        None where touches are whole pixels, or presses end at their edges.
        """
        if self._size is None or not isinstance(self._touches, DepthPixelTouches):
            return None
        pixels = pixel_coverage(self.parts.skin).numbers
        pixels = pixels[sample_indices(len(pixels))]
        rises = np.linspace(presses.low, presses.high, len(pixels)) - 1
        own = [(np.array([k]), np.array([rise])) for k, rise in zip(pixels, rises, strict=True)]
        each = [self._touches.applied(*touch) for touch in own]
        lattice, on_cells = self._touches.lattice, self._rasterized(PressBatch.of(own))

        def impedances(batch: PressBatch) -> Complex:
            return self.setup.at_meter(self._on_cells(batch))

        return rasterization_errors(self.parts, lattice, each, on_cells, impedances)

    def _solved(self, batch: PressBatch) -> Complex:
        """Z of presses of pixels, shape (press, interface, frequency)."""
        return self._on_cells(batch if self._size is None else self._rasterized(batch))

    def _on_cells(self, batch: PressBatch) -> Complex:
        """Z of presses of the model's cells, shape (press, interface, frequency)."""
        return self._reduced.at(None).sweeps(batch, self.setup.frequency)

    def _rasterized(self, batch: PressBatch) -> PressBatch:
        """Touches around the middles of pixels, rasterized on cells."""
        assert self._size is not None
        grid = self.parts.skin.grid(CELLS)
        return rasterized_with_fingers(self.parts.skin, grid, self._touches, batch, self._size)

    @cached_property
    def _divided(self) -> SceneParts:
        """The parts with cells as pixels, each with a uniform rise."""
        return pressed_by_factors(self.parts.divided(CELLS), spread=False)

    @cached_property
    def _touches(self) -> SharpPixelTouches | DepthPixelTouches:
        assert self._size is not None
        grid = self.parts.skin.grid(CELLS)
        skin, press = self.parts.skin, self.parts.plan.press
        return touches_around_pixels(skin, press, grid, self._size, self._factors[1] - 1)

    @cached_property
    def _reduced(self) -> Reduced:
        touches = pixel_touches(self.parts.skin, self.parts.plan, self._factors)
        if self._size is None:
            return reduced_for(self.parts, RTOL, touches)

        def rasterized_touches(random: np.random.Generator) -> Case:
            case = touches(random)
            return Case(None, *self._rasterized(PressBatch.of([(case.cells, case.rises)])).one(0))

        return reduced_for(self._divided, RTOL, rasterized_touches)
