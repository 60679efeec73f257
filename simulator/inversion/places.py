"""Touches anywhere on the skin, as tables over place and strength that splines run through."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..press.batch import NOTHING, PressBatch
from ..press.press import Press
from ..press.touch import Rectangle
from ..scene.scene import Scene
from ..scene.skin import covers
from .unknown_skin import UnknownSkin

NODES, STRENGTH_NODES = 15, 4
CELLS_PER_TOUCH, MOST_CELLS = 3, 40
"""Along its side, that a touch is laid on by the area it covers; and along the skin's, at most."""
SQUARE = math.sqrt(math.pi) / 2
"""Side of a square over the diameter of the disc of its area."""
SIZE_STEP = 0.05
GROUND = 96
"""Cells along each side, of which is told whether they are skin."""
QUANTILES = (np.arange(512) + 0.5) / 512


def cells_per_pixel(scene: Scene) -> int:
    """Along each side, so that the data set's touches cover enough of them."""
    side, _ = touch_size(scene)
    skin, pixels = scene.skin, scene.pixels
    needed = CELLS_PER_TOUCH / side * max(skin.length / pixels.columns, skin.width / pixels.rows)
    most = MOST_CELLS // max(pixels.rows, pixels.columns)
    return max(1, min(math.ceil(needed - 1e-9), most))


def place_tables(unknown: UnknownSkin, strengths: NDArray[np.float64]) -> dict[str, NDArray]:
    """Squares of the mean size of the data set's touches, whole on the skin, laid on cells.

    x, y [m], strength_nodes: where; values (x, y, strength, number): what is observed against rest;
    skin (x, y, number, unknown): of the unknowns at the middle strength, the last two those of the
    touch's own width and height; sides (2,): of the skin, m. Where the skin is no rectangle,
    on_skin: of even cells over its sides, shape (y, x).
    """
    scene = unknown.forward.scene
    side, deviation = touch_size(scene)
    x, y = (_nodes(side, length) for length in (scene.skin.length, scene.skin.width))
    nodes = _strength_nodes(strengths)
    middle = nodes[len(nodes) // 2]
    places = [(u, v) for u in x for v in y]

    def on_nodes(table: NDArray[np.float64]) -> NDArray[np.float64]:
        return table.reshape(len(x), len(y), *table.shape[1:])

    touched = [unknown.forward.cells(_touch(u, v, side, side, middle)) for u, v in places]
    skin, moved = map(np.array, zip(*(unknown.of_touch(*each) for each in touched), strict=True))
    own, narrow, low = (
        _seen(unknown, [_touch(u, v, *size, middle) for u, v in places])
        for size in (
            (side, side),
            ((1 - SIZE_STEP) * side, side),
            (side, (1 - SIZE_STEP) * side),
        )
    )
    by_size = np.stack([own - narrow, own - low], axis=-1) * deviation / (SIZE_STEP * side)
    values = [
        _seen(unknown, [_touch(u, v, side, side, f) for u, v in places])
        + (f - 1) / (middle - 1) * moved
        for f in nodes
    ]
    return {
        "x": x,
        "y": y,
        "strength_nodes": nodes,
        "values": on_nodes(np.stack(values, axis=1)),
        "skin": on_nodes(np.concatenate([skin, by_size], axis=-1)),
        "sides": np.array([scene.skin.length, scene.skin.width]),
        **({} if scene.skin.rectangular else {"on_skin": _on_cells(scene)}),
    }


def _on_cells(scene: Scene) -> NDArray[np.bool_]:
    """Whether the middles of even cells lie on the skin, shape (y, x)."""
    x, y = ((np.arange(GROUND) + 0.5) / GROUND * side for side in scene.skin.sides)
    return covers(scene.skin, np.stack(np.meshgrid(x, y)))


def touch_size(scene: Scene) -> tuple[float, float]:
    """Mean side of the data set's touches as squares of their areas, and its deviation, m."""
    drawn = scene.dataset.press
    sizes = drawn.size.at(QUANTILES)
    sides = np.concatenate([sizes * (SQUARE if s == "disc" else 1.0) for s in drawn.shape])
    return float(sides.mean()), float(sides.std())


def _nodes(side: float, length: float) -> NDArray[np.float64]:
    """Places of centres, closer together towards the edges."""
    turns = np.cos(np.pi * np.arange(NODES) / (NODES - 1))
    return length / 2 - (length - side) / 2 * turns


def _strength_nodes(strengths: NDArray[np.float64]) -> NDArray[np.float64]:
    low, high = strengths[0], strengths[-1]
    beyond = 0.1 * max(high - low, low - 1)
    return np.linspace(low - beyond, high + beyond, STRENGTH_NODES)


def _touch(x: float, y: float, width: float, height: float, factor: float) -> Press:
    return Press((Rectangle(x, y, width, height, factor),))


def _seen(unknown: UnknownSkin, presses: Sequence[Press]) -> NDArray[np.float64]:
    """What is observed of even skins against rest, shape (press, number)."""
    touched = PressBatch.of([NOTHING, *map(unknown.forward.cells, presses)])
    seen = unknown.seen(unknown.forward.impedances(touched, unknown.values))
    return seen[1:] - seen[0]
