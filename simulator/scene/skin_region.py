"""Region of a skin: its boundary curves, and the positions on it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import Mask, Real
from .form import Curve
from .planar import Circle, Points, inside, reach_into, sides
from .skin import SheetsAndFoam


def curves(skin: SheetsAndFoam) -> list[Curve]:
    """Boundary of a skin without mesh: the outer curve first, then the curves of its holes."""
    if skin.outline is not None:
        return [skin.outline, *skin.outline.holes]
    x, y = skin.length, skin.width
    return [Curve(points=((0.0, 0.0), (x, 0.0), (x, y), (0.0, y)))]


def on_skin(skin: SheetsAndFoam, x: Real) -> Mask:
    """True where positions x in m, shape (2, ...), are on a skin without mesh, shape (...)."""
    around, *holes = curves(skin)
    found = around.holds(x)
    for hole in holes:
        found = found & ~hole.holds(x)
    return found


def covers(skin: SheetsAndFoam, x: Real) -> Mask:
    """True where positions x in m, shape (2, ...), are on the skin seen along z, shape (...)."""
    if skin.mesh is None:
        return on_skin(skin, x)
    surface = skin.mesh.surface
    found = np.zeros(x.shape[1:], dtype=bool)
    for corners in surface.p[:2, surface.t].transpose(2, 1, 0):
        low, high = corners.min(axis=0), corners.max(axis=0)
        near = np.flatnonzero(
            ((x[0] >= low[0]) & (x[0] <= high[0]) & (x[1] >= low[1]) & (x[1] <= high[1])).ravel()
        )
        found.ravel()[near] |= inside(corners, x.reshape(2, -1)[:, near])
    return found


def reaches_into(skin: SheetsAndFoam, low: Sequence[Points], high: Sequence[Points]) -> list[bool]:
    """True for each rectangle between corners (x, y), in m, that contains a part of a skin.

    An edge of the skin runs through such a rectangle, or the whole rectangle lies on the skin. A
    mesh in space counts by its view along z.
    """
    if skin.mesh is not None:
        surface = skin.mesh.surface
        triangles = surface.p[:2, surface.t].transpose(2, 1, 0)
        return [reach_into(triangles, *ends) for ends in zip(low, high, strict=True)]
    shapes = [curve.shape for curve in curves(skin)]
    circles = [shape for shape in shapes if isinstance(shape, Circle)]
    straight = [sides(shape) for shape in shapes if not isinstance(shape, Circle)]
    edges = np.concatenate([np.empty((0, 2, 2)), *straight])
    covered = on_skin(skin, (np.array(low) + high).T / 2)
    return [
        bool(within) or reach_into(edges, *ends) or any(each.passes(*ends) for each in circles)
        for *ends, within in zip(low, high, covered, strict=True)
    ]
