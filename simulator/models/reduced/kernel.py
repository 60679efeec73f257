"""Compiled sweeps of a reduced model: Lanczos' method and continued fractions.

The method is that of `lanczos.respond`, in coordinates in which K is 1 and the unpressed M is
diagonal except for the few rows of the terminals. A touched pixel adds a product of thin factors.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from ...fem.error_estimate import LOST_SUSCEPTANCE
from ...fem.excitation import Combination
from ...fem.kernels import continued_fractions, next_convergent
from ...fem.lanczos import MAX_LANCZOS_STEPS, MIN_LANCZOS_STEPS
from ...press.batch import PressBatch
from .dense import DenseExcitation, UnpressedMass

ROOM = 5
"""Number of work vectors of Lanczos' method, without two for each conductor that floats as a
whole."""


@compiled()
def swept(
    rest: UnpressedMass,
    feed: DenseExcitation,
    batch: PressBatch,
    s: NDArray,
    rtol: float,
) -> NDArray:  # pragma: no cover
    """Y in S of many presses, shape (press, s).

    Each press adds its rises times M of its cells. s: rad/s. rtol: tolerance of Rs and Cp at which
    Lanczos' method ends.
    """
    cells, rises, starts = batch
    Y = np.empty((len(starts) - 1, len(s)), np.complex128)
    farthest, parts = farthest_of(s), np.empty((4, len(s)))
    for k in range(len(s)):
        square = s[k] * s[k]
        parts[0, k], parts[1, k] = s[k].real, s[k].imag
        parts[2, k], parts[3, k] = square.real, square.imag
    room, fractions = room_for(rest, feed), np.empty((2, len(s)))
    diagonal, squared = np.empty(MAX_LANCZOS_STEPS), np.empty(MAX_LANCZOS_STEPS)
    basis = np.empty((0, rest.rows.shape[1]))
    for press in range(len(starts) - 1):
        first, end = starts[press], starts[press + 1]
        touched = cells[first:end], rises[first:end]
        steps, capacitance = lanczos_steps(
            rest, feed, touched, farthest, rtol, room, diagonal, squared, basis
        )
        delayed = 0.0
        if steps:
            delayed = squared[0]
            continued_fractions(parts, diagonal, squared, steps, fractions)
        for k in range(len(s)):
            at_once = feed.conductance + s[k] * capacitance
            late = complex(parts[2, k], parts[3, k]) * complex(fractions[0, k], fractions[1, k])
            Y[press, k] = at_once - delayed * late if steps else at_once
    return Y


def impedances(
    rest: UnpressedMass,
    feeds: Sequence[DenseExcitation],
    combination: Combination,
    batch: PressBatch,
    s: NDArray[np.complex128],
    rtol: float,
) -> NDArray[np.complex128]:
    """Z in ohm of every interface, shape (press, interface, s); for arguments see `swept`."""
    contiguous = np.ascontiguousarray(batch.cells)  # otherwise another `swept` is compiled
    Y = [swept(rest, feed, batch._replace(cells=contiguous), s, rtol) for feed in feeds]
    Y = Y if combination.one_to_one else [*combination.admittance(np.stack(Y))]
    return (1 / np.stack(Y, axis=1)).astype(np.complex128)


@compiled()
def room_for(rest: UnpressedMass, feed: DenseExcitation) -> NDArray:  # pragma: no cover
    """Work vectors of `lanczos_steps`, shape (vector, m)."""
    return np.empty((ROOM + 2 * len(feed.common), rest.rows.shape[1]))


@compiled()
def farthest_of(s: NDArray) -> complex:  # pragma: no cover
    """The s of largest modulus, at which Lanczos' method takes longest."""
    farthest = s[0]
    for k in range(len(s)):
        if abs(s[k]) > abs(farthest):
            farthest = s[k]
    return farthest


@compiled()
def lanczos_steps(
    rest: UnpressedMass,
    feed: DenseExcitation,
    touched: tuple[NDArray, NDArray],
    s: complex,
    rtol: float,
    room: NDArray,
    diagonal: NDArray,
    squared: NDArray,
    basis: NDArray,
) -> tuple[int, float]:  # pragma: no cover
    """Lanczos' method until two steps in a row change neither Rs nor Cp at s by rtol.

    touched: cells and their rises. room: from `room_for`; on return its first vector holds the
    potentials at s = 0, V. diagonal, squared: filled as `continued_fraction` takes them. basis:
    filled with the vector of each step, shape (MAX_LANCZOS_STEPS, m), unless it is empty. Returns
    the number of steps and the capacitance that acts at once, F.
    """
    terminals, m = rest.rows.shape
    for vector in range(len(room)):
        for k in range(m):
            room[vector, k] = 0.0
    potential, w, residual, product, solution = room[0], room[1], room[2], room[3], room[4]
    count = len(feed.common)
    common, charge, own = room[ROOM : ROOM + count], room[ROOM + count :], np.empty(count)
    driven, floating = terminals > 0, len(feed.tied) + count > 0
    for k in range(terminals):
        potential[k] = feed.driven[k]
    for each in range(count):
        for k in range(terminals):
            common[each, k] = feed.common[each, k]
        _neutralise(common, charge, own, each, terminals, common[each])
        _charge(rest, touched, common[each], charge[each], driven)
        own[each] = _dot(common[each, :terminals], charge[each, :terminals])
    _neutralise(common, charge, own, count, terminals, potential)
    _charge(rest, touched, potential, residual, driven)
    capacitance = _dot(potential, residual)
    now = feed.conductance + s * capacitance
    convergent = 0.0j, 1.0 + 0.0j, 0.0j, 0.0j
    steps, change_before, beside = 0, np.inf, 0.0
    while steps < MAX_LANCZOS_STEPS:
        _solve(feed, residual, solution)
        _neutralise(common, charge, own, count, terminals, solution)
        square = _dot(residual, solution)
        if not square > 0.0:
            break
        beside = np.sqrt(square)
        share = 1.0 / beside
        for k in range(m):
            solution[k] *= share
        _charge(rest, touched, solution, product, floating)
        squared[steps], diagonal[steps] = square, _dot(solution, product)
        if len(basis):
            for k in range(m):
                basis[steps, k] = solution[k]
        a = diagonal[steps]
        for k in range(m):
            w_before, w[k] = w[k], residual[k] * share
            residual[k] = product[k] - a * w[k] - beside * w_before
        convergent = next_convergent(convergent, s, a, square, steps)
        steps += 1
        fraction = convergent[0] * convergent[1].conjugate()
        before, now = now, feed.conductance + s * capacitance - s * s * squared[0] * fraction
        change = _difference(before, now)
        if steps >= MIN_LANCZOS_STEPS and change <= rtol and change_before <= rtol:
            break
        change_before = change
    return steps, capacitance


