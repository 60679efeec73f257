"""Tables of touches at any position, over position and strength, for splines."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..arrays import Mask, Real
from ..press.batch import NOTHING, PressBatch
from ..press.press import Press
from ..press.touch import Rectangle
from ..scene.parts import Plan, Skin
from ..scene.skin_region import covers
from .unknown_skin import UnknownSkin

NODES, STRENGTH_NODES = 15, 4
CELLS_PER_TOUCH, MAX_CELLS = 3, 40
"""Number of cells along a side of a touch; largest number of cells along a side of the skin."""
SQUARE = math.sqrt(math.pi) / 2
"""Side of a square over the diameter of a disc of the same area."""
SIZE_STEP = 0.05
MASK_CELLS = 96
"""Number of cells along each side of the mask of the skin."""
QUANTILES = (np.arange(512) + 0.5) / 512


def cells_per_pixel(skin: Skin, plan: Plan) -> int:
    """Number of cells along each side of a pixel, so that the data set's touches cover enough."""
    side, _ = touch_size(plan)
    pixels = skin.pixels
    needed = CELLS_PER_TOUCH / side * max(skin.length / pixels.columns, skin.width / pixels.rows)
    most = MAX_CELLS // max(pixels.rows, pixels.columns)
    return max(1, min(math.ceil(needed - 1e-9), most))


def position_tables(unknown: UnknownSkin, strengths: Real) -> dict[str, NDArray]:
    """Tables of square touches inside the skin, of the mean size in the data set.

    x, y [m], strength_nodes: nodes. values (x, y, strength, number): observed change from the
    baseline. skin (x, y, number, unknown): effects of the unknowns at the middle strength; the last
    two are the touch's own width and height. sides (2,): of the skin, m. on_skin: mask of uniform
    cells, shape (y, x), only where the skin is not a rectangle.
    """
    parts = unknown.forward.parts
    side, deviation = touch_size(parts.plan)
    x, y = (_nodes(side, length) for length in (parts.skin.length, parts.skin.width))
    nodes = _strength_nodes(strengths)
    middle = nodes[len(nodes) // 2]
    places = [(u, v) for u in x for v in y]

    def on_nodes(table: Real) -> Real:
        return table.reshape(len(x), len(y), *table.shape[1:])

    touched = [unknown.forward.cells(_touch(u, v, side, side, middle)) for u, v in places]
    skin, moved = map(np.array, zip(*(unknown.of_touch(*each) for each in touched), strict=True))
    own, narrow, low = (
        _observed(unknown, [_touch(u, v, *size, middle) for u, v in places])
        for size in (
            (side, side),
            ((1 - SIZE_STEP) * side, side),
            (side, (1 - SIZE_STEP) * side),
        )
    )
    by_size = np.stack([own - narrow, own - low], axis=-1) * deviation / (SIZE_STEP * side)
    values = [
        _observed(unknown, [_touch(u, v, side, side, f) for u, v in places])
        + (f - 1) / (middle - 1) * moved
        for f in nodes
    ]
    return {
        "x": x,
        "y": y,
        "strength_nodes": nodes,
        "values": on_nodes(np.stack(values, axis=1)),
        "skin": on_nodes(np.concatenate([skin, by_size], axis=-1)),
        "sides": np.array([parts.skin.length, parts.skin.width]),
        **({} if parts.skin.rectangular else {"on_skin": _on_cells(parts.skin)}),
    }


def _on_cells(skin: Skin) -> Mask:
    """True where the middle of a uniform cell is on the skin, shape (y, x)."""
    x, y = ((np.arange(MASK_CELLS) + 0.5) / MASK_CELLS * side for side in skin.sides)
    return covers(skin, np.stack(np.meshgrid(x, y)))


def touch_size(plan: Plan) -> tuple[float, float]:
    """Mean and deviation of the side of squares with the areas of the data set's touches, m."""
    drawn = plan.draws.press
    sizes = drawn.size.at(QUANTILES)
    sides = np.concatenate([sizes * (SQUARE if s == "disc" else 1.0) for s in drawn.shape])
    return float(sides.mean()), float(sides.std())


def _nodes(side: float, length: float) -> Real:
    """Positions of the nodes, closer together towards the edges."""
    turns = np.cos(np.pi * np.arange(NODES) / (NODES - 1))
    return length / 2 - (length - side) / 2 * turns


def _strength_nodes(strengths: Real) -> Real:
    low, high = strengths[0], strengths[-1]
    beyond = 0.1 * max(high - low, low - 1)
    return np.linspace(low - beyond, high + beyond, STRENGTH_NODES)


def _touch(x: float, y: float, width: float, height: float, factor: float) -> Press:
    return Press((Rectangle(x, y, width, height, factor),))


def _observed(unknown: UnknownSkin, presses: Sequence[Press]) -> Real:
    """Observed changes of uniform skins from the baseline, shape (press, number)."""
    touched = PressBatch.of([NOTHING, *map(unknown.forward.cells, presses)])
    observed = unknown.observed(unknown.forward.solve(touched, unknown.values))
    return observed[1:] - observed[0]
