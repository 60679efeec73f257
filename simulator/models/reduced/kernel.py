"""Whole sweeps of a reduced model, fused: Lanczos' method and continued fractions.

It is `lanczos.respond` in coordinates in which K is 1 and M of the skin at rest is diagonal, but
for the few rows of the terminals. A touched pixel adds a product of thin factors.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...fem.compiled import compiled
from ...fem.estimate import LOST_SUSCEPTANCE
from ...fem.kernels import continued_fraction, continued_fractions
from ...fem.lanczos import FEWEST_STEPS, MOST_STEPS, Pencil, respond


class Rest(NamedTuple):
    """M of a skin at rest, and what its cells add; coordinates are terminals, then basis vectors.

    rows: of the terminals in M, F, shape (terminal, m). diagonal: of the others, F, shape (n,).
    factors: F_k of each cell, M_k = F_k'F_k, shape (cell, rank, m).
    """

    rows: NDArray[np.float64]
    diagonal: NDArray[np.float64]
    factors: NDArray[np.float64]


class Feed(NamedTuple):
    """One drive: potentials of terminals in V.

    conductance: at zero frequency, S. driven: shape (terminal,). tied: of floating ones, shape
    (floating, terminal), with the inverse of their conductance, shape (floating, floating).
    common: of a sheet that floats as a whole, shape (0 or 1, terminal).
    """

    conductance: float
    driven: NDArray[np.float64]
    tied: NDArray[np.float64]
    tied_inverse: NDArray[np.float64]
    common: NDArray[np.float64]


@compiled()
def swept(
    rest: Rest,
    feed: Feed,
    cells: NDArray,
    rises: NDArray,
    starts: NDArray,
    s: NDArray,
    rtol: float,
) -> NDArray:  # pragma: no cover
    """Y in S of many presses, shape (press, s).

    Press k adds `rises` times M of the cells[starts[k]:starts[k + 1]]. s: rad/s. rtol: of Rs and
    Cp, for Lanczos' method to end at.
    """
    Y = np.empty((len(starts) - 1, len(s)), np.complex128)
    for press in range(len(starts) - 1):
        touched = slice(starts[press], starts[press + 1])
        _respond(rest, feed, cells[touched], rises[touched], s, rtol, Y[press])
    return Y


def impedances(
    rest: Rest,
    feeds: Sequence[Feed],
    cells: NDArray[np.int64],
    weights: NDArray[np.float64],
    starts: NDArray[np.int64],
    s: NDArray[np.complex128],
    rtol: float,
) -> NDArray[np.complex128]:
    """Z in ohm of every drive, shape (press, drive, s); arguments as of `swept`."""
    Y = [swept(rest, feed, cells, weights, starts, s, rtol) for feed in feeds]
    return (1 / np.stack(Y, axis=1)).astype(np.complex128)


def swept_readable(
    rest: Rest,
    feed: Feed,
    cells: NDArray[np.int64],
    rises: NDArray[np.float64],
    starts: NDArray[np.int64],
    s: NDArray[np.complex128],
    rtol: float,
) -> NDArray[np.complex128]:
    """What `swept` does, with matrices written out."""
    touched = [slice(*ends) for ends in zip(starts[:-1], starts[1:], strict=True)]
    masses = [written_out(rest, cells[each], rises[each]) for each in touched]
    return np.stack([respond(dense_pencil(mass, feed), s, rtol)[0] for mass in masses])


def written_out(
    rest: Rest, cells: NDArray[np.int64], rises: NDArray[np.float64]
) -> NDArray[np.float64]:
    """M of a press in F, shape (m, m)."""
    terminals = len(rest.rows)
    mass = np.diag(np.concatenate([np.zeros(terminals), rest.diagonal]))
    mass[:terminals] = rest.rows
    mass[:, :terminals] = rest.rows.T
    for cell, rise in zip(cells, rises, strict=True):
        mass += rise * rest.factors[cell].T @ rest.factors[cell]
    return mass


def dense_pencil(mass: NDArray[np.float64], feed: Feed) -> Pencil:
    """K + s M of one drive. mass: M in F, shape (m, m)."""
    terminals = len(feed.driven)
    driven, tied, common = (
        np.pad(each, ((0, 0), (0, len(mass) - terminals)))
        for each in (feed.driven[None], feed.tied, feed.common)
    )

    def neutral(v: NDArray[np.float64]) -> NDArray[np.float64]:
        charge = common @ mass
        return v - common.T @ np.linalg.solve(charge @ common.T, charge @ v)

    def inverse(y: NDArray[np.float64]) -> NDArray[np.float64]:
        v = np.concatenate([np.zeros(terminals), y[terminals:]])
        return neutral(v + tied.T @ (feed.tied_inverse @ (tied @ y)))

    potential = neutral(driven[0])
    start = mass @ potential
    return Pencil(start, mass.dot, inverse, feed.conductance, float(potential @ start), 0.0)


@compiled()
def _respond(
    rest: Rest,
    feed: Feed,
    cells: NDArray,
    rises: NDArray,
    s: NDArray,
    rtol: float,
    Y: NDArray,
) -> None:  # pragma: no cover
    """Lanczos' steps until two in a row change neither Rs nor Cp at the largest |s| by rtol."""
    terminals, m = rest.rows.shape
    diagonal, squared = np.empty(MOST_STEPS), np.empty(MOST_STEPS)
    potential, charge, own = np.zeros(m), np.zeros(m), 1.0
    potential[:terminals] = feed.driven
    if len(feed.common):
        common = np.zeros(m)
        common[:terminals] = feed.common[0]
        _charge(rest, cells, rises, common, charge)
        own = _dot(feed.common[0], charge[:terminals])
        _neutralise(feed, charge, own, potential)
    residual, product, solution, w = np.empty(m), np.empty(m), np.empty(m), np.zeros(m)
    _charge(rest, cells, rises, potential, residual)
    capacitance = _dot(potential, residual)
    farthest = s[np.argmax(np.abs(s))]
    now = feed.conductance + farthest * capacitance
    steps, change_before, beside = 0, np.inf, 0.0
    while steps < MOST_STEPS:
        _solve(feed, residual, solution)
        if len(feed.common):
            _neutralise(feed, charge, own, solution)
        square = _dot(residual, solution)
        if not square > 0.0:
            break
        beside = np.sqrt(square)
        solution /= beside
        _charge(rest, cells, rises, solution, product)
        squared[steps], diagonal[steps] = square, _dot(solution, product)
        for k in range(m):
            w_before, w[k] = w[k], residual[k] / beside
            residual[k] = product[k] - diagonal[steps] * w[k] - beside * w_before
        steps += 1
        before, now = now, _admittance(feed, capacitance, farthest, diagonal, squared, steps)
        change = _difference(before, now)
        if steps >= FEWEST_STEPS and change <= rtol and change_before <= rtol:
            break
        change_before = change
    if steps == 0:
        Y[:] = feed.conductance + s * capacitance
        return
    fractions = continued_fractions(s, diagonal, squared, steps)
    for k in range(len(s)):
        at_once = feed.conductance + s[k] * capacitance
        Y[k] = at_once - s[k] * s[k] * squared[0] * fractions[k]


