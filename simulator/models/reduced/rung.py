"""A scene's pixels pressed by capacitance factors, answered by its reduced model."""

from __future__ import annotations

from functools import cached_property

from ...press.capacitance import touched_cells
from ...press.press import Press
from ...press.touch import Touch
from ...scene.scene import Scene
from ...sweeps import InputError
from ..answer import Rung
from .cases import pixel_touches
from .greedy import reduce
from .skin import KRYLOV_SHARE, ReducedSkin

TRAINED = (0.5, 3.0)
"""Factors of capacitance that a model is trained on."""


class OfPixels:
    """Trained at first use. rtol: of Rs and Cp."""

    def __init__(self, scene: Scene, rtol: float) -> None:
        self.scene, self.rtol = scene, rtol

    def rung(self, press: Press) -> Rung:
        """The answer at the scene's frequencies, and its error.

        Raises InputError for touches unlike those that it is trained on.
        """
        _check_trained(press)
        skin, (cells, rises) = self._skin, touched_cells(self.scene, press)
        if not skin.reduced.on_skin[cells].all():
            raise InputError(f"press {press}: there is no skin at that place")
        Z = skin.sweep(cells, rises)
        at_most = skin.certificate(cells, rises) + KRYLOV_SHARE * self.rtol
        told = f"reduced to {skin.reduced.size} vectors, {skin.reduced.circuit.told}"
        return Rung(told, skin.reduced.size, Z, at_most + skin.reduced.mesh_error)

    @cached_property
    def _skin(self) -> ReducedSkin:
        return reduce(self.scene, self.rtol, pixel_touches(self.scene, TRAINED)).skin(None)


def _check_trained(press: Press) -> None:
    if not all(isinstance(touch, Touch) for touch in press.touches):
        raise InputError(f"answers whole pixels, got {press}")
    low, high = TRAINED
    for touch in press.touches:
        if not low <= touch.factor <= high:
            raise InputError(f"trained on factors from {low} to {high}, got {touch}")
