"""Fingers on the cells of a grid, each spread uniformly over the skin under it."""

from __future__ import annotations

import numpy as np

from ..arrays import Integer, Real
from ..press.batch import PressBatch
from ..press.parts import parts_of
from ..press.rasterized import Footprints, rasterized
from ..scene.parts import Skin
from .pixel_coverage import pixel_coverage


def with_fingers_at(
    skin: Skin, batch: PressBatch, touches: Integer, placed: Footprints, grid: tuple[int, int]
) -> PressBatch:
    """Presses with the fingers of their touches, as parts of M that rise by F.

    See `Parts`. touches: number in each press, shape (press,). placed: their footprints. grid: rows
    and columns of cells.
    """
    for number in range(placed.finger.shape[1] if placed.finger.any() else 0):
        own = Footprints._make(each[:, number : number + 1] for each in placed)
        there = (touches > number) & (own.finger[:, 0] > 0)
        twice = own._replace(factor=np.full_like(own.factor, 2.0))
        covered = rasterized(skin, there.astype(np.int64), twice, grid)
        batch = batch.and_(_spread(skin, covered, own.finger[:, 0], grid))
    return batch


def with_fingers_on(
    skin: Skin, batch: PressBatch, finger: Real, cells: Integer, grid: tuple[int, int]
) -> PressBatch:
    """Presses as from `with_fingers_at` for touches of equally many whole cells.

    finger: F, shape (press, touch); 0 where there is none. cells: shape (press, touch, cell).
    """
    for own, under in zip(finger.T, np.moveaxis(cells, 1, 0), strict=True):
        there = own > 0
        starts = np.concatenate([[0], np.cumsum(there * under.shape[1])])
        covered = PressBatch(under[there].ravel(), np.ones(starts[-1]), starts)
        batch = batch.and_(_spread(skin, covered, own, grid))
    return batch


def _spread(skin: Skin, covered: PressBatch, finger: Real, grid: tuple[int, int]) -> PressBatch:
    """Finger of one touch of each press, spread over the cells that it covers.

    covered: cells, and the covered part of each. finger: F, shape (press,).
    """
    press, area = covered.press, covered.rises
    if not skin.rectangular:
        area = area * pixel_coverage(skin, grid).part[covered.cells]
    whole = np.bincount(press, area, covered.count)
    cells = parts_of(skin, grid).finger(covered.cells)
    return PressBatch(cells, finger[press] * area / whole[press], covered.starts)
