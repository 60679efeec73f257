"""Admittance between all terminals of a pressed skin, and impedances at interfaces, compiled.

Touches of few factors use Woodbury's formula, see `woodbury_kernel`; touches of more than the basis
has vectors are solved where M is diagonal.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Complex, Integer, Real
from ...compiled import compiled
from ...press.batch import PressBatch
from ..reduced.dense import UnpressedMass, between_terminals, mass_of, own_axes
from .woodbury_kernel import UnpressedNetwork, by_touches


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
        pressed, _ = own_axes(mass_of(unpressed, *batch.one(press)), N)
        Y[press] = between_terminals(pressed, s)
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
            by_touches(unpressed, known, touched, W, s, Y[press:after])
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
