"""Small dense systems of a reduced skin: its coordinates, excitations and potentials."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from ...arrays import Complex, Integer, Real
from ...fem.terminals import ExcitedTerminals


class UnpressedMass(NamedTuple):
    """Unpressed M of a skin, and the factors of the terms that its cells add.

    The coordinates are terminals, then basis vectors. rows: rows of the terminals in M, F, shape
    (terminal, m). diagonal: M of the other coordinates, F, shape (n,). factors: F_k of each cell,
    M_k = F_k'F_k, shape (cell, rank, m).
    """

    rows: Real
    diagonal: Real
    factors: Real


class DenseExcitation(NamedTuple):
    """One excitation: potentials of terminals, V.

    conductance: at zero frequency, S. driven: shape (terminal,). tied: potentials of floating
    terminals, shape (floating, terminal). tied_inverse: inverse of their conductance, shape
    (floating, floating). common: potentials of conductors that float as a whole, such as a sheet,
    shape (floating, terminal).
    """

    conductance: float
    driven: Real
    tied: Real
    tied_inverse: Real
    common: Real


REGISTER = 8
"""Count of numbers that processors take at once, or a multiple of it."""


def aligned(unpressed: UnpressedMass) -> UnpressedMass:
    """Matrices padded with coordinates that stay 0, so that loops end with whole registers."""
    padding = -unpressed.rows.shape[1] % REGISTER
    return UnpressedMass(*(widened(each, each.shape[-1] + padding) for each in unpressed))


def widened(values: Real, width: int) -> Real:
    """Values padded with zeros to a width along the last axis; `numpy.pad` takes longer."""
    wide = np.zeros((*values.shape[:-1], width))
    wide[..., : values.shape[-1]] = values
    return wide


def with_terms(conductance: Real, terms: Real, which: NDArray[np.intp], weights: Real) -> Real:
    """K in S: that of the scene's own skin, 1 in its basis, plus weighted terms (term, m, m)."""
    terminals, m = len(conductance), terms.shape[-1]
    K = np.eye(m)
    K[:terminals, :terminals] = conductance
    return K + np.tensordot(weights, terms[which], axes=1) if which.size else K


def own_coordinates(K: Real, M: Real, terminal_field: Integer) -> tuple[Real, Real]:
    """Conductance between terminals, S, and `turn`, see `ReducedSkin`."""
    N = len(terminal_field)
    coupling = K[N:, :N]
    lift = -np.linalg.solve(K[N:, N:], coupling)
    lifted = np.vstack([np.eye(N), lift])
    conductance = _without_common(K[:N, :N] + coupling.T @ lift, terminal_field)
    _, basis = eigh(M[N:, N:], K[N:, N:])
    turn = np.hstack([lifted, np.vstack([np.zeros((N, len(basis))), basis])])
    return conductance, turn.astype(np.float64)


def _without_common(conductance: Real, terminal_field: Integer) -> Real:
    """Conductance whose rows and columns of one field add up to zero without rounding."""
    conductance = conductance.copy()
    for each in np.unique(terminal_field):
        first, *others = np.flatnonzero(terminal_field == each)
        conductance[first] = -conductance[others].sum(axis=0)
        conductance[:, first] = -conductance[:, others].sum(axis=1)
    return conductance


def dense_excitation(excited: ExcitedTerminals) -> DenseExcitation:
    """Excitation in the form that the kernel takes."""
    own = excited.floating_conductance[np.ix_(~excited.common, ~excited.common)]
    return DenseExcitation(
        conductance=excited.conductance,
        driven=np.ascontiguousarray(excited.potential),
        tied=np.ascontiguousarray(excited.floating[:, ~excited.common].T),
        tied_inverse=np.linalg.inv(own).astype(np.float64),
        common=np.ascontiguousarray(excited.floating[:, excited.common].T),
    )


MANY = 2
"""If the touches' factors have more rows than the basis size over this, M is diagonalised
instead."""
Solved = tuple[Complex, Complex]


