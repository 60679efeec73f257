"""Presses beside the pixels that were meant, as a hand does, on the cells of a grid."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from simulator.dataset.anywhere import laid_on_cells
from simulator.dataset.presses import Presses
from simulator.press import Press, Rectangle
from simulator.scene import Scene


def pressed_beside(
    scene: Scene, meant: Presses, aside: NDArray[np.float64], grid: tuple[int, int]
) -> Presses:
    """The presses, told as they were meant, with their touches where they came to lie.

    aside: of each touch along x and y, in standard deviations, shape (2, press, MOST_TOUCHES). What
    would lie beyond the skin is cut off.
    """
    skin, pixels = scene.skin, scene.pixels
    sides = np.array([skin.length / pixels.columns, skin.width / pixels.rows])
    off = scene.dataset.press.offset * sides[:, None, None] * aside
    centres = np.stack([meant.x, meant.y]) + off
    half = sides[:, None, None] / 2
    ends = np.array([skin.length, skin.width])[:, None, None]
    low, high = np.maximum(centres - half, 0.0), np.minimum(centres + half, ends)
    there = np.arange(meant.x.shape[1]) < meant.touches[:, None]
    x, y = np.where(there, (low + high) / 2, 0.0)
    width, height = high - low
    presses = [
        Press(tuple(Rectangle(*each) for each in zip(*touch, strict=True)))
        for touch in (
            [
                values[k, : meant.touches[k]].tolist()
                for values in (x, y, width, height, meant.factor)
            ]
            for k in range(len(meant.touches))
        )
    ]
    cells, rises, starts = laid_on_cells(scene, presses, grid)
    return replace(meant, cells=cells, rises=rises, starts=starts, x=x, y=y)