@compiled(fastmath={"reassoc"})
def _charge(
    rest: Rest, cells: NDArray, rises: NDArray, v: NDArray, charge: NDArray
) -> None:  # pragma: no cover
    """charge = M v in C."""
    terminals, m = rest.rows.shape
    for k in range(terminals, m):
        charge[k] = rest.diagonal[k - terminals] * v[k]
    for row in range(terminals):
        charge[row] = _dot(rest.rows[row], v)
        for k in range(terminals, m):
            charge[k] += rest.rows[row, k] * v[row]
    for k in range(len(cells)):
        factor = rest.factors[cells[k]]
        for row in range(len(factor)):
            part = rises[k] * _dot(factor[row], v)
            for column in range(m):
                charge[column] += part * factor[row, column]


@compiled(fastmath={"reassoc"})
def _dot(u: NDArray, v: NDArray) -> float:  # pragma: no cover
    total = 0.0
    for k in range(len(u)):
        total += u[k] * v[k]
    return total


@compiled()
def _neutralise(feed: Feed, charge: NDArray, own: float, v: NDArray) -> None:  # pragma: no cover
    """Shift a floating sheet so that it keeps its charge; own: its capacitance, F."""
    shift = _dot(charge, v) / own
    for k in range(len(feed.driven)):
        v[k] -= shift * feed.common[0, k]


@compiled()
def _solve(feed: Feed, y: NDArray, solution: NDArray) -> None:  # pragma: no cover
    """K^-1 y: 1 in the basis, and floating terminals by the conductance between them."""
    terminals = len(feed.driven)
    solution[:] = y
    solution[:terminals] = 0.0
    for row in range(len(feed.tied)):
        potential = 0.0
        for column in range(len(feed.tied)):
            current = _dot(feed.tied[column], y[:terminals])
            potential += feed.tied_inverse[row, column] * current
        for k in range(terminals):
            solution[k] += potential * feed.tied[row, k]


@compiled()
def _difference(Y: complex, other: complex) -> float:  # pragma: no cover
    """Of Rs and of Cp, relative to the other's."""
    Rs = abs((1.0 / Y).real / (1.0 / other).real - 1.0)
    return max(Rs, abs(Y.imag - other.imag) / max(abs(other.imag), LOST_SUSCEPTANCE * abs(other)))


@compiled()
def _admittance(
    feed: Feed, capacitance: float, s: complex, diagonal: NDArray, squared: NDArray, steps: int
) -> complex:  # pragma: no cover
    at_once = feed.conductance + s * capacitance
    if steps == 0:
        return at_once
    return at_once - s * s * squared[0] * continued_fraction(s, diagonal, squared, steps)
