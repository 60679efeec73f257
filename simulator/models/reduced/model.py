"""A reduced model: the impedance of any skin of a scene's family, under any press."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...press.capacitance import touched_cells
from ...press.press import Press
from ...scene.frequency import laplace_variable
from ..parameters import Variation
from .projection import Projection
from .skin import ReducedSkin


@dataclass(frozen=True)
class Reduced(Projection):
    """The arrays of a family, and its skins."""

    def impedance(self, press: Press, frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Z in ohm of the scene's own skin, shape (interface, frequency). frequency: Hz.

        Touches that are no pixels count by the area they cover of each.
        """
        s = laplace_variable(frequency, self.scene.skin.foam.loss)
        return self.skin(None).sweep(*touched_cells(self.scene, press), s)

    def skin(
        self, variation: Variation | None, pressed: NDArray[np.float64] | None = None
    ) -> ReducedSkin:
        """One skin of the family, the scene's own for None; pressed: as of `ReducedSkin`.

        Raises InputError where the fields of the family cannot follow the variation.
        """
        return ReducedSkin(self, variation, pressed)
