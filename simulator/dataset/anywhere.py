"""Touches of any size anywhere on the skin, whole inside it, on the cells of a grid."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import astuple

import numpy as np
from numpy.typing import NDArray

from simulator.dataset.presses import MOST_TOUCHES, Presses
from simulator.foam import grid_map
from simulator.press import Disc, Press, Rectangle
from simulator.scene import Scene

LENGTH_DECIMALS = 6
"""Places and sizes are drawn to the micrometre, so that a press as text is the one solved."""
Chances = NDArray[np.float64]


def presses_anywhere(
    scene: Scene,
    touches: NDArray[np.int64],
    chances: Chances,
    factor: NDArray[np.float64],
    grid: tuple[int, int],
) -> Presses:
    """Presses of so many touches; factors multiply where two of them overlap.

    chances: of place along x and y and of size along x and y, shape (4, press, MOST_TOUCHES).
    """
    presses = [
        Press(tuple(sorted(_touches(scene, count, each, strengths), key=_order)))
        for count, each, strengths in zip(touches, chances.transpose(1, 2, 0), factor, strict=True)
    ]
    cells, rises, starts = laid_on_cells(scene, presses, grid)
    centres = np.array([_centres(press) for press in presses])
    return Presses(
        cells=cells,
        rises=rises,
        starts=starts,
        text=[str(press) for press in presses],
        row=np.where(touches == 0, 0, -1),
        column=np.where(touches == 0, 0, -1),
        touches=touches,
        x=centres[..., 0],
        y=centres[..., 1],
        factor=centres[..., 2],
    )


def laid_on_cells(
    scene: Scene, presses: Sequence[Press], grid: tuple[int, int]
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.int64]]:
    """Cells, rises and starts of presses, see `SkinModel.sweeps`."""
    maps = [grid_map(scene, press, *grid).ravel() for press in presses]
    cells = [np.flatnonzero(each != 1) for each in maps]
    rises = [each[where] - 1 for each, where in zip(maps, cells, strict=True)]
    starts = np.concatenate([[0], np.cumsum([where.size for where in cells])])
    return np.concatenate(cells), np.concatenate(rises), starts


def _touches(
    scene: Scene, count: int, chances: Chances, factor: NDArray[np.float64]
) -> Iterator[Rectangle | Disc]:
    """So many touches, chances of shape (touch, 4)."""
    shapes = scene.dataset.press.shape
    for (x, y, wide, high), strength in zip(chances[:count], factor.tolist(), strict=False):
        chance, kind = np.modf(wide * len(shapes))
        width = _length(scene.dataset.press.size.at(chance))
        disc = shapes[int(kind)] == "disc"
        height = width if disc else _length(scene.dataset.press.size.at(high))
        place = _inside(x, width, scene.skin.length), _inside(y, height, scene.skin.width)
        yield (
            Disc(*place, width / 2, strength)
            if disc
            else Rectangle(*place, width, height, strength)
        )


def _order(touch: Rectangle | Disc) -> tuple:
    """As texts of presses have it: rectangles, then discs."""
    return isinstance(touch, Disc), astuple(touch)


def _inside(chance: float, extent: float, length: float) -> float:
    return _length(extent / 2 + chance * (length - extent))


def _length(value: float | np.ndarray) -> float:
    return round(float(value), LENGTH_DECIMALS)


def _centres(press: Press) -> list[tuple[float, float, float]]:
    """x, y and factor of each touch, and of those that there are not."""
    placed = [touch for touch in press.touches if isinstance(touch, Rectangle | Disc)]
    found = [(touch.x, touch.y, touch.factor) for touch in placed]
    return found + [(0.0, 0.0, 1.0)] * (MOST_TOUCHES - len(found))
