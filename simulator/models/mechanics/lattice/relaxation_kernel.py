"""Compiled relaxation of the membrane on a lattice under applicators."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ....compiled import compiled

MIN_ARM = 1e-3
"""Smallest distance of a node from an applicator's edge, over a step."""


@compiled()
def relaxed_in_place(
    w: NDArray,
    least: NDArray,
    right: NDArray,
    up: NDArray,
    load: NDArray,
    law: NDArray,
    per_metre: float,
    relaxed: float,
    still: float,
    most: int,
) -> int:  # pragma: no cover
    """Relax deflections w to the minimum of energy that is nowhere below `least`.

    Successive over-relaxation by the factor `relaxed`, with one Newton step at each node and
    projection, until a sweep moves no node by more than `still`. Returns the number of sweeps, or
    `most` + 1 if `most` sweeps do not suffice. w,
    least, still: m. right, up: conductance of each node to the next along x and along y, over the
    tension; 0 at the last. load: area of a node over the tension, m² / (N/m). law: the foam's
    stress in Pa at equidistant strains from 0. per_metre: number of those strains for each m of
    deflection.
    """
    rows, columns = w.shape
    last, total = len(law) - 2, _conductance_sums(right, up)
    for sweep in range(most):
        moved = 0.0
        for i in range(rows):
            left = 0.0
            for j in range(columns):
                own = w[i, j]
                if load[i, j] == 0.0:
                    left = own
                    continue
                at = own * per_metre
                step = min(int(at), last)
                slope = law[step + 1] - law[step]
                pull = -load[i, j] * (law[step] + (at - step) * slope)
                if j + 1 < columns:
                    pull += right[i, j] * (w[i, j + 1] - own)
                if i > 0:
                    pull += up[i - 1, j] * (w[i - 1, j] - own)
                if i + 1 < rows:
                    pull += up[i, j] * (w[i + 1, j] - own)
                gain = relaxed / (total[i, j] + load[i, j] * slope * per_metre)
                if j > 0:  # last: this neighbour has just moved, all others are known earlier
                    pull += right[i, j - 1] * (left - own)
                left = max(own + gain * pull, least[i, j])
                moved = max(moved, abs(left - own))
                w[i, j] = left
        if moved <= still:
            return sweep + 1
    return most + 1


@compiled()
def _conductance_sums(right: NDArray, up: NDArray) -> NDArray:  # pragma: no cover
    """Sum of the conductances of each node to its neighbours, over the tension."""
    rows, columns = right.shape
    total = np.empty((rows, columns))
    for i in range(rows):
        for j in range(columns):
            total[i, j] = right[i, j] + up[i, j]
            if j > 0:
                total[i, j] += right[i, j - 1]
            if i > 0:
                total[i, j] += up[i - 1, j]
    return total


@compiled()
def rasterized(
    boxes: NDArray,
    radius: NDArray,
    depth: NDArray,
    x: NDArray,
    y: NDArray,
    right: NDArray,
    up: NDArray,
    load: NDArray,
) -> NDArray:  # pragma: no cover
    """Smallest deflection of each node by applicators, m, shape (row, column).

    Where an edge of one lies between two nodes, `right`, `up` and `load` of the shallower node
    become those of an arm that ends there. boxes: left, right, bottom and top in m, shape (touch,
    4). radius: of discs in m, 0 of rectangles. depth: m. x, y: of nodes, m.
    """
    rows, columns = len(y), len(x)
    least, by = np.zeros((rows, columns)), np.full((rows, columns), -1)
    for touch in range(len(depth)):
        for i in range(rows):
            low, high = _across(boxes[touch, :2], boxes[touch, 2:], radius[touch], y[i])
            for j in range(columns):
                if low <= x[j] <= high and depth[touch] > least[i, j]:
                    least[i, j], by[i, j] = depth[touch], touch
    wide, high = np.ones((rows, columns)), np.ones((rows, columns))
    _shorten(least, by, boxes[:, :2], boxes[:, 2:], radius, x, y, right, wide)
    _shorten(least.T, by.T, boxes[:, 2:], boxes[:, :2], radius, y, x, up.T, high.T)
    for i in range(rows):
        for j in range(columns):
            load[i, j] *= wide[i, j] * high[i, j]
    return least


@compiled()
def _shorten(
    least: NDArray,
    by: NDArray,
    own: NDArray,
    other: NDArray,
    radius: NDArray,
    x: NDArray,
    y: NDArray,
    right: NDArray,
    wide: NDArray,
) -> None:  # pragma: no cover
    """Shorten arms along one axis, x, that end at an edge: conductance grows, nodes become
    narrower.

    by: number of the applicator above each node. own, other: sides of each along x and across it.
    wide: width of nodes, over a step.
    """
    rows, columns = least.shape
    for i in range(rows):
        for j in range(columns - 1):
            if least[i, j] == least[i, j + 1]:
                continue
            ahead = least[i, j + 1] > least[i, j]
            touch = int(by[i, j + 1] if ahead else by[i, j])
            low, high = _across(own[touch], other[touch], radius[touch], y[i])
            gap = low - x[j] if ahead else x[j + 1] - high
            part = min(max(gap / (x[j + 1] - x[j]), MIN_ARM), 1.0)
            right[i, j] /= part
            wide[i, j if ahead else j + 1] -= (1 - part) / 2


@compiled()
def _across(
    own: NDArray, other: NDArray, radius: float, at: float
) -> tuple[float, float]:  # pragma: no cover
    """Start and end of an applicator on a line, m; inf and -inf if they do not meet.

    own: its sides along that line. other: those across. at: position of the line, between the
    latter.
    """
    if not other[0] <= at <= other[1]:
        return np.inf, -np.inf
    if radius == 0.0:
        return own[0], own[1]
    middle, off = (own[0] + own[1]) / 2, at - (other[0] + other[1]) / 2
    half = np.sqrt(max(radius * radius - off * off, 0.0))
    return middle - half, middle + half
