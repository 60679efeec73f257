"""Part of each pixel that is skin, and fingers spread over that part."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ..arrays import Integer, Real
from ..press.batch import PressBatch
from ..press.press import Press
from ..press.rasterized import TouchBatch, spread_finger, with_fingers
from ..scene.parts import Skin


class PixelCoverage(NamedTuple):
    """Part of each pixel that is skin, row by row.

    part: fraction of the pixel's area on the grid that is skin, as seen along z, shape (pixel,).
    middle: middle of that skin, m, shape (2, pixel); 0 where there is none.
    """

    part: Real
    middle: Real

    @property
    def numbers(self) -> Integer:
        """Numbers of the pixels that contain any skin, from 0, ascending."""
        return np.flatnonzero(self.part)


def pixel_coverage(skin: Skin, grid: tuple[int, int] | None = None) -> PixelCoverage:
    """Skin in each pixel, or in each cell of a grid of rows and columns.

    Raises InputError for an unusable mesh file.
    """
    return _cached_coverage(skin if grid is None else skin.on_grid(*grid))


@lru_cache(maxsize=16)
def _cached_coverage(skin: Skin) -> PixelCoverage:
    (rows, columns), (length, width) = skin.pixels.shape, skin.sides
    count = rows * columns
    if skin.rectangular:
        row, column = np.divmod(np.arange(count), columns)
        x, y = (column + 0.5) / columns, (row + 0.5) / rows
        return PixelCoverage(np.ones(count), np.stack([x * length, y * width]))
    from .skin_mesh import domain

    mesh = domain(skin, Press(), max(skin.sides))
    flat = replace(mesh, p=mesh.p[:2])
    pixel, here = flat.pixel[flat.pixel >= 0], flat.pixel >= 0
    area, x, y = (
        np.bincount(pixel, (flat.areas * each)[here], minlength=count)
        for each in (np.ones(len(here)), *flat.middles)
    )
    middle = np.divide([x, y], area, out=np.zeros((2, count)), where=area > 0)
    return PixelCoverage(area * count / (length * width), middle)


def part_of_cells(skin: Skin, grid: tuple[int, int]) -> Real | None:
    """Part of each cell of a grid that is skin, shape (cell,); None on a rectangle."""
    return None if skin.rectangular else pixel_coverage(skin, grid).part


def with_fingers_at(
    skin: Skin, batch: PressBatch, touches: TouchBatch, grid: tuple[int, int]
) -> PressBatch:
    """Presses with the fingers of their touches, see `press.rasterized.with_fingers`."""
    return with_fingers(skin, batch, touches, grid, part_of_cells(skin, grid))


def with_fingers_on(
    skin: Skin, batch: PressBatch, finger: Real, cells: Integer, grid: tuple[int, int]
) -> PressBatch:
    """Presses as from `with_fingers_at` for touches of equally many whole cells.

    finger: F, shape (press, touch); 0 where there is none. cells: shape (press, touch, cell).
    """
    part = part_of_cells(skin, grid)
    for own, under in zip(finger.T, np.moveaxis(cells, 1, 0), strict=True):
        there = own > 0
        starts = np.concatenate([[0], np.cumsum(there * under.shape[1])])
        covered = PressBatch(under[there].ravel(), np.ones(starts[-1]), starts)
        batch = batch.and_(spread_finger(skin, covered, own, grid, part))
    return batch
