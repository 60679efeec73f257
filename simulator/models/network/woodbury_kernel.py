"""Compiled admittance between all terminals of a skin under touches of low rank.

It uses Woodbury's formula.

In coordinates in which K is 1 and the unpressed M diagonal, P = 1 / (1 + s d), the terminals'
potentials are T = [1; -s P B'] for the rows B of the terminals in M. A touch adds s U'WU with thin
factors U. With E = U T, Q = U P U', R the root of |W| and D its sign, Y = Y_unpressed + s E'R (D +
s R Q R)^-1 R E. That matrix is symmetric. It is eliminated at many s together, with separate real
and imaginary parts, because processors take several numbers at once.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Complex, Real
from ...compiled import compiled
from ..reduced.dense import UnpressedMass, between_terminals

SIDE_BY_SIDE = 64
"""Maximum number of s together: more would not fit into the processor's cache."""


class UnpressedNetwork(NamedTuple):
    """Quantities that do not depend on the press, at each s.

    Real and imaginary parts are separate, except in Y.

    admittance: Y beyond that at zero frequency, S, shape (s, N, N). damped: P, shape (n, 2, s).
    terminal_potentials: E of each cell, shape (cell, rank, N, 2, s). own: Q of each, shape (cell,
    rank, rank, 2, s).
    """

    admittance: Complex
    damped: Real
    terminal_potentials: Real
    own: Real


def unpressed_network(unpressed: UnpressedMass, s: Complex) -> UnpressedNetwork:
    """Unpressed quantities of a skin. s: rad/s."""
    N = len(unpressed.rows)
    inner_rows = unpressed.rows[:, N:]
    at, inside = unpressed.factors[..., :N], np.ascontiguousarray(unpressed.factors[..., N:])
    P = 1 / (1 + s[:, None] * unpressed.diagonal)
    each = s[:, None, None]
    terminal_potentials = np.empty((*at.shape, 2, len(s)))
    own = np.empty((*inside.shape[:2], inside.shape[1], 2, len(s)))
    for k, (U, U_at) in enumerate(zip(inside, at, strict=True)):
        damped = U * P[:, None]
        terminal_potentials[k] = _real_and_imaginary(U_at - each * (damped @ inner_rows.T))
        own[k] = _real_and_imaginary(damped @ U.T)
    return UnpressedNetwork(
        between_terminals(unpressed, s), _real_and_imaginary(P), terminal_potentials, own
    )


def _real_and_imaginary(values: Complex) -> Real:
    """Real and imaginary parts, shape (s, ...) to (..., 2, s)."""
    last = np.moveaxis(values, 0, -1)
    return np.stack([last.real, last.imag], axis=-2)


