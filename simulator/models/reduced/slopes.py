"""How the admittance of a reduced skin changes with its parameters, without any further solve.

K + s M is symmetric, so the problem is its own adjoint: dY = u'(dK + s dM) u with the potentials u
of 1 V, transposed and not conjugated; floating terminals carry no net current and add nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .dense import Solved, solved
from .skin import ReducedSkin


@dataclass(frozen=True)
class Sensitivity:
    """Y of each interface and its exact derivatives.

    Y: S, shape (interface, s). by_cell: S, to c of each pixel over the scene's own at rest, shape
    (interface, s, pixel). by_weight: S, to the weight of each term of K (see `family.weights_of`)
    and of terms beside them, shape (interface, s, term). by_s: F, to s, shape (interface, s).
    """

    Y: NDArray[np.complex128]
    by_cell: NDArray[np.complex128]
    by_weight: NDArray[np.complex128]
    by_s: NDArray[np.complex128]


def sensitivity(
    skin: ReducedSkin,
    cells: NDArray[np.int64],
    rises: NDArray[np.float64],
    s: NDArray[np.complex128],
    beside: NDArray[np.float64] | None = None,
) -> Sensitivity:
    """Of one press on one skin; cells, rises: as of `ReducedSkin.sweeps`. s: rad/s.

    beside: further terms of K, in the model's coordinates, S, shape (term, N + n, N + n).
    """
    own = skin.reduced.stiffness
    stiffness = own if beside is None else np.concatenate([own, beside])
    found = [
        _alone(skin.charges(cells, rises, u), stiffness, u, s, Y)
        for u, Y in skin.solved(cells, rises, s)
    ]
    return Sensitivity(*(np.stack(each) for each in zip(*found, strict=True)))


def _alone(
    charges: tuple[NDArray[np.complex128], NDArray[np.complex128]],
    stiffness: NDArray[np.float64],
    u: NDArray[np.complex128],
    s: NDArray[np.complex128],
    Y: NDArray[np.complex128],
) -> tuple[NDArray[np.complex128], ...]:
    by_cell, whole = charges
    by_weight = np.stack([((term @ u) * u).sum(axis=0) for term in stiffness], axis=1)
    return Y, s[:, None] * by_cell, by_weight, whole


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
        _of_many(skin, cells, weights, terms, s, potentials)
        for potentials in solved(skin.drives, skin.rest, cells, weights, s)
    ]
    return Sensitivity(*(np.stack(each, axis=1) for each in zip(*found, strict=True)))


def _of_many(
    skin: ReducedSkin,
    cells: NDArray[np.int64],
    weights: NDArray[np.float64],
    terms: NDArray[np.float64],
    s: NDArray[np.complex128],
    potentials: Solved,
) -> tuple[NDArray[np.complex128], ...]:
    (u, Y), (rows, diagonal, factors) = potentials, skin.rest
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
