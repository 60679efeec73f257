"""Rises of c by the membrane on triangles: the reference for lattices."""

from __future__ import annotations

import numpy as np

from ....arrays import Real
from ....press.batch import NOTHING, TouchedCells
from ....press.press import Press, order
from ....press.touch import Depth, Disc, Indentation, Rectangle
from ....scene.parts import Skin
from ....scene.skin_region import covers
from ..indentation import deformation
from .relaxed_presses import LatticeApplicators, window
from .skin_lattice import Lattice

FACTOR_RTOL = 1e-3
"""Tolerance of the factor anywhere, for comparison with lattices."""
POINTS = 24
"""Sample points along each side of a cell."""


def traced(skin: Skin, lattice: Lattice, applied: LatticeApplicators) -> TouchedCells:
    """Rises as `relaxed_presses.raised` returns them, with a tolerance of FACTOR_RTOL.

    A press takes some tenths of a second.
    """
    if not len(applied.depth):
        return NOTHING
    here, grid = window(lattice, applied), lattice.grid
    y, x = (
        (np.arange(cells.start * POINTS, cells.stop * POINTS) + 0.5) * side / count / POINTS
        for cells, side, count in zip(here, skin.sides[::-1], grid, strict=True)
    )
    at = np.stack(np.broadcast_arrays(x, y[:, None]))
    part = covers(skin, at).astype(np.float64)
    rise = part * (deformation(skin, as_press(applied), FACTOR_RTOL).factor(at) - 1)
    shape = len(y) // POINTS, POINTS, len(x) // POINTS, POINTS
    area, total = (each.reshape(shape).sum(axis=(1, 3)) for each in (part, rise))
    every: Real = np.zeros(grid)
    every[here] = np.divide(total, area, out=np.zeros_like(total), where=area > 0)
    cells = np.flatnonzero(every)
    return TouchedCells(cells, every.ravel()[cells])


def as_press(applied: LatticeApplicators) -> Press:
    """Press by these applicators, for the mechanics on triangles."""
    touches = []
    each = zip(*(own.tolist() for own in applied), strict=True)
    for (left, right, bottom, top), radius, depth in each:
        x, y = (left + right) / 2, (bottom + top) / 2
        box = Rectangle(x, y, right - left, top - bottom, 1.0)
        place = Disc(x, y, radius, 1.0) if radius else box
        touches.append(Indentation(place, Depth(depth)))
    return Press(tuple(sorted(touches, key=order)))
