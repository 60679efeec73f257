"""Moves points to where the triangles around them are better shaped."""

from __future__ import annotations

import numpy as np

from ...arrays import Integer, Real
from ...scene.planar import Points
from .triangulation import triangulated

ROUNDS = 8
STEP = 0.5
"""Fraction of the way to the mean of places where triangles are equilateral."""
FLAT = 1e-3
"""Shape below which the weight of a triangle grows no further."""
SAME = 1e-9


def smoothed(
    points: Points, t: Integer, lines: Integer, curve: Integer, fixed: int
) -> tuple[Points, Integer]:
    """Points after moving, and the triangles between them.

    The number of points stays, and the first `fixed` do not move. points, lines, curve and the
    result are as for `triangulated`.
    """
    for _ in range(ROUNDS):
        points = _moved(points, t, fixed)
        t = triangulated(points, lines, curve)
    return points, t


def _moved(points: Points, t: Integer, fixed: int) -> Points:
    """Moves points where no triangle around them becomes worse than the worst was."""
    free = np.isin(np.arange(len(points)), t)
    free[:fixed] = False
    before = _worst(points, t)
    there = np.where(free[:, None], points + STEP * (_better(points, t) - points), points)
    while True:
        moved = np.where(free[:, None], there, points)
        worse = free & (_worst(moved, t) < before - SAME)
        if not worse.any():
            return moved
        free &= ~worse


def _better(points: Points, t: Integer) -> Points:
    """Mean of the apexes of equilateral triangles over the edges opposite each point.

    Badly shaped triangles weigh more; points without triangles stay.
    """
    weight = 1 / np.maximum(_shape(points, t), FLAT) ** 2
    towards, total = np.zeros_like(points), np.zeros(len(points))
    for corner in range(3):
        start, stop = points[np.roll(t, -corner, axis=0)[1:]]
        side = stop - start
        apex = (start + stop) / 2 + np.sqrt(3) / 2 * np.stack([-side[:, 1], side[:, 0]], axis=1)
        np.add.at(towards, t[corner], weight[:, None] * apex)
        np.add.at(total, t[corner], weight)
    none = total == 0
    return np.where(none[:, None], points, towards / (total + none)[:, None])


def _worst(points: Points, t: Integer) -> Real:
    """Smallest shape of the triangles around each point, shape (point,)."""
    shape, least = _shape(points, t), np.full(len(points), np.inf)
    for corner in t:
        np.minimum.at(least, corner, shape)
    return least


def _shape(points: Points, t: Integer) -> Real:
    """Shape of triangles: 1 if equilateral, 0 if flat, negative if clockwise.

    Shape (triangle,).
    """
    a, b, c = points[t]
    u, v, w = b - a, c - a, c - b
    squared = (u**2).sum(axis=1) + (v**2).sum(axis=1) + (w**2).sum(axis=1)
    return 2 * np.sqrt(3) * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / squared
