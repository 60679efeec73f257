"""Touches rasterized on the cells of a grid, compiled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled


@compiled()
def touched(
    touches: NDArray,
    boxes: NDArray,
    radius: NDArray,
    factor: NDArray,
    x: NDArray,
    y: NDArray,
) -> tuple[NDArray, NDArray, NDArray]:  # pragma: no cover
    """Compiled form of `rasterized.rasterized`.

    boxes: left, right, bottom and top in m, shape (press, touch, 4). radius: of discs in m, 0 of
    rectangles. x, y: the grid's lines in m, ascending.
    """
    rows, columns = len(y) - 1, len(x) - 1
    starts = np.zeros(len(touches) + 1, np.int64)
    spans = np.empty((*radius.shape, 4), np.int64)
    most = 0
    for press in range(len(touches)):
        for touch in range(touches[press]):
            span, box = spans[press, touch], boxes[press, touch]
            span[0] = max(np.searchsorted(x, box[0], "right") - 1, 0)
            span[1] = min(np.searchsorted(x, box[1], "left"), columns)
            span[2] = max(np.searchsorted(y, box[2], "right") - 1, 0)
            span[3] = min(np.searchsorted(y, box[3], "left"), rows)
            most += (span[1] - span[0]) * (span[3] - span[2])
    cells, rises = np.empty(most, np.int64), np.empty(most)
    total, found = np.ones((rows, columns)), 0
    for press in range(len(touches)):
        left, right, bottom, top = columns, 0, rows, 0
        for touch in range(touches[press]):
            span = spans[press, touch]
            left, right = min(left, span[0]), max(right, span[1])
            bottom, top = min(bottom, span[2]), max(top, span[3])
            for i in range(span[2], span[3]):
                for j in range(span[0], span[1]):
                    sides = x[j], x[j + 1], y[i], y[i + 1]
                    part = covered_fraction(boxes[press, touch], radius[press, touch], sides)
                    total[i, j] *= (1 - part) + factor[press, touch] * part
        for i in range(bottom, top):
            for j in range(left, right):
                if total[i, j] != 1.0:
                    cells[found], rises[found] = i * columns + j, total[i, j] - 1
                    total[i, j] = 1.0
                    found += 1
        starts[press + 1] = found
    return cells[:found], rises[:found], starts


@compiled()
def covered_fraction(
    box: NDArray | tuple[float, float, float, float],
    radius: float,
    sides: tuple[float, float, float, float],
) -> float:  # pragma: no cover
    """Fraction of a cell within a touch. sides: left, right, bottom, top of the cell, m."""
    left, right, bottom, top = sides
    if radius == 0.0:
        wide = (min(right, box[1]) - max(left, box[0])) / (right - left)
        high = (min(top, box[3]) - max(bottom, box[2])) / (top - bottom)
        return max(wide, 0.0) * max(high, 0.0)
    x, y = (box[0] + box[1]) / 2, (box[2] + box[3]) / 2
    u0, u1, v0, v1 = (
        (left - x) / radius,
        (right - x) / radius,
        (bottom - y) / radius,
        (top - y) / radius,
    )
    near_u, near_v = max(u0, -u1, 0.0), max(v0, -v1, 0.0)
    if near_u * near_u + near_v * near_v >= 1.0:
        return 0.0
    far_u, far_v = max(-u0, u1), max(-v0, v1)
    if far_u * far_u + far_v * far_v <= 1.0:
        return 1.0
    area = (_below(u1, v1) - _below(u0, v1)) - (_below(u1, v0) - _below(u0, v0))
    return min(max(area / ((u1 - u0) * (v1 - v0)), 0.0), 1.0)


@compiled()
def _below(u: float, v: float) -> float:  # pragma: no cover
    """Area of the unit disc where its coordinates are <= u and <= v, see `disc_fraction`."""
    u, v = min(max(u, -1.0), 1.0), min(max(v, -1.0), 1.0)
    w = np.sqrt(1 - v * v)
    beside = _under_arc(min(u, -w)) + _under_arc(max(u, w)) - _under_arc(w)
    return _under_arc(u) + np.sign(v) * beside + v * (min(max(u, -w), w) + w)


@compiled()
def _under_arc(u: float) -> float:  # pragma: no cover
    """Integral of sqrt(1 - t²) over t from -1 to u."""
    return (u * np.sqrt(1 - u * u) + np.arcsin(u)) / 2 + np.pi / 4
