"""`dense.solved` of many presses of one skin, in a few products of stacked matrices."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ....fem.driven import Driven
from ..dense import MANY
from ..kernel import Rest

Solved = tuple[NDArray[np.complex128], NDArray[np.complex128]]


def solved_together(
    drives: Sequence[Driven],
    rest: Rest,
    cells: NDArray[np.int64],
    weights: NDArray[np.float64],
    s: NDArray[np.complex128],
) -> list[Solved]:
    """Potentials of each drive at 1 V, shape (press, s, N + n), and Y in S, shape (press, s).

    cells: as many for each press, shape (press, touch). weights: rises of their M. s: rad/s.
    """
    U = rest.factors[cells].reshape(len(cells), -1, rest.factors.shape[2])
    C = np.repeat(weights, rest.factors.shape[1], axis=1)
    N = len(rest.rows)
    rows = rest.rows + (U[:, :, :N] * C[:, :, None]).transpose(0, 2, 1) @ U
    if MANY * U.shape[1] <= len(rest.diagonal):
        P = (1 / (1 + s[:, None] * rest.diagonal))[None]
        seen = _seen(rest, cells, P[0])
        return [_by_touches(driven, rows, P, U[:, :, N:], C, seen, s) for driven in drives]
    M = (U[:, :, N:] * C[:, :, None]).transpose(0, 2, 1) @ U[:, :, N:]
    M[:, range(M.shape[1]), range(M.shape[1])] += rest.diagonal
    diagonal, axes = np.linalg.eigh(M)
    P = 1 / (1 + s[:, None] * diagonal[:, None])
    turned = np.concatenate([rows[:, :, :N], rows[:, :, N:] @ axes], axis=2)
    nothing = U[:, :0, N:], C[:, :0], np.zeros((len(cells), len(s), 0, 0))
    found = [_by_touches(driven, turned, P, *nothing, s) for driven in drives]
    back = axes.transpose(0, 2, 1)
    return [(np.concatenate([u[:, :, :N], u[:, :, N:] @ back], axis=2), Y) for u, Y in found]


def _seen(
    rest: Rest, cells: NDArray[np.int64], P: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    """U P U' of each press, once for all that touch the same cells; P: shape (s, n).

    Shape (press, s, rank, rank).
    """
    own, same = np.unique(cells, axis=0, return_inverse=True)
    U = rest.factors[own].reshape(len(own), -1, rest.factors.shape[2])[:, :, len(rest.rows) :]
    return ((U[:, None] * P[None, :, None]) @ U.transpose(0, 2, 1)[:, None])[same.ravel()]


def _by_touches(
    driven: Driven,
    rows: NDArray[np.float64],
    P: NDArray[np.complex128],
    U: NDArray[np.float64],
    C: NDArray[np.float64],
    seen: NDArray[np.complex128],
    s: NDArray[np.complex128],
) -> Solved:
    """As `dense._by_touches`. rows: of M at terminals, shape (press, N, N + n). P: 1 / (1 + s M)
    where M is diagonal, (press or 1, s, n). U, C: what cells see there, (press, rank, n), and their
    weights, (press, rank). seen: U P U', (press, s, rank, rank)."""
    N, F = len(driven.potential), driven.floating
    floats = F.shape[1]
    charge = driven.potential @ rows
    beside = np.concatenate([F.T @ rows[:, :, N:], U], axis=1)
    weighed = np.concatenate([np.ones((len(C), floats)), C], axis=1)
    sign = np.repeat(np.stack([-(s**2), s], axis=1), [floats, C.shape[1]], axis=1)
    whole = np.empty((*seen.shape[:2], beside.shape[1], beside.shape[1]), dtype=complex)
    whole[:, :, floats:, floats:] = seen
    across = (beside[:, None, :floats] * P[:, :, None]) @ beside.transpose(0, 2, 1)[:, None]
    whole[:, :, :floats], whole[:, :, :, :floats] = across, across.transpose(0, 1, 3, 2)
    system = sign[:, :, None] * whole * weighed[:, None, None, :]
    system[:, :, :floats, :floats] += driven.floating_conductance
    system[:, :, :floats, :floats] += s[:, None, None] * (F.T @ rows[:, :, :N] @ F)[:, None]
    system[:, :, range(floats, system.shape[2]), range(floats, system.shape[2])] += 1.0
    right = -sign * ((P * charge[:, None, N:]) @ beside.transpose(0, 2, 1))
    right[:, :, :floats] -= s[:, None] * (charge[:, :N] @ F)[:, None]
    found = np.linalg.solve(system, right[..., None])[..., 0]
    v = -s[:, None] * P * (charge[:, None, N:] + (found * weighed[:, None]) @ beside)
    at_terminals = driven.potential + found[:, :, :floats] @ F.T
    u = np.concatenate([at_terminals, v], axis=2)
    return u, driven.conductance + s * (u @ charge[:, :, None])[:, :, 0]
