"""What a design is best for: the identity of pressed pixels, or the position of a touch.

Each goal has a quick merit of candidates, from a linear likelihood, and an exact score of one skin.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Real
from ..bounds.bayes import Draws
from ..bounds.likelihood import LinearLikelihood
from ..bounds.merits import AccuracyMerit, PositionMerit
from ..bounds.position_bound import (
    ESTIMATED,
    PlaceLikelihood,
    chosen_touch,
    place_likelihood,
    places_on,
)
from ..bounds.reduced_fields import ReducedFields
from ..bounds.touch_pairs import check_comparable, nearest_pairs
from ..bounds.touch_rasterizers import AreaRasterizer, Point, TouchSize
from ..bounds.touch_readings import hypotheses
from ..measure.experiment import own_presses
from ..measure.readout import require_noise
from ..models.reduced.cases import Case, Draw, pixel_touches
from ..scene.design_goals import Design
from ..scene.parts import SceneParts
from ..scene.supports import supported

if TYPE_CHECKING:
    from .trained_skins import SkinReadout

CELLS = 3
"""Number of cells along each side of a pixel on which touches at any position are rasterized."""
ALONG = 5
"""Largest number of positions along each side of the skin."""
FACTORS = (0.5, 3.0)
"""Factors of presses to train the model with."""


class PressedPixels:
    """Presses of whole pixels. Exact scores have the same draws for all designs."""

    merit = AccuracyMerit()
    rtol = 1e-2
    """Certified tolerance of Rs and Cp of every reading; ln Z is about ten times more accurate."""

    def __init__(self, parts: SceneParts, request: Design, draws: int, seed: int) -> None:
        """Raises InputError for a meter without noise, and for too many pixels for the memory."""
        check_comparable(parts.skin, request.target)
        require_noise(parts.meter.readout)
        self.divided, self._press, self._against_rest = (
            parts,
            parts.plan.press,
            request.against_rest,
        )
        self.training_touch: Draw = pixel_touches(parts.skin, parts.plan, FACTORS)
        self._among = hypotheses(parts.skin, parts.plan, request.target)
        presses = own_presses(parts.skin, parts.plan.press)
        self._draws = Draws(self._among, presses, seed, draws)

    def likelihood(self, on: SkinReadout, frequency: Real) -> LinearLikelihood:
        """Nearest pairs of one skin; frequency in Hz, ascending."""
        known = on.likelihood(frequency, self._against_rest)
        return nearest_pairs(known, self._among, self._press)

    def score(self, on: SkinReadout, frequency: Real) -> float:
        """Best share of correct sweeps of one skin; frequency in Hz.

        Raises InputError where the meter's noise is too small.
        """
        known = on.likelihood(frequency, self._against_rest)
        return float(self._draws.score(known).accuracy.share)


class TouchPositions:
    """Touches of the size of a pixel at any position on a scene."""

    rtol = 2e-3
    """As `PressedPixels.rtol`: slopes are less accurate than values; bounds are so to some
    percent."""

    def __init__(self, parts: SceneParts, against_rest: int = 0) -> None:
        """Raises InputError for pixels in groups, and for a scene with surroundings."""
        supported("a design for positions", parts)
        self.divided, self._against_rest = parts.divided(CELLS), against_rest
        self.size: TouchSize = chosen_touch(parts.skin, parts.plan.press)
        self.places: list[Point] = places_on(parts.skin, self.size, CELLS, ALONG)
        sides = parts.skin.length, parts.skin.width
        self.merit = PositionMerit((sides[0] - self.size.width, sides[1] - self.size.height))
        self._cells = AreaRasterizer.of(parts.skin, parts.skin.grid(CELLS))

    def training_touch(self, random: np.random.Generator) -> Case:
        """A random touch to train the model with."""
        return Case(None, *self._cells.drawn(self.size, random))

    def at_places(self, on: SkinReadout, frequency: Real) -> PlaceLikelihood:
        """Likelihood of one skin's readings at every position; frequency in Hz, ascending."""
        return place_likelihood(
            ReducedFields(on.parts, on.skin, 1, on.reading(frequency)),
            self.places,
            self.size,
            frequency,
            model=on.likelihood(frequency, self._against_rest).errors,
            rasterizer=self._cells,
        )

    def likelihood(self, on: SkinReadout, frequency: Real) -> LinearLikelihood:
        """The likelihood of x, y and strength, with the prior of a guess."""
        found = self.at_places(on, frequency).readings
        return replace(found, by=found.by[..., : len(ESTIMATED)], prior=self.merit.prior)

    def score(self, on: SkinReadout, frequency: Real) -> float:
        """1 minus the median error of one skin over that of a guess; frequency in Hz.

        Raises InputError for a meter without noise.
        """
        bounds = self.at_places(on, frequency).bounds()
        return 1 - bounds.median_error() / self.merit.guess


Goal = PressedPixels | TouchPositions
