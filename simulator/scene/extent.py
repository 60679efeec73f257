"""Area of a skin and length of its outline."""

from __future__ import annotations

import math

import numpy as np

from .planar import Circle, area
from .skin import SheetsAndFoam
from .skin_region import curves


def surface(skin: SheetsAndFoam) -> float:
    """Area of an unstretched skin without its holes, m²; for a mesh the area of its triangles."""
    if skin.mesh is not None:
        return skin.mesh.surface.area()
    around, *holes = (_enclosed(curve.shape) for curve in curves(skin))
    return around - sum(holes)


def perimeter(skin: SheetsAndFoam) -> float:
    """Length of the outline of an unstretched skin and of its holes, m."""
    if skin.mesh is not None:
        found = skin.mesh.surface
        ends = found.p[:, found.boundary]
        return float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=0).sum())
    return sum(float(curve.marks[-1]) for curve in curves(skin))


def _enclosed(shape: Circle | np.ndarray) -> float:
    return math.pi * shape.radius**2 if isinstance(shape, Circle) else abs(float(area(shape)))
