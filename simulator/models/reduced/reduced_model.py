"""Reduced model: the impedance of any skin of a scene's family, under any press."""

from __future__ import annotations

from dataclasses import dataclass

from ...arrays import Complex, Real
from ...notebook_display import SmallChart, Tabular
from ...press.batch import TouchedCells
from ...press.press import Press, press_on
from ...press.rasterized import needs_factors, touched_cells
from ...scene.parts import SceneParts
from ..parameters import Variation
from .projection import Projection
from .reduced_skin import ReducedSkin
from .touches import spreads


def pressed_cells(parts: SceneParts, press: Press) -> TouchedCells:
    """Cells that a press touches, see `touched_cells`, for a model of presses as of the scene.

    Raises InputError also for a depth that tension spreads, if the scene presses by factors.
    """
    if press.indented and spreads(parts.skin) and parts.plan.press.by_factor:
        raise needs_factors(press)
    return touched_cells(parts.skin, press)


@dataclass(frozen=True, repr=False)
class Reduced(Projection, Tabular):
    """Reduced model of a scene's family of skins and presses."""

    def impedance(self, press: Press | str, frequency: Real) -> Complex:
        """Z in ohm of the scene's own skin, shape (interface, frequency).

        frequency: frequencies, Hz, shape (frequency,). press: a press or its text. A touch that is
        no whole pixel counts in each pixel by the area that it covers there. Raises InputError for
        a text that is no press on the scene.
        """
        pressed = (
            press_on(self.parts.skin, self.parts.plan.press, press)
            if isinstance(press, str)
            else press
        )
        return self.skin(None).sweep(*pressed_cells(self.parts, pressed), frequency)

    def _table(self) -> tuple[str, list[tuple[str, ...]]]:
        rows, columns = self.grid
        numbers = f"{self.size}", f"{rows} x {columns}", f"{self.rtol:g}", f"{self.mesh_error:.1e}"
        header = "size of the basis", "pixels", "rtol", "estimated error of the mesh"
        return f"Reduced model of {self.parts.skin.name}", [header, numbers]

    def _chart(self) -> SmallChart:
        from .curves_chart import curves_chart

        return curves_chart(self)

    def skin(self, variation: Variation | None, pressed: Real | None = None) -> ReducedSkin:
        """One skin of the family; the scene's own skin if `variation` is None.

        pressed: see `ReducedSkin`. Raises InputError if the fields of the family cannot represent
        the variation.
        """
        return ReducedSkin(self, variation, pressed)
