"""Admittance between all terminals of a pressed skin, and what readings make of it, fused.

Touches of few factors go by Woodbury's formula, see `touches`; those of more than the basis has
vectors are solved for in the basis.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from ...press.batch import PressBatch
from ..reduced.dense import Rest, written_out
from .touches import AtRest, by_touches


class Wiring(NamedTuple):
    """Potentials that readings allow the terminals, see `allowed_potentials`, the driven first.

    potentials: shape (reading, N, most). conductance: between them at zero frequency, S, shape
    (reading, most, most). counts: how many there are, shape (reading,).
    """

    potentials: NDArray[np.float64]
    conductance: NDArray[np.float64]
    counts: NDArray[np.int64]


@compiled()
def admittances(
    rest: Rest,
    known: AtRest,
    batch: PressBatch,
    s: NDArray,
) -> NDArray:  # pragma: no cover
    """Y in S beyond that at zero frequency, of many presses, shape (press, s, N, N).

    Each adds its rises times M of its cells. s: rad/s.
    """
    N, (cells, weights, starts) = len(rest.rows), batch
    Y = np.empty((len(starts) - 1, len(s), N, N), np.complex128)
    most, press = len(rest.diagonal), 0
    while press < len(Y):
        after, touched = _alike(cells, starts, press), cells[starts[press] : starts[press + 1]]
        W = weights[starts[press] : starts[after]].reshape(after - press, len(touched))
        if len(touched) * rest.factors.shape[1] <= most:
            by_touches(rest, known, touched, W, s, Y[press:after])
        else:
            for own in range(len(W)):
                _in_basis(rest, touched, W[own], s, Y[press + own])
        press = after
    return Y


def admittances_readable(
    rest: Rest, batch: PressBatch, s: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    """What `admittances` does, with matrices written out."""
    N, found = len(rest.rows), []
    for cells, weights in batch.each():
        M = written_out(rest, cells, weights)
        inner, beside = np.eye(len(M) - N), M[N:, :N]
        for each in s:
            delayed = np.linalg.solve(inner + each * M[N:, N:], beside)
            found.append(each * M[:N, :N] - each**2 * beside.T @ delayed)
    return np.reshape(found, (batch.count, len(s), N, N))


@compiled()
def _alike(cells: NDArray, starts: NDArray, press: int) -> int:  # pragma: no cover
    """The first press after this one that touches other cells."""
    touched, after = cells[starts[press] : starts[press + 1]], press + 1
    while after < len(starts) - 1:
        others = cells[starts[after] : starts[after + 1]]
        if len(others) != len(touched) or (others != touched).any():
            break
        after += 1
    return after


@compiled()
def _in_basis(
    rest: Rest, cells: NDArray, W: NDArray, s: NDArray, Y: NDArray
) -> None:  # pragma: no cover
    N, n = len(rest.rows), len(rest.diagonal)
    M, A = _pressed(rest, cells, W), np.empty((n, n), np.complex128)
    solution = np.empty((n, N), np.complex128)
    for k in range(len(s)):
        for row in range(n):
            for column in range(n):
                A[row, column] = s[k] * M[N + row, N + column]
            A[row, row] += 1.0
            for terminal in range(N):
                solution[row, terminal] = M[N + row, terminal]
        _solve(A, solution)
        for i in range(N):
            for j in range(N):
                delayed = 0.0j
                for row in range(n):
                    delayed += M[N + row, i] * solution[row, j]
                Y[k, i, j] = s[k] * M[i, j] - s[k] * s[k] * delayed


@compiled(fastmath={"reassoc", "contract"})
def _pressed(rest: Rest, cells: NDArray, W: NDArray) -> NDArray:  # pragma: no cover
    """M of the press, terminals first, as `written_out` has it."""
    N, size = rest.rows.shape
    M = np.zeros((size, size))
    for row in range(N):
        for column in range(size):
            M[row, column] = M[column, row] = rest.rows[row, column]
    for k in range(N, size):
        M[k, k] = rest.diagonal[k - N]
    for touch in range(len(cells)):
        U = rest.factors[cells[touch]]
        for factor in range(len(U)):
            for row in range(size):
                share = W[touch] * U[factor, row]
                for column in range(size):
                    M[row, column] += share * U[factor, column]
    return M


@compiled()
def _solve(A: NDArray, B: NDArray) -> None:  # pragma: no cover
    """B = A^-1 B without pivoting, as real parts of A's eigenvalues are above zero."""
    size = len(A)
    for k in range(size):
        inverse = 1.0 / A[k, k]
        for row in range(k + 1, size):
            factor = A[row, k] * inverse
            for column in range(k + 1, size):
                A[row, column] -= factor * A[k, column]
            for column in range(B.shape[1]):
                B[row, column] -= factor * B[k, column]
    for k in range(size - 1, -1, -1):
        for column in range(B.shape[1]):
            for row in range(k + 1, size):
                B[k, column] -= A[k, row] * B[row, column]
            B[k, column] /= A[k, k]


@compiled()
def impedances(Y: NDArray, wiring: Wiring) -> NDArray:  # pragma: no cover
    """Z in ohm of every reading, shape (press, reading, s); Y: of `admittances`.

    What floats is eliminated one potential after the other.
    """
    presses, count, N, _ = Y.shape
    readings, _, most = wiring.potentials.shape
    Z = np.empty((presses, readings, count), np.complex128)
    A, through = np.empty((most, most), np.complex128), np.empty((N, most), np.complex128)
    for press in range(presses):
        for k in range(count):
            for reading in range(readings):
                allowed, m = wiring.potentials[reading], wiring.counts[reading]
                for i in range(N):
                    for b in range(m):
                        total = 0.0j
                        for j in range(N):
                            total += Y[press, k, i, j] * allowed[j, b]
                        through[i, b] = total
                for a in range(m):
                    for b in range(m):
                        total = wiring.conductance[reading, a, b] + 0.0j
                        for i in range(N):
                            total += allowed[i, a] * through[i, b]
                        A[a, b] = total
                for last in range(m - 1, 0, -1):
                    for a in range(last):
                        factor = A[a, last] / A[last, last]
                        for b in range(last):
                            A[a, b] -= factor * A[last, b]
                Z[press, reading, k] = 1.0 / A[0, 0]
    return Z
