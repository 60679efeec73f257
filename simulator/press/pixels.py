"""The grid of pixels, those that contain skin, and the cells of other grids on the skin."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ..arrays import Integer, Mask, Real
from ..scene.parts import Skin
from ..scene.skin_region import covers, reaches_into

SAME = 1e-8
"""Overlap of skin and pixel over the skin's longer side below which the pixel counts as empty."""
SAMPLES = 16
"""Samples along each side of a cell that the skin's edge passes, or where patches overlap."""


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


class GridCells(NamedTuple):
    """Lines between the cells of a grid, and which part of each cell is skin.

    x, y: lines, m, ascending. cut: number of a cell's samples in `mask`, -1 for a cell that is all
    skin, shape (row, column). mask: True where a sample is on the skin, shape (cut cell, SAMPLES,
    SAMPLES). part: part of each cell that is skin, shape (row, column). whole: True if all is.
    """

    x: Real
    y: Real
    cut: Integer
    mask: Mask
    part: Real
    whole: bool

    @classmethod
    def of(cls, skin: Skin, grid: tuple[int, int]) -> GridCells:
        """Cells of a grid (rows, columns) over the length and width of a skin, each all skin."""
        return _whole_cells(*skin.sides, *grid)

    @classmethod
    def on(cls, skin: Skin, grid: tuple[int, int]) -> GridCells:
        """Cells of a grid, with the part of each that is skin."""
        every, (rows, columns), (length, width) = cls.of(skin, grid), grid, skin.sides
        if skin.rectangular:
            return every
        across, along = ((np.arange(n * SAMPLES) + 0.5) / (n * SAMPLES) for n in grid)
        there = covers(skin, np.stack(np.broadcast_arrays(along * length, across[:, None] * width)))
        samples = there.reshape(rows, SAMPLES, columns, SAMPLES).swapaxes(1, 2)
        part = samples.mean(axis=(2, 3))
        edge = part < 1
        cut = every.cut.copy()
        cut[edge] = np.arange(np.count_nonzero(edge))
        return cls(every.x, every.y, cut, np.ascontiguousarray(samples[edge]), part, False)


@lru_cache(maxsize=16)
def _whole_cells(length: float, width: float, rows: int, columns: int) -> GridCells:
    x, y = np.linspace(0, length, columns + 1), np.linspace(0, width, rows + 1)
    none, grid = np.zeros((0, SAMPLES, SAMPLES), dtype=bool), (rows, columns)
    return GridCells(x, y, np.full(grid, -1), none, np.ones(grid), True)
