"""Presses of a scene's pixels by capacitance factors, solved by its reduced model."""

from __future__ import annotations

from functools import cached_property

from ...arrays import Integer, Real
from ...press.press import Press
from ...press.rasterized import touched_cells
from ...press.touch import AnyTouch, Touch
from ...scene.parts import Plan, SceneParts, Skin
from ...sweeps import InputError
from ..model import GivenPress, TrainedModel
from ..solution import ModelResult
from .cases import pixel_touches, strongest_finger
from .greedy import reduce
from .reduced_skin import KRYLOV_SHARE, ReducedSkin

TRAINED = (0.5, 3.0)
"""Range of capacitance factors that a model is trained on."""


class FactorPressModel(TrainedModel):
    """Reduced model of presses by capacitance factors, trained at first use.

    rtol: tolerance of Rs and Cp. frequency: Hz, ascending.
    """

    def __init__(self, parts: SceneParts, rtol: float, frequency: Real) -> None:
        super().__init__(frequency)
        self.parts, self.rtol = parts, rtol

    def check(self, press: GivenPress) -> None:
        """Raises InputError for a press that the foam's tension spreads."""
        if press.deformation:
            raise InputError(f"press {press.press}: the model takes factors only")

    def result(self, press: GivenPress, frequency: Real) -> ModelResult:
        """Result of the press by factors; see `TrainedModel`."""
        return self._result(press.uniform or press.sharp, frequency)

    def _result(self, press: Press, frequency: Real) -> ModelResult:
        _check_trained(press, self.parts.skin, self.parts.plan)
        skin = self._skin
        (cells, rises) = touched_cells(self.parts.skin, press)
        if not skin.reduced.on_skin[skin.parts.pixels(cells[None])[0]].all():
            raise InputError(f"press {press}: there is no skin at that place")
        return certified_result(skin, cells, rises, frequency)

    @cached_property
    def _skin(self) -> ReducedSkin:
        draw = pixel_touches(self.parts.skin, self.parts.plan, TRAINED)
        return reduce(self.parts, self.rtol, draw, frequency=self.frequency).skin(None)


def certified_result(
    skin: ReducedSkin, cells: Integer, rises: Real, frequency: Real
) -> ModelResult:
    """Result of a reduced skin for one press; its error is certified, and includes the mesh."""
    model = skin.reduced
    at_most = skin.certificate(cells, rises, frequency) + KRYLOV_SHARE * model.rtol
    name = f"reduced to {model.size} vectors, {model.circuit.description}"
    return ModelResult(
        name, model.size, skin.sweep(cells, rises, frequency), at_most + model.mesh_error
    )


def _check_trained(press: Press, skin: Skin, plan: Plan) -> None:
    if not all(isinstance(touch, Touch) for touch in press.touches):
        raise InputError(f"the model takes touches of whole pixels only, got {press}")
    low, high = TRAINED
    for touch in press.touches:
        if not low <= touch.factor <= high:
            raise InputError(f"the model is trained on factors from {low} to {high}, got {touch}")
        check_finger(touch, skin, plan)


def check_finger(touch: AnyTouch, skin: Skin, plan: Plan) -> None:
    """Raises InputError for a finger stronger than those that the scene's models are trained on."""
    if touch.finger and touch.finger > strongest_finger(skin, plan):
        strongest = f"{strongest_finger(skin, plan):g} F"
        raise InputError(f"the model is trained on fingers up to {strongest}, got {touch}")
