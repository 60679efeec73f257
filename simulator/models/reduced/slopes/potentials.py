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
        seen = _seen(rest, cells, C, s[:, None] * P[0])
        return [_by_touches(driven, rows, P, U[:, :, N:], C, seen, s) for driven in drives]
    M = (U[:, :, N:] * C[:, :, None]).transpose(0, 2, 1) @ U[:, :, N:]
    M[:, range(M.shape[1]), range(M.shape[1])] += rest.diagonal
    diagonal, axes = np.linalg.eigh(M)
    P = 1 / (1 + s[:, None] * diagonal[:, None])
    turned = np.concatenate([rows[:, :, :N], rows[:, :, N:] @ axes], axis=2)
    nothing = U[:, :0, N:], C[:, :0], np.zeros((len(cells), len(s), 0, 0), dtype=complex)
    found = [_by_touches(driven, turned, P, *nothing, s) for driven in drives]
    back = axes.transpose(0, 2, 1)
    return [(np.concatenate([u[:, :, :N], u[:, :, N:] @ back], axis=2), Y) for u, Y in found]


def _seen(
    rest: Rest, cells: NDArray[np.int64], C: NDArray[np.float64], sP: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    """1 + U s P U' C of each press, the product once for all that touch the same cells.

    C: shape (press, rank). sP: shape (s, n). Shape (press, s, rank, rank).
    """
    own, same = np.unique(cells, axis=0, return_inverse=True)
    U = rest.factors[own].reshape(len(own), -1, rest.factors.shape[2])[:, :, len(rest.rows) :]
    count, rank, n = U.shape
    parts = np.stack([sP.real, sP.imag])
    rows = (parts[:, :, None] * U[:, None, None]).reshape(count, 2 * len(sP) * rank, n)
    products = (rows @ U.transpose(0, 2, 1)).reshape(count, 2, len(sP), rank, rank)
    seen = (products[:, 0] + 1j * products[:, 1])[same.ravel()]
    seen *= C[:, None, None]
    seen[:, :, range(rank), range(rank)] += 1.0
    return seen


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
    weights, (press, rank). seen: see `_seen`."""
    N, F = len(driven.potential), driven.floating
    floats = F.shape[1]
    charge = driven.potential @ rows
    beside = np.concatenate([F.T @ rows[:, :, N:], U], axis=1)
    weighed = np.concatenate([np.ones((len(C), floats)), C], axis=1)
    sign = np.repeat(np.stack([-(s**2), s], axis=1), [floats, C.shape[1]], axis=1)
    system = _beside_floating(driven, rows, P, beside, weighed, seen, s) if floats else seen
    right = -sign * ((P * charge[:, None, N:]) @ beside.transpose(0, 2, 1))
    right[:, :, :floats] -= s[:, None] * (charge[:, :N] @ F)[:, None]
    found = np.linalg.solve(system, right[..., None])[..., 0]
    v = -s[:, None] * P * (charge[:, None, N:] + (found * weighed[:, None]) @ beside)
    at_terminals = driven.potential + found[:, :, :floats] @ F.T
    u = np.concatenate([at_terminals, v], axis=2)
    return u, driven.conductance + s * (u @ charge[:, :, None])[:, :, 0]


def _beside_floating(
    driven: Driven,
    rows: NDArray[np.float64],
    P: NDArray[np.complex128],
    beside: NDArray[np.float64],
    weighed: NDArray[np.float64],
    seen: NDArray[np.complex128],
    s: NDArray[np.complex128],
) -> NDArray[np.complex128]:
    """The matrix of what cells see with that of floating terminals before it."""
    F, N = driven.floating, len(driven.potential)
    floats, k = F.shape[1], beside.shape[1]
    system = np.empty((*seen.shape[:2], k, k), dtype=complex)
    system[:, :, floats:, floats:] = seen
    across = (beside[:, None, :floats] * P[:, :, None]) @ beside.transpose(0, 2, 1)[:, None]
    system[:, :, :floats] = -(s[:, None, None] ** 2) * across * weighed[:, None, None]
    back = across[:, :, :, floats:].transpose(0, 1, 3, 2)
    system[:, :, floats:, :floats] = s[:, None, None] * back
    system[:, :, :floats, :floats] += driven.floating_conductance
    system[:, :, :floats, :floats] += s[:, None, None] * (F.T @ rows[:, :, :N] @ F)[:, None]
    return system
