"""Small dense systems of a reduced skin: its own coordinates, what drives it, its potentials."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from ...fem.driven import Driven
from ...fem.lanczos import Pencil


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


REGISTER = 8
"""Numbers that processors take at once, or a multiple of that."""


def aligned(rest: Rest) -> Rest:
    """The same with coordinates that stay 0, so that loops over them end with whole registers."""
    beside = -rest.rows.shape[1] % REGISTER
    return Rest(*(widened(each, each.shape[-1] + beside) for each in rest))


def widened(values: NDArray[np.float64], width: int) -> NDArray[np.float64]:
    """The same with zeros up to a width along the last axis; `numpy.pad` takes longer."""
    wide = np.zeros((*values.shape[:-1], width))
    wide[..., : values.shape[-1]] = values
    return wide


def with_terms(
    conductance: NDArray[np.float64],
    terms: NDArray[np.float64],
    which: NDArray[np.intp],
    weights: NDArray[np.float64],
) -> NDArray[np.float64]:
    """K in S of the scene's own skin, 1 in its basis, and so much of some terms, (term, m, m)."""
    terminals, m = len(conductance), terms.shape[-1]
    K = np.eye(m)
    K[:terminals, :terminals] = conductance
    return K + np.tensordot(weights, terms[which], axes=1) if which.size else K


def own_coordinates(
    K: NDArray[np.float64], M: NDArray[np.float64], terminal_field: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Conductance between terminals, S, and the turn to where K is 1 and M diagonal."""
    N = len(terminal_field)
    coupling = K[N:, :N]
    lift = -np.linalg.solve(K[N:, N:], coupling)
    lifted = np.vstack([np.eye(N), lift])
    conductance = _without_common(K[:N, :N] + coupling.T @ lift, terminal_field)
    _, basis = eigh(M[N:, N:], K[N:, N:])
    turn = np.hstack([lifted, np.vstack([np.zeros((N, len(basis))), basis])])
    return conductance, turn.astype(np.float64)


def _without_common(
    conductance: NDArray[np.float64], terminal_field: NDArray[np.int64]
) -> NDArray[np.float64]:
    """The same, rows and columns of one field adding up to nothing without rounding."""
    conductance = conductance.copy()
    for each in np.unique(terminal_field):
        first, *others = np.flatnonzero(terminal_field == each)
        conductance[first] = -conductance[others].sum(axis=0)
        conductance[:, first] = -conductance[:, others].sum(axis=1)
    return conductance


MANY = 2
"""What touches see has more directions than the basis over this: M is turned to its own instead."""


def solved(
    drives: Sequence[Driven],
    rest: Rest,
    cells: NDArray[np.int64],
    weights: NDArray[np.float64],
    s: NDArray[np.complex128],
) -> list[tuple[NDArray[np.complex128], NDArray[np.complex128]]]:
    """Potentials of each drive at 1 V, shape (N + n, s), and Y in S.

    weights: rises of the cells' M. s: rad/s.
    """
    if MANY * len(cells) * rest.factors.shape[1] <= len(rest.diagonal):
        return [_by_touches(driven, rest, cells, weights, s) for driven in drives]
    N, M = len(rest.rows), mass_of(rest, cells, weights)
    diagonal, axes = eigh(M[N:, N:])
    pressed = Rest(np.hstack([M[:N, :N], M[:N, N:] @ axes]), diagonal, rest.factors)
    none = np.zeros(0, dtype=np.int64)
    found = [_by_touches(driven, pressed, none, np.zeros(0), s) for driven in drives]
    return [(np.vstack([u[:N], axes @ u[N:]]), Y) for u, Y in found]


def mass_of(
    rest: Rest, cells: NDArray[np.int64], weights: NDArray[np.float64]
) -> NDArray[np.float64]:
    """M of a press in F, as `written_out`, by one product of matrices."""
    none = np.zeros(0, dtype=np.int64)
    return written_out(rest, none, np.zeros(0)) + added(rest.factors, cells, weights)


def added(
    factors: NDArray[np.float64], cells: NDArray[np.int64], weights: NDArray[np.float64]
) -> NDArray[np.float64]:
    """What cells add to M, in F."""
    U = factors[cells].reshape(-1, factors.shape[2])
    return (U.T * np.repeat(weights, factors.shape[1])) @ U


def _by_touches(
    driven: Driven,
    rest: Rest,
    cells: NDArray[np.int64],
    weights: NDArray[np.float64],
    s: NDArray[np.complex128],
) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """K + s M is diagonal in the basis but for floating terminals f and what the cells' factors U
    see of it, z = U v: they are solved for, and v follows."""
    N, F = len(driven.potential), driven.floating
    U = rest.factors[cells].reshape(-1, rest.factors.shape[2])
    C = np.repeat(weights, rest.factors.shape[1])
    rows = rest.rows + (U[:, :N].T * C) @ U
    charge = driven.potential @ rows
    beside = np.vstack([F.T @ rows[:, N:], U[:, N:]])
    floats = F.shape[1]
    weighed = np.concatenate([np.ones(floats), C])
    P = 1 / (1 + s[:, None] * rest.diagonal)
    sign = np.repeat(np.stack([-(s**2), s], axis=1), [floats, len(C)], axis=1)
    seen = (beside * P[:, None]) @ beside.T
    own = np.zeros((len(s), len(weighed), len(weighed)), dtype=complex)
    own[:, :floats, :floats] = driven.floating_conductance
    own[:, :floats, :floats] += s[:, None, None] * (F.T @ rows[:, :N] @ F)
    own[:, range(floats, len(weighed)), range(floats, len(weighed))] = 1.0
    right = -sign * ((P * charge[N:]) @ beside.T)
    right[:, :floats] -= s[:, None] * (F.T @ charge[:N])
    found = np.linalg.solve(own + sign[:, :, None] * seen * weighed, right[:, :, None])[:, :, 0]
    v = -s[:, None] * P * (charge[N:] + (found * weighed) @ beside)
    at_terminals = driven.potential + found[:, :floats] @ F.T
    Y = driven.conductance + s * (at_terminals @ charge[:N] + v @ charge[N:])
    return np.hstack([at_terminals, v]).T, Y


def feed_of(driven: Driven) -> Feed:
    """A drive as the kernel takes it."""
    own = driven.floating_conductance[np.ix_(~driven.common, ~driven.common)]
    return Feed(
        conductance=driven.conductance,
        driven=np.ascontiguousarray(driven.potential),
        tied=np.ascontiguousarray(driven.floating[:, ~driven.common].T),
        tied_inverse=np.linalg.inv(own).astype(np.float64),
        common=np.ascontiguousarray(driven.floating[:, driven.common].T),
    )


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
        widened(each, len(mass)) for each in (feed.driven[None], feed.tied, feed.common)
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
