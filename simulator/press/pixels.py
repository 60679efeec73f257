"""The grid of pixels, and the pixels that contain skin."""

from __future__ import annotations

import numpy as np

from ..arrays import Real
from ..scene.parts import Skin
from ..scene.skin_region import reaches_into

SAME = 1e-8
"""Overlap of skin and pixel over the skin's longer side below which the pixel counts as empty."""


def pixel_lines(skin: Skin, axis: int, grid: tuple[int, int] | None = None) -> Real:
    """Lines between pixels, or between cells of a grid, across x (axis 0) or y (axis 1); m."""
    count = (grid or skin.pixels.shape)[1 - axis]
    return np.linspace(0, skin.sides[axis], count + 1)


def cell_centres(skin: Skin, grid: tuple[int, int]) -> Real:
    """Centres (x, y) of equal cells by rows and columns, m, shape (2, row, column)."""
    row, column = np.indices(grid) + 0.5
    return np.stack([column * skin.length / grid[1], row * skin.width / grid[0]])


def pixels_with_skin(skin: Skin) -> list[tuple[int, int]]:
    """(row, column) from 1 of each pixel that contains skin, row by row."""
    groups = skin.pixels.groups
    every = [(row + 1, column + 1) for row, column in np.ndindex(*skin.pixels.shape)]
    if groups is not None or (skin.outline is None and skin.mesh is None):
        return every
    lines, same = [pixel_lines(skin, axis) for axis in (0, 1)], SAME * max(skin.sides)

    def corner(row: int, column: int) -> Real:
        return np.array([lines[0][column], lines[1][row]])

    low = [corner(row - 1, column - 1) + same for row, column in every]
    high = [corner(row, column) - same for row, column in every]
    there = reaches_into(skin, low, high)
    return [pixel for pixel, has_skin in zip(every, there, strict=True) if has_skin]
