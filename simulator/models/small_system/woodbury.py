"""Admittance between all terminals of a pressed skin, and impedances at interfaces, compiled.

Touches of few factors use Woodbury's formula; touches of more than the basis has vectors are solved
where M is diagonal.

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

from ...arrays import Complex, Integer, Real
from ...compiled import compiled
from ...press.batch import PressBatch
from .system import UnpressedMass, diagonalised, mass_of, networks

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
    at, F = unpressed.factors[..., :N], np.ascontiguousarray(unpressed.factors[..., N:])
    (Y,), (inside,), _ = networks(unpressed, np.zeros((1, 0), np.int64), np.zeros((1, 0)), s)
    P = 1 / (1 + s[:, None] * unpressed.diagonal)
    terminal_potentials = np.empty((*at.shape, 2, len(s)))
    own = np.empty((*F.shape[:2], F.shape[1], 2, len(s)))
    for k, (U, U_at) in enumerate(zip(F, at, strict=True)):
        terminal_potentials[k] = _real_and_imaginary(U_at + U @ inside)
        own[k] = _real_and_imaginary((U * P[:, None]) @ U.T)
    return UnpressedNetwork(Y, _real_and_imaginary(P), terminal_potentials, own)


def _real_and_imaginary(values: Complex) -> Real:
    """Real and imaginary parts, shape (s, ...) to (..., 2, s)."""
    last = np.moveaxis(values, 0, -1)
    return np.stack([last.real, last.imag], axis=-2)


def admittances(
    unpressed: UnpressedMass, known: UnpressedNetwork, batch: PressBatch, s: Complex
) -> Complex:
    """Y in S beyond that at zero frequency, for many presses, shape (press, s, N, N).

    Each press adds its rises times M of its cells. s: rad/s.
    """
    N = len(unpressed.rows)
    Y = np.empty((batch.count, len(s), N, N), dtype=np.complex128)
    many = np.diff(batch.starts) * unpressed.factors.shape[1] > len(unpressed.diagonal)
    _of_few(unpressed, known, batch, many, s, Y)
    for press in np.flatnonzero(many).tolist():
        Y[press] = diagonalised(mass_of(unpressed, *batch.one(press))[None], N, s).Y[0]
    return Y


@compiled()
def _of_few(
    unpressed: UnpressedMass,
    known: UnpressedNetwork,
    batch: PressBatch,
    many: NDArray,
    s: NDArray,
    Y: NDArray,
) -> None:  # pragma: no cover
    """Admittances of presses that do not touch many cells, written into Y."""
    (cells, weights, starts), press = batch, 0
    while press < len(Y):
        after, touched = (
            _next_with_other_cells(cells, starts, press),
            cells[starts[press] : starts[press + 1]],
        )
        if not many[press]:
            W = weights[starts[press] : starts[after]].reshape(after - press, len(touched))
            _by_touches(unpressed, known, touched, W, s, Y[press:after])
        press = after


@compiled()
def _next_with_other_cells(cells: NDArray, starts: NDArray, press: int) -> int:  # pragma: no cover
    """Index of the first press after this one that touches other cells."""
    touched, after = cells[starts[press] : starts[press + 1]], press + 1
    while after < len(starts) - 1:
        others = cells[starts[after] : starts[after + 1]]
        if len(others) != len(touched) or (others != touched).any():
            break
        after += 1
    return after


@compiled()
def _by_touches(
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


class Wiring(NamedTuple):
    """Terminal potentials that excitations allow, see `allowed_potentials`; the driven ones first.

    potentials: shape (excitation, N, most). conductance: between them at zero frequency, S, shape
    (excitation, most, most). counts: number of potentials of each excitation, shape (excitation,).
    weights: of the excitations in each interface, see `Combination`.
    """

    potentials: Real
    conductance: Real
    counts: Integer
    weights: Real


@compiled()
def impedances(Y: NDArray, wiring: Wiring) -> NDArray:  # pragma: no cover
    """Z in ohm of every excitation, shape (press, excitation, s); Y: from `admittances`.

    Floating potentials are eliminated one after the other. An excitation without any current, such
    as one against an earth that nothing reaches, has an infinite Z.
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
                if A[0, 0] == 0.0:
                    Z[press, reading, k] = np.inf
                else:
                    Z[press, reading, k] = 1.0 / A[0, 0]
    return Z
