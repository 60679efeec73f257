"""Presses of a scene's pixels by depth or force, solved by its reduced model."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from ....arrays import Integer, Real
from ....press.press import Press
from ....press.rasterized import fingers
from ....press.touch import Depth, Indentation, Touch
from ....scene.parts import SceneParts
from ....sweeps import InputError
from ...model import GivenPress, TrainedModel
from ...solution import ModelResult
from ..cases import pixel_touches
from ..factor_press_model import certified_result, check_finger
from ..greedy import reduce
from .applicators import deepest
from .indentation_draws import spreads
from .indentation_model import IndentationModel, IndentationSkin

SHALLOW = 0.05
"""Smallest depth that a model is trained on, over the largest."""


class IndentationPressModel(TrainedModel):
    """Reduced model of presses by depth or force, trained at first use.

    rtol: tolerance of Rs and Cp. frequency: Hz, ascending.
    """

    def __init__(self, parts: SceneParts, rtol: float, frequency: Real) -> None:
        super().__init__(frequency)
        self.parts, self.rtol = parts, rtol

    def check(self, press: GivenPress) -> None:
        """Raises InputError unless a tension of the foam spreads touches by depth or force."""
        if not (press.press.indented and spreads(self.parts.skin)):
            raise InputError(f"press {press.press}: the model takes depths and forces that spread")

    def result(self, press: GivenPress, frequency: Real) -> ModelResult:
        """Result at frequencies in Hz within those of the model, with its error.

        Raises InputError for touches that are no pixels, or that are deeper than the applicators
        go.
        """
        cells, rises, uncertainty = self.cells(press.press)
        touched = fingers(self.parts.skin, press.press)
        cells, rises = np.append(cells, touched.cells), np.append(rises, touched.rises)
        known = certified_result(self._skin, cells, rises, frequency)
        return replace(known, error=known.error + uncertainty)

    def cells(self, press: Press) -> tuple[Integer, Real, float]:
        """Pixels, rises of the factor under their applicators, and uncertainty of that factor.

        The uncertainty is relative; it comes from the depths under given forces.
        """
        pixels = self._pixels(press)
        columns, known = self.parts.skin.pixels.columns, self._skin.reduced.applicators
        assert known is not None
        cells, depths, uncertainty = [], [], 0.0
        for place, touch in pixels:
            pixel = (place.row - 1) * columns + place.column - 1
            if known.of_pixel[pixel] < 0:
                raise InputError(f"press {press}: there is no skin at that place")
            depth, off = touch.by.value, 0.0
            if not isinstance(touch.by, Depth):
                of_force = touch.by.value, known.mechanics.elastic, known.thickness
                depth, off = known.depth_series_of(pixel).depth_under(*of_force)
                _check_depth(depth, known.deepest, touch)
            cells.append(pixel)
            depths.append(depth)
            strain = np.array(depth / known.thickness)
            uncertainty += off / known.thickness * float(known.mechanics.gain(strain))
        rises = known.mechanics.factor(np.array(depths) / known.thickness) - 1
        self._check_forces(press, np.array(cells))
        return np.array(cells, dtype=np.int64), rises, uncertainty

    def _pixels(self, press: Press) -> list[tuple[Touch, Indentation]]:
        """Pressed pixels and their indentations. Raises InputError for touches outside the
        training."""
        found = []
        for touch in press.touches:
            if not isinstance(touch, Indentation) or not isinstance(touch.place, Touch):
                raise InputError(f"the model takes pixels by depth or force only, got {press}")
            if isinstance(touch.by, Depth):
                _check_depth(touch.by.value, deepest(self.parts.skin), touch)
            check_finger(touch, self.parts.skin, self.parts.plan)
            found.append((touch.place, touch))
        return found

    def _check_forces(self, press: Press, cells: Integer) -> None:
        """Raises InputError for coupled touches if one is by force: its depth depends on the
        others."""
        by_force = any(not isinstance(touch.by, Depth) for touch in press.indented)
        if by_force and self._skin.reduced.family.coupled(cells):
            raise InputError(
                f"press {press}: a touch of given force is too near to another for the model"
            )

    @cached_property
    def _skin(self) -> IndentationSkin:
        skin, most = self.parts.skin, deepest(self.parts.skin)
        factors = skin.factor_at(SHALLOW * most), skin.factor_at(most)
        trained = pixel_touches(skin, self.parts.plan, factors)
        model = reduce(self.parts, self.rtol, trained, frequency=self.frequency, by_depth=True)
        assert isinstance(model, IndentationModel)
        return model.skin(None)


def _check_depth(depth: float, most: float, touch: Indentation) -> None:
    if not depth <= most:
        raise InputError(f"the model is trained on depths up to {most:.4g} m, got {touch}")
