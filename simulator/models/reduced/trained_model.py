"""Presses of a scene's pixels, solved by the reduced models of its skin, trained at first use."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ...arrays import Integer, Mask, Real
from ...press.press import Press
from ...press.rasterized import fingers, touched_cells
from ...press.touch import AnyTouch, Depth, Indentation, Touch
from ...scene.parts import SceneParts
from ...sweeps import InputError
from ..model import GivenPress, Model
from ..solution import ModelResult, SolutionProgress
from .cases import pixel_touches, strongest_finger
from .depth_touches import DepthTouches
from .greedy import reduce
from .reduced_skin import KRYLOV_SHARE, ReducedSkin
from .touches import deepest, spreads

TRAINED = (0.5, 3.0)
"""Range of capacitance factors that a model is trained on."""
SHALLOW = 0.05
"""Smallest depth that a model is trained on, over the largest."""


class TrainedModel(Model):
    """Reduced model of presses by factors, and one of presses that the foam's tension spreads.

    rtol: tolerance of Rs and Cp. frequency: Hz, ascending; both are certified between its ends.
    """

    name = "reduced"

    def __init__(self, parts: SceneParts, rtol: float, frequency: Real) -> None:
        self.parts, self.rtol, self.frequency = parts, rtol, frequency

    def check(self, press: GivenPress) -> None:
        """Takes any press; `solve` says what the models are not trained on."""

    def solve(self, press: GivenPress, progress: SolutionProgress) -> None:
        """Offers the result at all frequencies for which the models are certified.

        Raises InputError for touches that are no pixels, that are stronger, deeper or nearer to
        each other than those of the training, and with the frequencies that are left.
        """
        requested, (low, high) = progress.frequency, self.frequency[[0, -1]]
        within: Mask = (low <= requested) & (requested <= high)
        if within.any():
            progress.offer(self.result(press, requested[within]), within)
        if not within.all():
            beyond = ", ".join(f"{f:g}" for f in requested[~within])
            raise InputError(
                f"the model is trained for frequencies from {low:g} to {high:g} Hz, got {beyond}"
            )

    def result(self, press: GivenPress, frequency: Real) -> ModelResult:
        """Result with its certified error, which includes the mesh; raises as `solve` does."""
        if press.press.indented and spreads(self.parts.skin):
            cells, rises, uncertainty = self._indented(press.press)
            skin = self._by_depth
        else:
            known = press.uniform or press.sharp
            self._check_factors(known)
            (cells, rises), skin, uncertainty = self._touched(known), self._by_factor, 0.0
        model = skin.reduced
        at_most = skin.certificate(cells, rises, frequency) + KRYLOV_SHARE * model.rtol
        name = f"reduced to {model.size} vectors, {model.circuit.description}"
        Z = skin.sweep(cells, rises, frequency)
        return ModelResult(name, model.size, Z, at_most + model.mesh_error + uncertainty)

    @cached_property
    def _by_factor(self) -> ReducedSkin:
        draw = pixel_touches(self.parts.skin, self.parts.plan, TRAINED)
        return reduce(self.parts, self.rtol, draw, frequency=self.frequency).skin(None)

    @cached_property
    def _by_depth(self) -> ReducedSkin:
        skin, most = self.parts.skin, deepest(self.parts.skin)
        factors = skin.factor_at(SHALLOW * most), skin.factor_at(most)
        trained = pixel_touches(skin, self.parts.plan, factors)
        given = self.parts, self.rtol, trained
        return reduce(*given, frequency=self.frequency, by_depth=True).skin(None)

    def _check_factors(self, press: Press) -> None:
        low, high = TRAINED
        if not all(isinstance(touch, Touch) for touch in press.touches):
            raise InputError(f"the model takes touches of whole pixels only, got {press}")
        for touch in press.touches:
            if not low <= touch.factor <= high:
                raise InputError(
                    f"the model is trained on factors from {low} to {high}, got {touch}"
                )
            self._check_finger(touch)

    def _check_finger(self, touch: AnyTouch) -> None:
        most = strongest_finger(self.parts.skin, self.parts.plan)
        if touch.finger and touch.finger > most:
            raise InputError(f"the model is trained on fingers up to {most:g} F, got {touch}")

    def _touched(self, press: Press) -> tuple[Integer, Real]:
        """Cells and rises of a press by factors."""
        skin, (cells, rises) = self._by_factor, touched_cells(self.parts.skin, press)
        if not skin.reduced.on_skin[skin.parts.pixels(cells[None])[0]].all():
            raise InputError(f"press {press}: there is no skin at that place")
        return cells, rises

    def _indented(self, press: Press) -> tuple[Integer, Real, float]:
        """Cells and rises of a press by depths and forces, and uncertainty of a factor.

        The uncertainty is relative; it comes from the depths under forces.
        """
        pixels, most = self._pixels(press), deepest(self.parts.skin)
        columns, touches = self.parts.skin.pixels.columns, self._by_depth.reduced.touches
        assert isinstance(touches, DepthTouches)
        known = touches.applicators
        cells, depths, uncertainty = [], [], 0.0
        for place, touch in pixels:
            pixel = (place.row - 1) * columns + place.column - 1
            if known.of_pixel[pixel] < 0:
                raise InputError(f"press {press}: there is no skin at that place")
            depth, off = touch.by.value, 0.0
            if not isinstance(touch.by, Depth):
                of_force = touch.by.value, known.mechanics.elastic, known.thickness
                depth, off = known.depth_series_of(pixel).depth_under(*of_force)
                _check_depth(depth, most, touch)
            cells.append(pixel)
            depths.append(depth)
            strain = np.array(depth / known.thickness)
            uncertainty += off / known.thickness * float(known.mechanics.gain(strain))
        self._check_forces(press, np.array(cells))
        own = fingers(self.parts.skin, press)
        found = known.mechanics.factor(np.array(depths) / known.thickness) - 1
        cells = np.concatenate([np.array(cells, dtype=np.int64), own.cells])
        return cells, np.concatenate([found, own.rises]), uncertainty

    def _pixels(self, press: Press) -> list[tuple[Touch, Indentation]]:
        """Pressed pixels and their indentations."""
        found, most = [], deepest(self.parts.skin)
        for touch in press.touches:
            if not isinstance(touch, Indentation) or not isinstance(touch.place, Touch):
                raise InputError(f"the model takes pixels by depth or force only, got {press}")
            if isinstance(touch.by, Depth):
                _check_depth(touch.by.value, most, touch)
            self._check_finger(touch)
            found.append((touch.place, touch))
        return found

    def _check_forces(self, press: Press, cells: Integer) -> None:
        """Raises InputError for coupled touches if one is by force, as its depth depends on the
        others."""
        by_force = any(not isinstance(touch.by, Depth) for touch in press.indented)
        if by_force and self._by_depth.reduced.family.rises.coupled(cells):
            raise InputError(
                f"press {press}: a touch of given force is too near to another for the model"
            )


def _check_depth(depth: float, most: float, touch: Indentation) -> None:
    if not depth <= most:
        raise InputError(f"the model is trained on depths up to {most:.4g} m, got {touch}")
