"""Random presses."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from ..scene.parts import Skin
from .press import Press
from .touch import Rectangle

SMALLEST, LARGEST, FACTORS = 0.03, 0.5, (1.3, 3.0)


def random_presses(skin: Skin, rng: np.random.Generator, count: int) -> list[Press]:
    """One rectangle or two separate ones, of 3 to 50 % of the sides, anywhere, factors from 1.3 to
    3."""
    return [_random_press(skin, rng, 1 + number % 2) for number in range(count)]


def _random_press(skin: Skin, rng: np.random.Generator, touches: int) -> Press:
    while True:
        drawn = tuple(_random_rectangle(skin, rng) for _ in range(touches))
        if not any(_overlap(one, other) for one, other in combinations(drawn, 2)):
            return Press(drawn)


def _random_rectangle(skin: Skin, rng: np.random.Generator) -> Rectangle:
    sides = np.array([skin.length, skin.width])
    size = rng.uniform(SMALLEST, LARGEST, 2) * sides
    place = size / 2 + rng.uniform(size=2) * (sides - size)
    (x, y), (width, height) = place.tolist(), size.tolist()
    return Rectangle(x, y, width, height, rng.uniform(*FACTORS))


def _overlap(one: Rectangle, other: Rectangle) -> bool:
    a, b = one.box, other.box
    return max(a.left, b.left) < min(a.right, b.right) and max(a.bottom, b.bottom) < min(
        a.top, b.top
    )
