"""Sweeps of many small systems under presses, compiled: Lanczos' method and continued fractions.

The method is that of `fem.lanczos.respond`, in coordinates in which K is 1 and the unpressed M is
diagonal except for the few rows of the terminals. A touched pixel adds a product of thin factors.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from ...arrays import Complex, Integer, Real
from ...compiled import compiled
from ...fem.error_estimate import LOST_SUSCEPTANCE
from ...fem.kernels import continued_fractions, next_convergent
from ...fem.lanczos import MAX_LANCZOS_STEPS, MIN_LANCZOS_STEPS
from ...press.batch import PressBatch
from .system import DenseExcitation, UnpressedMass

WORK_VECTORS = 5
"""Number of work vectors of Lanczos' method, without two for each conductor that floats as a
whole."""


SINGLE_RTOL = 1e-5
"""Tolerance of Rs and Cp above which single precision suffices: it leaves errors of some 1e-6."""


class Skins(NamedTuple):
    """Small systems of skins that are swept together: all arrays have a first axis (skin,).

    rows, diagonal, factors: unpressed M and factors of its parts, see `UnpressedMass`. unit: of the
    rises of each part, shape (skin, part). s: rad/s, shape (skin, s). rtol: tolerance of Rs and Cp
    at which Lanczos' method ends, shape (skin,).
    """

    rows: Real
    diagonal: Real
    factors: Real
    unit: Real
    s: Complex
    rtol: Real

    @classmethod
    def of_one(cls, mass: UnpressedMass, unit: Real, s: Complex, rtol: float) -> Self:
        """Arrays of one skin."""
        rows, diagonal, factors = (each[None] for each in mass)
        return cls(rows, diagonal, factors, unit[None], s[None], np.array([rtol]))

    def rounded(self) -> Self:
        """Systems in single precision, which take half the time, if all tolerances allow it."""
        if self.rtol.min() <= SINGLE_RTOL:
            return self
        rows, diagonal, factors = (each.astype(np.float32) for each in self[:3])
        return self._replace(rows=rows, diagonal=diagonal, factors=factors)

    def admittances(
        self, excitation: DenseExcitation, batch: PressBatch, skins: Integer, presses: Integer
    ) -> Complex:
        """Y in S, shape (row, s): row k is of skin skins[k] under press presses[k].

        excitation: of each skin, with a first axis (skin,). Each press adds its rises, in units of
        the skin's parts, times M of its cells.
        """
        touched = np.ascontiguousarray(batch.cells), *batch[1:]
        return _swept(tuple(self), tuple(excitation), skins, presses, touched)


@compiled()
def _swept(
    systems: tuple, excitation: tuple, skins: NDArray, presses: NDArray, batch: tuple
) -> NDArray:  # pragma: no cover
    """`Skins.admittances`; plain tuples of arrays are passed in a third of the time."""
    rows, diagonals, factors, unit, s, rtol = systems
    conductance, driven, tied, tied_inverse, common = excitation
    cells, rises, starts = batch
    frequencies = s.shape[1]
    Y, fractions = np.empty((len(skins), frequencies), np.complex128), np.empty((2, frequencies))
    parts, farthest = np.empty((4, frequencies)), 0.0j
    diagonal, squared = np.empty(MAX_LANCZOS_STEPS), np.empty(MAX_LANCZOS_STEPS)
    work = np.empty((WORK_VECTORS + 2 * common.shape[1], rows.shape[2]), rows.dtype)
    for row in range(len(skins)):
        skin, press = skins[row], presses[row]
        mass = UnpressedMass(rows[skin], diagonals[skin], factors[skin])
        own = DenseExcitation(
            conductance[skin], driven[skin], tied[skin], tied_inverse[skin], common[skin]
        )
        here, at = cells[starts[press] : starts[press + 1]], s[skin]
        weights = rises[starts[press] : starts[press + 1]].astype(rows.dtype)
        for k in range(len(here)):
            weights[k] *= unit[skin, here[k]]
        if row == 0 or skin != skins[row - 1]:
            farthest = at[0]
            for k in range(frequencies):
                square = at[k] * at[k]
                parts[0, k], parts[1, k] = at[k].real, at[k].imag
                parts[2, k], parts[3, k] = square.real, square.imag
                if _square(at[k]) > _square(farthest):
                    farthest = at[k]
        steps, capacitance = _lanczos_steps(
            mass, own, (here, weights), farthest, rtol[skin], work, diagonal, squared
        )
        if steps:
            continued_fractions(parts, diagonal, squared, steps, fractions)
        for k in range(frequencies):
            Y[row, k] = own.conductance + at[k] * capacitance
            if steps:
                late = complex(fractions[0, k], fractions[1, k])
                Y[row, k] -= squared[0] * complex(parts[2, k], parts[3, k]) * late
    return Y


@compiled()
def _lanczos_steps(
    unpressed: UnpressedMass,
    excitation: DenseExcitation,
    touched: tuple[NDArray, NDArray],
    s: complex,
    rtol: Any,
    work: NDArray,
    diagonal: NDArray,
    squared: NDArray,
) -> tuple[int, float]:  # pragma: no cover
    """Lanczos' method until two steps in a row change neither Rs nor Cp at s by rtol.

    touched: cells and their weights. work: vectors, shape (vector, m). diagonal, squared: filled as
    `continued_fraction` takes them. Returns the number of steps and the capacitance that acts at
    once, F.
    """
    terminals, m = unpressed.rows.shape
    for vector in range(len(work)):
        for k in range(m):
            work[vector, k] = 0.0
    potential, w, residual, product, solution = work[0], work[1], work[2], work[3], work[4]
    count = len(excitation.common)
    common, charge, own = (
        work[WORK_VECTORS : WORK_VECTORS + count],
        work[WORK_VECTORS + count :],
        np.empty(count),
    )
    driven, floating = terminals > 0, len(excitation.tied) + count > 0
    for k in range(terminals):
        potential[k] = excitation.driven[k]
    for each in range(count):
        for k in range(terminals):
            common[each, k] = excitation.common[each, k]
        _neutralise(common, charge, own, each, terminals, common[each])
        _charge(unpressed, touched, common[each, :terminals], charge[each], driven)
        own[each] = _dot(common[each, :terminals], charge[each, :terminals])
    _neutralise(common, charge, own, count, terminals, potential)
    _charge(unpressed, touched, potential[:terminals], residual, driven)
    capacitance = _dot(potential, residual)
    now = excitation.conductance + s * capacitance
    convergent = 0.0j, 1.0 + 0.0j, 0.0j, 0.0j
    steps, change_before, beta = 0, np.inf, 0.0
    while steps < MAX_LANCZOS_STEPS:
        _solve(excitation, residual, solution)
        _neutralise(common, charge, own, count, terminals, solution)
        square = _dot(residual, solution)
        if not square > 0.0:
            break
        beta = np.sqrt(square)
        share = 1.0 / beta
        for k in range(m):
            solution[k] *= share
        _charge(unpressed, touched, solution, product, floating)
        squared[steps], diagonal[steps] = square, _dot(solution, product)
        a = diagonal[steps]
        for k in range(m):
            w_before, w[k] = w[k], residual[k] * share
            residual[k] = product[k] - a * w[k] - beta * w_before
        convergent = next_convergent(convergent, s, a, square, steps)
        steps += 1
        fraction = convergent[0] * convergent[1].conjugate()
        before, now = now, excitation.conductance + s * capacitance - s * s * squared[0] * fraction
        change = _difference(before, now)
        if steps >= MIN_LANCZOS_STEPS and change <= rtol and change_before <= rtol:
            break
        change_before = change
    return steps, capacitance


@compiled(fastmath={"reassoc", "contract"})
def _charge(
    unpressed: UnpressedMass,
    touched: tuple[NDArray, NDArray],
    v: NDArray,
    charge: NDArray,
    floating: bool,
) -> None:  # pragma: no cover
    """Writes M v in C into `charge`.

    v: 0 beyond its end. Unless `floating`, v is 0 at terminals and their charge is left out. Rows
    of factors are taken four at a time: v and charge are then read less often.
    """
    (terminals, m), known = unpressed.rows.shape, len(v)
    for k in range(terminals, m):
        charge[k] = unpressed.diagonal[k - terminals] * v[k] if k < known else 0.0
    for row in range(terminals if floating else 0):
        charge[row] = _dot(v, unpressed.rows[row])
        for k in range(terminals, m):
            charge[k] += unpressed.rows[row, k] * v[row]
    cells, rises = touched
    for touch in range(len(cells)):
        factor, rise = unpressed.factors[cells[touch]], rises[touch]
        whole = len(factor) - len(factor) % 4
        for row in range(0, whole, 4):
            a = b = c = d = v.dtype.type(0)
            for k in range(known):
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
            part = rise * _dot(v, factor[row])
            for k in range(m):
                charge[k] += part * factor[row, k]


@compiled(fastmath={"reassoc", "contract"})
def _dot(u: NDArray, v: NDArray) -> float:  # pragma: no cover
    total = u.dtype.type(0)
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
def _solve(excitation: DenseExcitation, y: NDArray, solution: NDArray) -> None:  # pragma: no cover
    """Writes K^-1 y into `solution`.

    K is 1 in the basis; floating terminals follow from the conductance between them.
    """
    terminals = len(excitation.driven)
    for k in range(len(y)):
        solution[k] = y[k] if k >= terminals else 0.0
    for row in range(len(excitation.tied)):
        potential = 0.0
        for column in range(len(excitation.tied)):
            current = _dot(excitation.tied[column], y[:terminals])
            potential += excitation.tied_inverse[row, column] * current
        for k in range(terminals):
            solution[k] += potential * excitation.tied[row, k]


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
