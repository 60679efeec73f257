"""Search of the best value of one number within bounds."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

POINTS, GOLDEN_STEPS = 7, 6
"""Grid points of a number within its bounds, and golden-section steps around the best of them."""
DIGITS = 2
"""Significant digits of sheet resistance and thickness: materials are not made more precisely."""
GOLDEN = (math.sqrt(5) - 1) / 2

Bounds = tuple[float, float]
"""Lowest and highest value."""


def best_value(score: Callable[[float], float], bounds: Bounds, own: float) -> float:
    """The number within bounds of the highest score, to DIGITS.

    Evaluates a logarithmic grid, then does golden-section steps around its best point. own: another
    point of the grid, where it is within the bounds.
    """
    low, high = bounds
    grid = {float(each) for each in np.geomspace(low, high, POINTS)}
    points = sorted(
        rounded_within(each, bounds) for each in grid | ({own} if low <= own <= high else set())
    )
    shares = {each: score(each) for each in points}
    best = max(points, key=lambda each: shares[each])
    place = points.index(best)
    left, right = (
        math.log(points[max(place - 1, 0)]),
        math.log(points[min(place + 1, len(points) - 1)]),
    )
    for _ in range(GOLDEN_STEPS):
        first, second = (
            rounded_within(math.exp(right - GOLDEN * (right - left)), bounds),
            rounded_within(math.exp(left + GOLDEN * (right - left)), bounds),
        )
        for each in (first, second):
            shares[each] = shares[each] if each in shares else score(each)
        if shares[first] >= shares[second]:
            right = math.log(second)
        else:
            left = math.log(first)
    return max(sorted(shares), key=lambda each: shares[each])


def rounded_within(value: float, bounds: Bounds) -> float:
    """A value rounded to DIGITS and clipped to bounds."""
    return min(max(float(f"{value:.{DIGITS}g}"), bounds[0]), bounds[1])