def solved(
    excitations: Sequence[ExcitedTerminals],
    unpressed: UnpressedMass,
    cells: Integer,
    weights: Real,
    s: Complex,
) -> list[Solved]:
    """Potentials of each excitation at 1 V, and its Y in S.

    Shapes (press, s, N + n) and (press, s). cells: equally many for each press, shape (press,
    touch). weights: rises of their M. s: rad/s.
    """
    rank = cells.shape[1] * unpressed.factors.shape[1]
    U = unpressed.factors[cells].reshape(len(cells), rank, unpressed.factors.shape[2])
    C = np.repeat(weights, unpressed.factors.shape[1], axis=1)
    N = len(unpressed.rows)
    rows = unpressed.rows + (U[:, :, :N] * C[:, :, None]).transpose(0, 2, 1) @ U
    if MANY * rank <= len(unpressed.diagonal):
        P = (1 / (1 + s[:, None] * unpressed.diagonal))[None]
        woodbury = _woodbury_matrices(unpressed, cells, C, s[:, None] * P[0])
        return [
            _by_touches(excited, rows, P, U[:, :, N:], C, woodbury, s) for excited in excitations
        ]
    M = (U[:, :, N:] * C[:, :, None]).transpose(0, 2, 1) @ U[:, :, N:]
    M[:, range(M.shape[1]), range(M.shape[1])] += unpressed.diagonal
    diagonal, axes = np.linalg.eigh(M)
    P = 1 / (1 + s[:, None] * diagonal[:, None])
    turned = np.concatenate([rows[:, :, :N], rows[:, :, N:] @ axes], axis=2)
    nothing = U[:, :0, N:], C[:, :0], np.zeros((len(cells), len(s), 0, 0), dtype=complex)
    found = [_by_touches(excited, turned, P, *nothing, s) for excited in excitations]
    back = axes.transpose(0, 2, 1)
    return [(np.concatenate([u[:, :, :N], u[:, :, N:] @ back], axis=2), Y) for u, Y in found]


def solved_in_air(
    excitations: Sequence[ExcitedTerminals],
    masses: Iterable[tuple[Real, Real]],
    s: Complex,
    omega: Real,
) -> list[Solved]:
    """`solved` for K + s M of the foam + j omega M in air, by one factorization for each s.

    masses: M of each press, F, shape (N + n, N + n), and its share in air. omega: rad/s.
    """
    found: list[list[Solved]] = [[] for _ in excitations]
    for M, in_air in masses:
        C = s[:, None, None] * M + (1j * omega - s)[:, None, None] * in_air
        N = len(excitations[0].potential)
        inside = C[:, N:, N:]
        inside[:, range(len(M) - N), range(len(M) - N)] += 1.0
        lift = -np.linalg.solve(inside, C[:, N:, :N])
        Y = C[:, :N, :N] + C[:, :N, N:] @ lift
        for excited, each in zip(excitations, found, strict=True):
            driven, F = excited.potential, excited.floating
            floating = np.linalg.solve(
                excited.floating_conductance + F.T @ Y @ F, (-(Y @ driven) @ F)[..., None]
            )
            u = driven + floating[..., 0] @ F.T
            whole = np.concatenate([u, (lift @ u[..., None])[..., 0]], axis=1)
            each.append((whole, excited.conductance + (Y @ u[..., None])[..., 0] @ driven))
    return [tuple(map(np.stack, zip(*each, strict=True))) for each in found]  # pyright: ignore[reportReturnType]


def _woodbury_matrices(unpressed: UnpressedMass, cells: Integer, C: Real, sP: Complex) -> Complex:
    """Matrix 1 + U s P U' C of each press; presses that touch the same cells share the product.

    C: shape (press, rank). sP: shape (s, n). Shape (press, s, rank, rank).
    """
    own, same = cells, np.arange(len(cells))
    if len(cells) > 1:
        own, same = np.unique(cells, axis=0, return_inverse=True)
    U = unpressed.factors[own].reshape(len(own), -1, unpressed.factors.shape[2])[
        :, :, len(unpressed.rows) :
    ]
    count, rank, n = U.shape
    parts = np.stack([sP.real, sP.imag])
    rows = (parts[:, :, None] * U[:, None, None]).reshape(count, 2 * len(sP) * rank, n)
    products = (rows @ U.transpose(0, 2, 1)).reshape(count, 2, len(sP), rank, rank)
    woodbury = (products[:, 0] + 1j * products[:, 1])[same.ravel()]
    woodbury *= C[:, None, None]
    woodbury[:, :, range(rank), range(rank)] += 1.0
    return woodbury


