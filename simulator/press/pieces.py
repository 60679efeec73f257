"""A press as a sum of rectangles, and presses drawn at random."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..scene.scene import Scene
from .capacitance import touched_box
from .press import Press
from .touch import AnyTouch, Box, Rectangle

SMALLEST, LARGEST, FACTORS = 0.03, 0.5, (1.3, 3.0)


class Pieces(NamedTuple):
    """Rectangles of many presses: those of press k from starts[k] to starts[k + 1].

    boxes: left, right, bottom, top in m, shape (rectangle, 4). rises: what each adds to c over that
    at rest, shape (rectangle,).
    """

    boxes: NDArray[np.float64]
    rises: NDArray[np.float64]
    starts: NDArray[np.int64]


def pieces(scene: Scene, presses: Iterable[Press]) -> Pieces:
    """The rectangles that presses are sums of."""
    of_presses = [rectangles(scene, press) for press in presses]
    every = [piece for of_press in of_presses for piece in of_press]
    return Pieces(
        np.array([box for box, _ in every], dtype=np.float64).reshape(-1, 4),
        np.array([rise for _, rise in every], dtype=np.float64),
        np.cumsum([0, *map(len, of_presses)]),
    )


def rectangles(scene: Scene, press: Press, power: int = 1) -> list[tuple[Box, float]]:
    """A press as a sum: rectangles, and what each adds to (c over that at rest) ** power.

    Where touches overlap, their common part adds what the product of factors has beyond the sum.
    """
    total: list[tuple[Box, float]] = []
    for touch in press.touches:
        own, adds = _box(scene, touch), touch.factor**power - 1
        common = [(_common(box, own), rise * adds) for box, rise in total]
        total.append((own, adds))
        total += [
            (box, rise) for box, rise in common if box.left < box.right and box.bottom < box.top
        ]
    return total


def random_presses(scene: Scene, rng: np.random.Generator, count: int) -> list[Press]:
    """One rectangle or two apart, of 3 to 50 % of the sides, anywhere, factors from 1.3 to 3."""
    return [_random_press(scene, rng, 1 + number % 2) for number in range(count)]


def _random_press(scene: Scene, rng: np.random.Generator, touches: int) -> Press:
    while True:
        press = Press(tuple(_random_rectangle(scene, rng) for _ in range(touches)))
        if len(rectangles(scene, press)) == touches:
            return press


def _random_rectangle(scene: Scene, rng: np.random.Generator) -> Rectangle:
    sides = np.array([scene.skin.length, scene.skin.width])
    size = rng.uniform(SMALLEST, LARGEST, 2) * sides
    place = size / 2 + rng.uniform(size=2) * (sides - size)
    (x, y), (width, height) = place.tolist(), size.tolist()
    return Rectangle(x, y, width, height, rng.uniform(*FACTORS))


def _box(scene: Scene, touch: AnyTouch) -> Box:
    """What a touch covers; raises InputError as `touched_box`."""
    return touch.box if isinstance(touch, Rectangle) else touched_box(scene, touch)


def _common(one: Box, other: Box) -> Box:
    """What both cover; empty where a side does not lie beyond the opposite one."""
    return Box(
        max(one.left, other.left),
        min(one.right, other.right),
        max(one.bottom, other.bottom),
        min(one.top, other.top),
    )
