"""From a press to the capacitance per area of every pixel."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simulator.press import Press
from simulator.scene import Scene


def capacitance_map(scene: Scene, press: Press) -> NDArray[np.float64]:
    """c in F/m², shape (row, column): the foam at rest, times each touch's factor where it is."""
    c = np.full(
        (scene.pixels.rows, scene.pixels.columns), scene.skin.foam.rest_capacitance_per_area
    )
    for touch in press.touches:
        c[touch.row - 1, touch.column - 1] *= touch.factor
    return c
