"""Compares the extent of a mesh with that of the grid of pixels: a mesh in mm is refused."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .mesh_file import MeshSurface

LARGEST = 10.0
"""Factor between the sides of a mesh and of the grid of pixels beyond which a unit is wrong."""
UNITS = {1e3: "mm", 1e2: "cm", 1 / 0.0254: "inches", 1e6: "um", 1e-3: "km"}
"""Numbers of units in 1 m."""
NEAR = 0.05
"""Relative deviation of the sides from such a factor that still suggests the unit."""
OFF = 0.1
"""Distance between edges of mesh and grid, over the sides of the grid, above which it warns."""


def check_extent(surface: MeshSurface, length: float, width: float) -> None:
    """Raises ValueError if a mesh is far larger or smaller than length and width [m]."""
    spans = np.ptp(surface.p[:2], axis=1)
    factor = float(np.exp(np.mean(np.log(np.maximum(spans, 1e-300) / [length, width]))))
    if not (factor <= 1 / LARGEST or factor >= LARGEST):
        return
    units = [unit for number, unit in UNITS.items() if abs(factor / number - 1) < NEAR]
    hint = f"; did you mean {units[0]}?" if units else ""
    raise ValueError(
        f"has a mesh of {spans[0]:.4g} x {spans[1]:.4g} m and a grid of pixels of {length:g} x "
        f"{width:g} m (`length`, `width`), a factor of {factor:.4g}; points of a mesh are in "
        f"m{hint}"
    )


def off_grid(surface: MeshSurface, length: float, width: float) -> Iterator[str]:
    """A warning if a mesh is off the grid of pixels, whose corner is at x = y = 0."""
    low, high = surface.p[:2].min(axis=1), surface.p[:2].max(axis=1)
    sides = np.array([length, width])
    if (np.maximum(np.abs(low), np.abs(high - sides)) > OFF * sides).any():
        spans = [
            f"{name} = {1e3 * a:.4g} to {1e3 * b:.4g} mm"
            for name, a, b in zip("xy", low, high, strict=True)
        ]
        yield (
            f"`skin.mesh` lies at {', '.join(spans)}, the grid of pixels at x = 0 to "
            f"{1e3 * length:.4g} mm, y = 0 to {1e3 * width:.4g} mm; move its points, or change "
            "`length` and `width`"
        )
