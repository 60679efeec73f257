"""Presses of a scene's pixels that reduced models are trained on: by factors, and by applicators.

Applicators are presses by depth or force that the foam's tension spreads.
"""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property

import numpy as np

from ...press.batch import TouchedCells
from ...press.pixels import pixels_with_skin
from ...press.rasterized import fingers
from ...press.touch import AnyTouch, Depth, Indentation, Touch
from ...scene.parts import Plan, Skin
from ...sweeps import InputError
from ..model import Domain, GivenPress
from .cases import Draw, pixel_touches, strongest_finger
from .depth_touches import DepthTouches
from .projection import Projection
from .touches import deepest, spreads

TRAINED = (0.5, 3.0)
"""Range of capacitance factors that a model is trained on."""
SHALLOW = 0.05
"""Smallest depth that a model is trained on, over the largest."""


class PixelPresses(Domain):
    """Domain of a reduced model that is trained on random pixels."""

    name, seconds = "reduced", 5e-6

    def __init__(self, skin: Skin, plan: Plan) -> None:
        self.skin, self.plan = skin, plan

    @property
    @abstractmethod
    def draw(self) -> Draw:
        """Draw of the training."""

    @cached_property
    def _with_skin(self) -> set[tuple[int, int]]:
        return set(pixels_with_skin(self.skin))

    def _refused_finger(self, touch: AnyTouch) -> str | None:
        most = strongest_finger(self.skin, self.plan)
        if touch.finger and touch.finger > most:
            return f"the model is trained on fingers up to {most:g} F, got {touch}"
        return None


class PressesByFactor(PixelPresses):
    """Whole pixels by capacitance factors in TRAINED."""

    @property
    def draw(self) -> Draw:
        """Draw of the training."""
        return pixel_touches(self.skin, self.plan, TRAINED)

    def refuses(self, press: GivenPress) -> str | None:
        """See `Domain`."""
        if press.press.indented and spreads(self.skin):
            return "the model takes presses that no tension spreads"
        known, (low, high) = press.uniform or press.sharp, TRAINED
        for touch in known.touches:
            if not isinstance(touch, Touch):
                return f"the model takes touches of whole pixels only, got {known}"
            if not low <= touch.factor <= high:
                return f"the model is trained on factors from {low} to {high}, got {touch}"
            if (touch.row, touch.column) not in self._with_skin:
                return f"press {known}: there is no skin at that place"
            if refused := self._refused_finger(touch):
                return refused
        return None


class PressesByApplicator(PixelPresses):
    """Whole pixels by depths, and forces, that a tension spreads."""

    @property
    def draw(self) -> Draw:
        """Draw of the training."""
        most = deepest(self.skin)
        return pixel_touches(
            self.skin,
            self.plan,
            (self.skin.factor_at(SHALLOW * most), self.skin.factor_at(most)),
        )

    def refuses(self, press: GivenPress) -> str | None:
        """See `Domain`."""
        if not (press.press.indented and spreads(self.skin)):
            return "the model takes presses that a tension spreads"
        for touch in press.press.touches:
            if not isinstance(touch, Indentation) or not isinstance(touch.place, Touch):
                return f"the model takes pixels by depth or force only, got {press.press}"
            if isinstance(touch.by, Depth) and touch.by.value > deepest(self.skin):
                return _too_deep(deepest(self.skin), touch)
            if refused := self._refused_finger(touch):
                return refused
        return None


def applied(model: Projection, given: GivenPress) -> tuple[TouchedCells, float]:
    """Touched pixels of a press by depths and forces, and relative uncertainty of a factor.

    The uncertainty comes from the depths under forces. Raises InputError outside the domain, for
    forces that press too deep, and for coupled touches of which one is by force, as its depth
    depends on the others.
    """
    skin, touches, press = model.parts.skin, model.touches, given.press
    if refused := PressesByApplicator(skin, model.parts.plan).refuses(given):
        raise InputError(refused)
    assert isinstance(touches, DepthTouches)
    known = touches.applicators
    cells, depths, uncertainty = [], [], 0.0
    for touch in press.indented:
        place = touch.place
        assert isinstance(place, Touch)
        pixel = (place.row - 1) * skin.pixels.columns + place.column - 1
        if known.of_pixel[pixel] < 0:
            raise InputError(f"press {press}: there is no skin at that place")
        depth, off = touch.by.value, 0.0
        if not isinstance(touch.by, Depth):
            of_force = touch.by.value, known.mechanics.elastic, known.thickness
            depth, off = known.depth_series_of(pixel).depth_under(*of_force)
            if not depth <= known.deepest:
                raise InputError(_too_deep(known.deepest, touch))
        cells.append(pixel)
        depths.append(depth)
        strain = np.array(depth / known.thickness)
        uncertainty += off / known.thickness * float(known.mechanics.gain(strain))
    by_force = any(not isinstance(touch.by, Depth) for touch in press.indented)
    if by_force and model.family.rises.coupled(np.array(cells)):
        raise InputError(
            f"press {press}: a touch of given force is too near to another for the model"
        )
    own = fingers(skin, press)
    found = known.mechanics.factor(np.array(depths) / known.thickness) - 1
    pressed = np.concatenate([np.array(cells, dtype=np.int64), own.cells])
    return TouchedCells(pressed, np.concatenate([found, own.rises])), uncertainty


def _too_deep(most: float, touch: Indentation) -> str:
    return f"the model is trained on depths up to {most:.4g} m, got {touch}"
