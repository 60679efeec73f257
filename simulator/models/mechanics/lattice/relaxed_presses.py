"""Rises of c in the cells of a grid by applicators of any place and depth."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ....arrays import Real
from ....press.batch import TouchedCells
from ....sweeps.errors import ToleranceError
from .relaxation_kernel import rasterized, relaxed_in_place
from .skin_lattice import Lattice

STILL = 1e-5
"""Largest movement of a node in the last sweep, over the depth."""
MAX_RELAXATION_SWEEPS = 2000
FAINT = 1e-4
"""Rises of c below this are left out."""
SLOWEST = 2.0
"""Length of the slowest error mode next to applicators, over the length in which a deflection falls
to a tenth. Different foams and skins converged fastest from 1.5 to 2."""

Window = tuple[slice, slice]
"""Rows and columns of cells."""


class LatticeApplicators(NamedTuple):
    """Applicators of one press.

    boxes: left, right, bottom and top in m, shape (touch, 4). radius: of discs in m, 0 of
    rectangles. depth: m.
    """

    boxes: Real
    radius: Real
    depth: Real


def raised(lattice: Lattice, applied: LatticeApplicators) -> TouchedCells:
    """Cells that a press changes, and the rise of c averaged over the skin in each.

    Applicators that do not influence each other are relaxed one by one.
    """
    rise = np.zeros(lattice.grid)
    for own in _groups(lattice, applied):
        here = window(lattice, own)
        rise[here] += rises_within(lattice, own, here)
    cells = np.flatnonzero(rise > FAINT)
    return TouchedCells(cells, rise.ravel()[cells])


def rises_within(lattice: Lattice, applied: LatticeApplicators, here: Window) -> Real:
    """Rise of c averaged over the skin in each cell of a window, shape (row, column)."""
    return in_cells(lattice, rises_at_nodes(lattice, applied, here), here)


def rises_at_nodes(
    lattice: Lattice, applied: LatticeApplicators, here: Window, still: float = STILL
) -> Real:
    """Rise of c at the nodes of a window, shape (row, column). still: see STILL."""
    w = deflected(lattice, applied, here, still)
    return lattice.mechanics.factor(w / lattice.thickness) - 1


def deflected(
    lattice: Lattice, applied: LatticeApplicators, here: Window, still: float = STILL
) -> Real:
    """Deflection at the nodes of a window, m, shape (row, column). still: see STILL.

    Raises ToleranceError if the relaxation does not converge.
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
    swept = relaxed_in_place(
        w, least, right, up, load, *law, relaxed, still * deepest, MAX_RELAXATION_SWEEPS
    )
    if swept > MAX_RELAXATION_SWEEPS:
        raise ToleranceError(
            f"a press by {deepest:g} m: the relaxation of the foam next to it does not converge"
        )
    return w


def _first(lattice: Lattice, applied: LatticeApplicators, x: Real, y: Real) -> Real:
    """Deflection as if each applicator's edge were straight, m, shape (row, column)."""
    found = np.zeros((len(y), len(x)))
    for (left, right, bottom, top), radius, depth in zip(*applied, strict=True):
        if radius:
            away = np.hypot(x - (left + right) / 2, (y - (bottom + top) / 2)[:, None]) - radius
        else:
            along = np.maximum(left - x, x - right).clip(0.0)
            away = np.hypot(along, np.maximum(bottom - y, y - top).clip(0.0)[:, None])
        found = np.maximum(found, lattice.edge_profile(depth, away.clip(0.0)))
    return found


def in_cells(lattice: Lattice, rise: Real, here: Window) -> Real:
    """Mean of nodal values over the skin in each cell of a window, shape (row, column)."""
    part = lattice.part[lattice.nodes(here)]
    area, total = _summed(lattice, part), _summed(lattice, part * rise)
    return np.divide(total, area, out=np.zeros_like(total), where=area > 0)


def _summed(lattice: Lattice, values: Real) -> Real:
    """Sum over the nodes of each cell."""
    (along, across), (rows, columns) = lattice.within, values.shape
    return values.reshape(rows // across, across, columns // along, along).sum(axis=(1, 3))


def _groups(lattice: Lattice, applied: LatticeApplicators) -> list[LatticeApplicators]:
    """Applicators in groups that influence each other."""
    if len(applied.depth) > 1 and independent(lattice, applied):
        return [
            LatticeApplicators(*(each[[k]] for each in applied)) for k in range(len(applied.depth))
        ]
    return [applied] if len(applied.depth) else []


def independent(lattice: Lattice, applied: LatticeApplicators, reach: float | None = None) -> bool:
    """True if no two of the applicators influence the same position.

    reach: distance of that influence, m; by default that of each applicator's depth.
    """
    far = [lattice.reach(depth) if reach is None else reach for depth in applied.depth]
    low = applied.boxes[:, ::2] - np.array(far)[:, None]
    high = applied.boxes[:, 1::2] + np.array(far)[:, None]
    meet = np.all((low[:, None] < high) & (low < high[:, None]), axis=-1)
    return int(np.count_nonzero(meet)) == len(far)


def window(lattice: Lattice, applied: LatticeApplicators) -> Window:
    """Cells that any of the applicators influences."""
    far = max(lattice.reach(depth) for depth in applied.depth)
    low, high = applied.boxes[:, ::2].min(axis=0) - far, applied.boxes[:, 1::2].max(axis=0) + far
    size = np.multiply(lattice.steps, lattice.within)
    first = np.floor(low / size).astype(int).clip(0)
    last = np.minimum(np.ceil(high / size).astype(int), lattice.grid[::-1])
    return slice(first[1], last[1]), slice(first[0], last[0])
