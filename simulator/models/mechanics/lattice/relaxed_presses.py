"""How applicators of any place and depth raise c in the cells of a grid."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....press.batch import TouchedCells
from ....sweeps.errors import ToleranceError
from .relaxation_kernel import rasterized, relaxed_in_place
from .skin_lattice import Lattice

STILL = 1e-5
"""Of the depth: what the last sweep may move a node by."""
MOST_SWEEPS = 2000
FAINT = 1e-4
"""Rises of c that are left out."""
SLOWEST = 2.0
"""Length of the slowest wave beside applicators, over that in which a deflection falls to a tenth:
on foams and skins not alike presses came to rest soonest from 1.5 to 2."""

Window = tuple[slice, slice]
"""Rows and columns of cells."""


class Applicators(NamedTuple):
    """Applicators of one press.

    boxes: left, right, bottom and top in m, shape (touch, 4). radius: of discs in m, 0 of
    rectangles. depth: m.
    """

    boxes: NDArray[np.float64]
    radius: NDArray[np.float64]
    depth: NDArray[np.float64]


def raised(lattice: Lattice, applied: Applicators) -> TouchedCells:
    """Cells and rises of c there by a press, in the mean of the skin in each.

    Of applicators that do not feel each other each settles for itself.
    """
    rise = np.zeros(lattice.grid)
    for own in _groups(lattice, applied):
        here = window(lattice, own)
        rise[here] += rises_within(lattice, own, here)
    cells = np.flatnonzero(rise > FAINT)
    return TouchedCells(cells, rise.ravel()[cells])


def rises_within(lattice: Lattice, applied: Applicators, here: Window) -> NDArray[np.float64]:
    """Of c in the mean of the skin in each cell of a window, shape (row, column)."""
    return in_cells(lattice, rises_at_nodes(lattice, applied, here), here)


def rises_at_nodes(
    lattice: Lattice, applied: Applicators, here: Window, still: float = STILL
) -> NDArray[np.float64]:
    """Of c at the nodes of a window, shape (row, column). still: as STILL."""
    w = deflected(lattice, applied, here, still)
    return lattice.mechanics.factor(w / lattice.thickness) - 1


def deflected(
    lattice: Lattice, applied: Applicators, here: Window, still: float = STILL
) -> NDArray[np.float64]:
    """At the nodes of a window, m, shape (row, column). still: as STILL.

    Raises ToleranceError where they do not come to rest.
    """
    rows, columns = lattice.nodes(here)
    x, y = lattice.x[columns], lattice.y[rows]
    right, up = lattice.right[rows, columns].copy(), lattice.up[rows, columns].copy()
    load = lattice.area * lattice.part[rows, columns]
    least = rasterized(*applied, x, y, right, up, load)
    w, deepest = _first(lattice, applied, x, y), float(applied.depth.max())
    slowest = min(SLOWEST * lattice.falls_within(deepest), max(np.ptp(x), np.ptp(y)))
    relaxed = 2 / (1 + np.pi * min(lattice.steps) / slowest)
    law = lattice.law, lattice.per_metre
    swept = relaxed_in_place(w, least, right, up, load, *law, relaxed, still * deepest, MOST_SWEEPS)
    if swept > MOST_SWEEPS:
        raise ToleranceError(f"a press by {deepest:g} m: the foam beside it does not come to rest")
    return w


def _first(
    lattice: Lattice, applied: Applicators, x: NDArray[np.float64], y: NDArray[np.float64]
) -> NDArray[np.float64]:
    """As if each applicator's edge were straight, m, shape (row, column)."""
    found = np.zeros((len(y), len(x)))
    for (left, right, bottom, top), radius, depth in zip(*applied, strict=True):
        if radius:
            away = np.hypot(x - (left + right) / 2, (y - (bottom + top) / 2)[:, None]) - radius
        else:
            along = np.maximum(left - x, x - right).clip(0.0)
            away = np.hypot(along, np.maximum(bottom - y, y - top).clip(0.0)[:, None])
        found = np.maximum(found, lattice.beside(depth, away.clip(0.0)))
    return found


def in_cells(lattice: Lattice, rise: NDArray[np.float64], here: Window) -> NDArray[np.float64]:
    """The mean over the skin in each cell of a window, of what nodes have, shape (row, column)."""
    part = lattice.part[lattice.nodes(here)]
    area, total = _summed(lattice, part), _summed(lattice, part * rise)
    return np.divide(total, area, out=np.zeros_like(total), where=area > 0)


def _summed(lattice: Lattice, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Over the nodes of each cell."""
    (along, across), (rows, columns) = lattice.within, values.shape
    return values.reshape(rows // across, across, columns // along, along).sum(axis=(1, 3))


def _groups(lattice: Lattice, applied: Applicators) -> list[Applicators]:
    """The applicators, those together of which one is felt where another is."""
    if len(applied.depth) > 1 and independent(lattice, applied):
        return [Applicators(*(each[[k]] for each in applied)) for k in range(len(applied.depth))]
    return [applied] if len(applied.depth) else []


def independent(lattice: Lattice, applied: Applicators) -> bool:
    """Whether no two of the applicators are felt at one place."""
    far = [lattice.reach(depth) for depth in applied.depth]
    low = applied.boxes[:, ::2] - np.array(far)[:, None]
    high = applied.boxes[:, 1::2] + np.array(far)[:, None]
    meet = np.all((low[:, None] < high) & (low < high[:, None]), axis=-1)
    return int(np.count_nonzero(meet)) == len(far)


def window(lattice: Lattice, applied: Applicators) -> Window:
    """The cells that any of the applicators is felt in."""
    far = max(lattice.reach(depth) for depth in applied.depth)
    low, high = applied.boxes[:, ::2].min(axis=0) - far, applied.boxes[:, 1::2].max(axis=0) + far
    size = np.multiply(lattice.steps, lattice.within)
    first = np.floor(low / size).astype(int).clip(0)
    last = np.minimum(np.ceil(high / size).astype(int), lattice.grid[::-1])
    return slice(first[1], last[1]), slice(first[0], last[0])
