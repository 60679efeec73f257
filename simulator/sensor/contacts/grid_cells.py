"""Cells of a grid on the skin of a scene, with samples where the skin's edge passes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Integer, Mask, Real
from ...scene.parts import Skin
from ...scene.skin_region import covers

SAMPLES = 16
"""Samples along each side of a cell that the skin's edge passes, or where patches overlap."""


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


def grid_cells(skin: Skin, grid: tuple[int, int]) -> GridCells:
    """Cells of a grid (rows, columns) over the length and width of the skin of a scene."""
    (rows, columns), (length, width) = grid, skin.sides
    x, y = np.linspace(0, length, columns + 1), np.linspace(0, width, rows + 1)
    cut, mask = np.full(grid, -1), np.zeros((0, SAMPLES, SAMPLES), dtype=bool)
    if skin.rectangular:
        return GridCells(x, y, cut, mask, np.ones(grid), True)
    across, along = ((np.arange(n * SAMPLES) + 0.5) / (n * SAMPLES) for n in grid)
    there = covers(skin, np.stack(np.broadcast_arrays(along * length, across[:, None] * width)))
    samples = there.reshape(rows, SAMPLES, columns, SAMPLES).swapaxes(1, 2)
    part = samples.mean(axis=(2, 3))
    edge = part < 1
    cut[edge] = np.arange(np.count_nonzero(edge))
    return GridCells(x, y, cut, np.ascontiguousarray(samples[edge]), part, False)