@compiled(fastmath={"reassoc", "contract"})
def _charge(
    rest: UnpressedMass,
    touched: tuple[NDArray, NDArray],
    v: NDArray,
    charge: NDArray,
    floating: bool,
) -> None:  # pragma: no cover
    """Writes M v in C into `charge`.

    Unless `floating`, v is 0 at terminals and their charge is left out. Rows of factors are taken
    four at a time: v and charge are then read less often.
    """
    terminals, m = rest.rows.shape
    for k in range(terminals, m):
        charge[k] = rest.diagonal[k - terminals] * v[k]
    for row in range(terminals if floating else 0):
        charge[row] = _dot(rest.rows[row], v)
        for k in range(terminals, m):
            charge[k] += rest.rows[row, k] * v[row]
    cells, rises = touched
    for touch in range(len(cells)):
        factor, rise = rest.factors[cells[touch]], rises[touch]
        whole = len(factor) - len(factor) % 4
        for row in range(0, whole, 4):
            a, b, c, d = 0.0, 0.0, 0.0, 0.0
            for k in range(m):
                a += factor[row, k] * v[k]
                b += factor[row + 1, k] * v[k]
                c += factor[row + 2, k] * v[k]
                d += factor[row + 3, k] * v[k]
            a, b, c, d = rise * a, rise * b, rise * c, rise * d
            for k in range(m):
                charge[k] += (
                    a * factor[row, k]
                    + b * factor[row + 1, k]
                    + c * factor[row + 2, k]
                    + d * factor[row + 3, k]
                )
        for row in range(whole, len(factor)):
            part = rise * _dot(factor[row], v)
            for k in range(m):
                charge[k] += part * factor[row, k]


@compiled(fastmath={"reassoc", "contract"})
def _dot(u: NDArray, v: NDArray) -> float:  # pragma: no cover
    total = 0.0
    for k in range(len(u)):
        total += u[k] * v[k]
    return total


@compiled()
def _neutralise(
    common: NDArray, charge: NDArray, own: NDArray, count: int, terminals: int, v: NDArray
) -> None:  # pragma: no cover
    """Shifts v by the first `count` common potentials, so that each keeps its charge.

    common: potentials of conductors that float as a whole, of which none charges another. charge: M
    times those, C. own: their capacitances, F.
    """
    for each in range(count):
        shift = _dot(charge[each], v) / own[each]
        for k in range(terminals):
            v[k] -= shift * common[each, k]


@compiled()
def _solve(feed: DenseExcitation, y: NDArray, solution: NDArray) -> None:  # pragma: no cover
    """Writes K^-1 y into `solution`.

    K is 1 in the basis; floating terminals follow from the conductance between them.
    """
    terminals = len(feed.driven)
    for k in range(len(y)):
        solution[k] = y[k] if k >= terminals else 0.0
    for row in range(len(feed.tied)):
        potential = 0.0
        for column in range(len(feed.tied)):
            current = _dot(feed.tied[column], y[:terminals])
            potential += feed.tied_inverse[row, column] * current
        for k in range(terminals):
            solution[k] += potential * feed.tied[row, k]


@compiled()
def _difference(Y: complex, other: complex) -> float:  # pragma: no cover
    """Larger of the differences of Rs and Cp, relative to those of `other`.

    If Y or the real part of `other` is 0, it is 0 for equal admittances and inf otherwise.
    """
    own, others = _square(Y), _square(other)
    if own * other.real == 0.0:
        return 0.0 if Y == other else np.inf
    Rs = abs(Y.real * others / (other.real * own) - 1.0)
    B = max(abs(other.imag), LOST_SUSCEPTANCE * np.sqrt(others))
    return max(Rs, abs(Y.imag - other.imag) / B)


@compiled()
def _square(z: complex) -> float:  # pragma: no cover
    return z.real * z.real + z.imag * z.imag
