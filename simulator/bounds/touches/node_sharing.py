"""Distribution of values at the nodes of a lattice to the cells around each."""

from __future__ import annotations

import numpy as np

from ...arrays import Real
from ...models.mechanics.skin_lattice import Lattice, Window


def distributed_to_cells(lattice: Lattice, values: Real, here: Window) -> Real:
    """Cell values in a window that weight linear functions as the nodes do.

    A function that is linear between the middles of cells has the same weighted sum with the cell
    values as with the node values. A node next to a cell without skin contributes to its own cell
    only, as in `Lattice.in_cells`.
    """
    (along, across), (rows, columns) = lattice.within, here
    by_x = _weights(columns.stop - columns.start, along)
    by_y = _weights(rows.stop - rows.start, across)
    part = lattice.part[lattice.nodes(here)]
    skin = lattice.in_cells(np.ones_like(part), here)
    amid = np.isclose(by_y @ skin @ by_x.T, 1.0)
    area = _own(len(skin), across).T @ part @ _own(skin.shape[1], along)
    total = by_y.T @ (part * np.where(amid, values, 0.0)) @ by_x
    shared = np.divide(total, area, out=np.zeros_like(total), where=area > 0)
    return shared + lattice.in_cells(np.where(amid, 0.0, values), here)


def _own(cells: int, within: int) -> Real:
    """Cell of each node as a 0/1 matrix, shape (node, cell)."""
    return np.repeat(np.eye(cells), within, axis=0)


def _weights(cells: int, within: int) -> Real:
    """Weights of linear interpolation from the cells' middles to each node, shape (node, cell).

    They extrapolate beyond the first and the last middle.
    """
    if cells == 1:
        return np.ones((within, 1))
    at = (np.arange(cells * within) + 0.5) / within - 0.5
    first = np.clip(np.floor(at).astype(np.int64), 0, cells - 2)
    found = np.zeros((len(at), cells))
    node = np.arange(len(at))
    found[node, first], found[node, first + 1] = first + 1 - at, at - first
    return found
