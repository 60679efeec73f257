"""Which fields a scene's limits are told by."""

from __future__ import annotations

from ...models.network.terminals import many
from ...scene.scene import Scene
from ...sweeps import ToleranceError
from .full import CELLS_PER_PIXEL, Fields
from .reduced import ReducedFields, TouchSize

AnyFields = Fields | ReducedFields


def fields_of(
    scene: Scene, highest: float, touch: TouchSize, cells: int = CELLS_PER_PIXEL
) -> AnyFields:
    """A reduced model of all terminals where interfaces are `many`, as training then costs less
    than it saves; else elements. highest: Hz. cells: along each side of a pixel."""
    if scene.plain and many(scene):
        try:
            return ReducedFields(scene, highest, touch, cells)
        except ToleranceError:
            pass
    return Fields(scene, highest, cells)
