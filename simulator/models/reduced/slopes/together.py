"""`sensitivity` of many presses of one skin at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..skin import ReducedSkin
from .alone import Sensitivity
from .potentials import Solved, solved_together


def sensitivities(
    skin: ReducedSkin,
    cells: NDArray[np.int64],
    rises: NDArray[np.float64],
    s: NDArray[np.complex128],
) -> Sensitivity:
    """Of presses that touch as many cells each, shape (press, touch), on sheets that stay.

    Shapes as of `Sensitivity` with an axis (press,) first; by_cell of the touched ones alone,
    shape (press, interface, s, touch).
    """
    weights = rises * skin.rest_factors[cells]
    terms = skin.turn.T @ skin.reduced.stiffness @ skin.turn
    found = [
        _of_drive(skin, cells, weights, terms, s, solved)
        for solved in solved_together(skin.drives, skin.rest, cells, weights, s)
    ]
    return Sensitivity(*(np.stack(each, axis=1) for each in zip(*found, strict=True)))


def _of_drive(
    skin: ReducedSkin,
    cells: NDArray[np.int64],
    weights: NDArray[np.float64],
    terms: NDArray[np.float64],
    s: NDArray[np.complex128],
    solved: Solved,
) -> tuple[NDArray[np.complex128], ...]:
    (u, Y), (rows, diagonal, factors) = solved, skin.rest
    U, V = u[:, :, : len(rows)], u[:, :, len(rows) :]
    own = factors[cells].reshape(len(cells), -1, factors.shape[2]).transpose(0, 2, 1)
    squares = _summed((u @ own) ** 2, factors.shape[1])
    whole = (U * (u @ rows.T)).sum(axis=2) + (U * (V @ rows[:, len(rows) :].T)).sum(axis=2)
    whole += V**2 @ diagonal + (squares * weights[:, None]).sum(axis=2)
    by_weight = np.stack([((u @ term) * u).sum(axis=2) for term in terms], axis=2)
    return Y, s[:, None] * squares, by_weight, whole


def _summed(squares: NDArray[np.complex128], rank: int) -> NDArray[np.complex128]:
    """Over the rows of each cell's factor, shape (press, s, cell)."""
    return squares.reshape(*squares.shape[:2], -1, rank).sum(axis=3)
