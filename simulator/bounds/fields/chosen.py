"""Which fields a scene's limits are told by."""

from __future__ import annotations

import math

from ...models.heterogeneous.materials import gauged
from ...models.network.terminals import many
from ...models.reduced.indented.draws import felt_beside
from ...scene.scene import Scene
from ...sweeps import InputError, ToleranceError
from ..touches.cells import TouchSize
from .full import CELLS_PER_PIXEL, Fields
from .reduced import ReducedFields, trained

AnyFields = Fields | ReducedFields


UNDER_DEEP, MOST_CELLS = 6, 36
"""Along a touch by depth, and at most along each side of a pixel."""
ROUNDING = 1e-6
"""Of a cell."""


def fields_of(
    scene: Scene, highest: float, touch: TouchSize, cells: int | None = None
) -> AnyFields:
    """A reduced model of all terminals where interfaces are `many`, as training then costs less
    than it saves; else elements. highest: Hz. cells: along each side of a pixel, by default as
    `cells_under` says, and raises as it does."""
    scene = scene if touch.finger else scene.for_rods
    cells = cells or cells_under(scene, touch)
    if scene.uniform and many(scene):
        try:
            return trained(scene, highest, touch, cells)
        except ToleranceError:
            pass
    return Fields(scene, highest, cells)


def cells_under(scene: Scene, touch: TouchSize) -> int:
    """Cells along each side of a pixel.

    Where a touch by depth is felt beside it, so many that it is UNDER_DEEP wide: with fewer its
    slopes by place would err. Not on sheets with piezoresistance, of which each cell is a term of
    K. Raises InputError where that would be more than MOST_CELLS.
    """
    if not felt_beside(scene) or gauged(scene.skin):
        return CELLS_PER_PIXEL
    (rows, columns), skin = scene.pixels.shape, scene.skin
    across = max(skin.length / columns / touch.width, skin.width / rows / touch.height)
    cells = max(CELLS_PER_PIXEL, math.ceil(UNDER_DEEP * across - ROUNDING))
    if cells > MOST_CELLS:
        raise InputError(
            f"{scene.name}: a touch by depth must be at least {UNDER_DEEP / MOST_CELLS:.3g} of "
            f"a pixel wide, got {1 / across:.3g}; more `pixels` are smaller"
        )
    return cells