def _by_touches(
    excited: ExcitedTerminals,
    rows: Real,
    P: Complex,
    U: Real,
    C: Real,
    woodbury: Complex,
    s: Complex,
) -> Solved:
    """Potentials and Y of one excitation by a small system for each press and s.

    K + s M is diagonal in the basis except for floating terminals f and the products z = U v with
    the cells' factors U. The small system gives f and z, from which v follows.

    rows: rows of the terminals in M, shape (press, N, N + n). P: 1 / (1 + s M) where M is diagonal,
    (press or 1, s, n). U, C: factors of cells there, (press, rank, n), and their weights, (press,
    rank). woodbury: see `_woodbury_matrices`.
    """
    N, F = len(excited.potential), excited.floating
    floats = F.shape[1]
    charge = excited.potential @ rows
    coupling_rows = np.concatenate([F.T @ rows[:, :, N:], U], axis=1)
    weighed = np.concatenate([np.ones((len(C), floats)), C], axis=1)
    sign = np.repeat(np.stack([-(s**2), s], axis=1), [floats, C.shape[1]], axis=1)
    system = (
        _with_floating(excited, rows, P, coupling_rows, weighed, woodbury, s)
        if floats
        else woodbury
    )
    right = -sign * ((P * charge[:, None, N:]) @ coupling_rows.transpose(0, 2, 1))
    right[:, :, :floats] -= s[:, None] * (charge[:, :N] @ F)[:, None]
    found = np.linalg.solve(system, right[..., None])[..., 0]
    v = -s[:, None] * P * (charge[:, None, N:] + (found * weighed[:, None]) @ coupling_rows)
    at_terminals = excited.potential + found[:, :, :floats] @ F.T
    u = np.concatenate([at_terminals, v], axis=2)
    return u, excited.conductance + s * (u @ charge[:, :, None])[:, :, 0]


def _with_floating(
    excited: ExcitedTerminals,
    rows: Real,
    P: Complex,
    coupling_rows: Real,
    weighed: Real,
    woodbury: Complex,
    s: Complex,
) -> Complex:
    """Matrix of the small system, with floating terminals before the cells' products."""
    F, N = excited.floating, len(excited.potential)
    floats, k = F.shape[1], coupling_rows.shape[1]
    system = np.empty((*woodbury.shape[:2], k, k), dtype=complex)
    system[:, :, floats:, floats:] = woodbury
    across = (coupling_rows[:, None, :floats] * P[:, :, None]) @ coupling_rows.transpose(0, 2, 1)[
        :, None
    ]
    system[:, :, :floats] = -(s[:, None, None] ** 2) * across * weighed[:, None, None]
    back = across[:, :, :, floats:].transpose(0, 1, 3, 2)
    system[:, :, floats:, :floats] = s[:, None, None] * back
    system[:, :, :floats, :floats] += excited.floating_conductance
    system[:, :, :floats, :floats] += s[:, None, None] * (F.T @ rows[:, :, :N] @ F)[:, None]
    return system


def mass_of(unpressed: UnpressedMass, cells: Integer, weights: Real) -> Real:
    """M of a press in F, shape (N + n, N + n)."""
    terminals = len(unpressed.rows)
    M = np.diag(np.concatenate([np.zeros(terminals), unpressed.diagonal]))
    M[:terminals] = unpressed.rows
    M[:, :terminals] = unpressed.rows.T
    return M + added(unpressed.factors, cells, weights)


def added(factors: Real, cells: Integer, weights: Real) -> Real:
    """Terms that cells add to M, F."""
    U = factors[cells].reshape(-1, factors.shape[2])
    return (U.T * np.repeat(weights, factors.shape[1])) @ U


def own_axes(M: Real, terminals: int) -> tuple[UnpressedMass, Real]:
    """M of a press in axes in which it is diagonal inside, and these axes, shape (n, n)."""
    N = terminals
    diagonal, axes = np.linalg.eigh(M[N:, N:])
    return UnpressedMass(
        np.hstack([M[:N, :N], M[:N, N:] @ axes]), diagonal, np.zeros((0, 0, len(M)))
    ), axes


def between_terminals(unpressed: UnpressedMass, s: Complex) -> Complex:
    """Y in S less that at zero frequency, shape (s, N, N). s: rad/s."""
    N = len(unpressed.rows)
    terminals, coupling_rows, each = unpressed.rows[:, :N], unpressed.rows[:, N:], s[:, None, None]
    P = 1 / (1 + s[:, None, None] * unpressed.diagonal)
    return each * terminals - each**2 * ((coupling_rows * P) @ coupling_rows.T)