@compiled()
def by_touches(
    unpressed: UnpressedMass,
    known: UnpressedNetwork,
    cells: NDArray,
    W: NDArray,
    s: NDArray,
    Y: NDArray,
) -> None:  # pragma: no cover
    """Y in S beyond that at zero frequency, shape (press, s, N, N), of presses on the same cells.

    W: shape (press, cell). s: rad/s.
    """
    N, size = len(unpressed.rows), unpressed.factors.shape[1] * len(cells)
    turns = -(-len(s) // SIDE_BY_SIDE)
    for turn in range(turns):
        start, end = turn * len(s) // turns, (turn + 1) * len(s) // turns
        together, added = np.empty((size, size + N, 2, end - start)), np.empty((2, end - start))
        _put_together(unpressed, known, cells, start, together)
        own = np.empty_like(together)
        for press in range(len(W)):
            _weigh(together, W[press], s[start:end], own)
            _eliminate(own)
            for i in range(N):
                for j in range(i + 1):
                    _multiply(own, i, j, added)
                    for k in range(end - start):
                        total = s[start + k] * complex(added[0, k], added[1, k])
                        total += known.admittance[start + k, i, j]
                        Y[press, start + k, i, j] = Y[press, start + k, j, i] = total


@compiled()
def _put_together(
    unpressed: UnpressedMass, known: UnpressedNetwork, cells: NDArray, start: int, together: NDArray
) -> None:  # pragma: no cover
    """Q from the diagonal on, and E in the columns after it, shape (size, size + N, 2, s)."""
    N, (size, _, _, count) = len(unpressed.rows), together.shape
    rank = size // max(len(cells), 1)
    for i in range(len(cells)):
        here = i * rank
        for row in range(rank):
            for part in range(2):
                for k in range(count):
                    for column in range(row, rank):
                        own = known.own[cells[i], row, column, part, start + k]
                        together[here + row, here + column, part, k] = own
                    for terminal in range(N):
                        terminal_potentials = known.terminal_potentials[
                            cells[i], row, terminal, part, start + k
                        ]
                        together[here + row, size + terminal, part, k] = terminal_potentials
        for j in range(i + 1, len(cells)):
            U, V = unpressed.factors[cells[i], :, N:], unpressed.factors[cells[j], :, N:]
            P = known.damped[:, :, start : start + count]
            _between(U, V, P, together[here:, j * rank :])


@compiled(fastmath={"reassoc", "contract"})
def _between(U: NDArray, V: NDArray, P: NDArray, Q: NDArray) -> None:  # pragma: no cover
    """Q between the factors of two cells, written into a corner of it.

    Four vectors of the basis at a time, so that Q is read less often.
    """
    n = len(P)
    whole = n - n % 4
    for i in range(len(U)):
        for j in range(len(V)):
            for part in range(2):
                total = Q[i, j, part]
                for k in range(len(total)):
                    total[k] = 0.0
                for m in range(0, whole, 4):
                    a, b = U[i, m] * V[j, m], U[i, m + 1] * V[j, m + 1]
                    c, d = U[i, m + 2] * V[j, m + 2], U[i, m + 3] * V[j, m + 3]
                    for k in range(len(total)):
                        total[k] += (
                            a * P[m, part, k]
                            + b * P[m + 1, part, k]
                            + c * P[m + 2, part, k]
                            + d * P[m + 3, part, k]
                        )
                for m in range(whole, n):
                    a = U[i, m] * V[j, m]
                    for k in range(len(total)):
                        total[k] += a * P[m, part, k]


@compiled(fastmath={"reassoc", "contract"})
def _weigh(together: NDArray, W: NDArray, s: NDArray, own: NDArray) -> None:  # pragma: no cover
    """D + s R Q R of one press from the diagonal on, and R E in the columns after it."""
    size, width = own.shape[:2]
    rank = size // max(len(W), 1)
    for row in range(size):
        root = np.sqrt(abs(W[row // rank]))
        for column in range(row, size):
            both = root * np.sqrt(abs(W[column // rank]))
            for k in range(len(s)):
                real, imag = together[row, column, 0, k], together[row, column, 1, k]
                own[row, column, 0, k] = both * (s[k].real * real - s[k].imag * imag)
                own[row, column, 1, k] = both * (s[k].real * imag + s[k].imag * real)
        for k in range(len(s)):
            own[row, row, 0, k] += -1.0 if W[row // rank] < 0.0 else 1.0
        for column in range(size, width):
            for part in range(2):
                for k in range(len(s)):
                    own[row, column, part, k] = root * together[row, column, part, k]


@compiled(fastmath={"reassoc", "contract"})
def _eliminate(own: NDArray) -> None:  # pragma: no cover
    """L C L' of the matrix in front: 1/C into its diagonal, L^-1 times the columns after it in
    place.

    Without pivoting: where capacitance rises the matrix has a real part of at least 1.
    """
    size, width, _, count = own.shape
    real, imag = np.empty(count), np.empty(count)
    for p in range(size):
        for k in range(count):
            a, b = own[p, p, 0, k], own[p, p, 1, k]
            share = 1.0 / (a * a + b * b)
            own[p, p, 0, k], own[p, p, 1, k] = share * a, -share * b
        for row in range(p + 1, size):
            for k in range(count):
                a, b = own[p, row, 0, k], own[p, row, 1, k]
                real[k] = a * own[p, p, 0, k] - b * own[p, p, 1, k]
                imag[k] = a * own[p, p, 1, k] + b * own[p, p, 0, k]
            for column in range(row, width):
                for k in range(count):
                    a, b = own[p, column, 0, k], own[p, column, 1, k]
                    own[row, column, 0, k] -= real[k] * a - imag[k] * b
                    own[row, column, 1, k] -= real[k] * b + imag[k] * a


@compiled(fastmath={"reassoc", "contract"})
def _multiply(own: NDArray, i: int, j: int, total: NDArray) -> None:  # pragma: no cover
    """Product of the columns of terminals i and j with the matrix's inverse; after `_eliminate`."""
    size, _, _, count = own.shape
    for part in range(2):
        for k in range(count):
            total[part, k] = 0.0
    for row in range(size):
        for k in range(count):
            a, b = own[row, size + i, 0, k], own[row, size + i, 1, k]
            c, d = own[row, size + j, 0, k], own[row, size + j, 1, k]
            real, imag = a * c - b * d, a * d + b * c
            total[0, k] += own[row, row, 0, k] * real - own[row, row, 1, k] * imag
            total[1, k] += own[row, row, 0, k] * imag + own[row, row, 1, k] * real
