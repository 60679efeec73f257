"""Information of the readings of a skin on the position of a touch."""

from __future__ import annotations

import numpy as np

from ..arrays import Real
from ..bounds.fields import TouchSize
from ..bounds.fields.reduced_fields import ReducedFields
from ..bounds.position_bound import ESTIMATED, Slopes, chosen_touch, places_on, position_slopes
from ..bounds.touches.touch_rasterizers import AreaRasterizer, Point
from ..models.reduced.cases import Case
from ..scene.parts import SceneParts
from ..sweeps import InputError
from .merits import Pairs, PositionMerit
from .skin_readout import SkinReadout

CELLS = 3
"""Number of cells along each side of a pixel on which touches are rasterized."""
ALONG = 5
"""Largest number of positions along each side of the skin."""


class TouchPositions:
    """Touches of the size of a pixel at any position on a scene."""

    def __init__(self, parts: SceneParts) -> None:
        """Raises InputError for pixels in groups, and for a scene with surroundings."""
        if parts.skin.pixels.groups is not None:
            raise InputError(
                f"{parts.skin.name}: a design for positions needs pixels without `groups`"
            )
        parts.skin.require_sheets_alone("a design for positions")
        self.divided = parts.divided(CELLS)
        self.size: TouchSize = chosen_touch(parts.skin, parts.plan.press)
        self.places: list[Point] = places_on(parts.skin, self.size, CELLS, ALONG)
        self.sides = parts.skin.length, parts.skin.width
        self.room = self.sides[0] - self.size.width, self.sides[1] - self.size.height
        self.cells = AreaRasterizer.of(parts.skin, parts.skin.grid(CELLS))

    @property
    def merit(self) -> PositionMerit:
        """Merit of positions on this skin."""
        return PositionMerit(self.room)

    def training_touch(self, random: np.random.Generator) -> Case:
        """A random touch to train the model with."""
        return Case(None, *self.cells.drawn(self.size, random))

    def slopes(self, on: SkinReadout, frequency: Real, against_rest: int) -> Slopes:
        """Slopes of one skin's readings at every position; frequency in Hz, ascending."""
        reading = on.reading(frequency)
        return position_slopes(
            ReducedFields(on.parts, on.skin, 1, reading),
            self.places,
            self.size,
            frequency,
            model=on.likelihood(frequency, against_rest).errors,
            rasterizer=self.cells,
        )

    def pairs(self, on: SkinReadout, frequency: Real, against_rest: int) -> Pairs:
        """The slopes as `Pairs`, each position with its share of the weight."""
        by = self.slopes(on, frequency, against_rest).by[..., : len(ESTIMATED)]
        return Pairs(by, np.full(len(by), 1 / len(by)))
