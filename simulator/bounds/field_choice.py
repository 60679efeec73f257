"""Choice of the fields that compute a scene's limits."""

from __future__ import annotations

import math

from ..models.heterogeneous.materials import gauged
from ..models.reduced.touches import scene_spreads_presses
from ..models.terminals import needs_all_terminals
from ..scene.parts import Pressing, SceneParts, Skin
from ..sweeps import InputError, ToleranceError
from .full_fields import CELLS_PER_PIXEL, FullFields
from .reduced_fields import ReducedFields, trained
from .touch_rasterizers import TouchSize

AnyFields = FullFields | ReducedFields


CELLS_UNDER_TOUCH, MAX_CELLS = 6, 36
"""Smallest number of cells along a touch by depth, and largest along each side of a pixel."""
ROUNDING = 1e-6
"""Tolerance of a number of cells."""


def fields_of(
    parts: SceneParts, highest: float, touch: TouchSize, cells: int | None = None
) -> AnyFields:
    """A reduced model of all terminals for `many` interfaces, otherwise finite elements.

    Training of the reduced model pays off for many interfaces only. highest: Hz. cells: along each
    side of a pixel, by default `cells_under`. Raises as `cells_under` does.
    """
    parts = parts if touch.finger else parts.for_rods
    skin, setup, press = parts.skin, parts.setup, parts.plan.press
    cells = cells or cells_under(skin, press, touch)
    if skin.uniform and needs_all_terminals(skin, setup, press):
        try:
            return trained(parts, highest, touch, cells)
        except ToleranceError:
            pass
    return FullFields(parts, highest, cells)


def cells_under(skin: Skin, pressing: Pressing, touch: TouchSize) -> int:
    """Number of cells along each side of a pixel.

    Where a touch by depth also changes the foam next to it, a touch has at least CELLS_UNDER_TOUCH
    cells; with fewer, its slopes by position would be wrong. This does not hold for sheets with
    piezoresistance, where each cell is a term of K. Raises InputError for more than MAX_CELLS.
    """
    if not scene_spreads_presses(skin, pressing) or gauged(skin):
        return CELLS_PER_PIXEL
    rows, columns = skin.pixels.shape
    across = max(skin.length / columns / touch.width, skin.width / rows / touch.height)
    cells = max(CELLS_PER_PIXEL, math.ceil(CELLS_UNDER_TOUCH * across - ROUNDING))
    if cells > MAX_CELLS:
        smallest = CELLS_UNDER_TOUCH / MAX_CELLS
        raise InputError(
            f"{skin.name}: a touch by depth must be at least {smallest:.3g} of "
            f"a pixel wide, got {1 / across:.3g}; use a larger touch, or more and smaller `pixels`"
        )
    return cells
