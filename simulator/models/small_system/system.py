"""Small dense system K + s M of a reduced skin: coordinates, excitations, and direct solutions.

A press is a network of the terminals: admittances between these, and potentials inside at 1 V of
each. Excitations follow from it; their floating terminals are eliminated.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

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

    conductance: Any
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
    conductance = without_common(K[:N, :N] + coupling.T @ lift, terminal_field)
    _, basis = eigh(M[N:, N:], K[N:, N:])
    turn = np.hstack([lifted, np.vstack([np.zeros((N, len(basis))), basis])])
    return conductance, turn.astype(np.float64)


def without_common(conductance: Real, terminal_field: Integer) -> Real:
    """Conductance whose rows and columns of one field add up to zero without rounding."""
    conductance = conductance.copy()
    for each in np.unique(terminal_field):
        first, *others = np.flatnonzero(terminal_field == each)
        conductance[first] = -conductance[others].sum(axis=0)
        conductance[:, first] = -conductance[:, others].sum(axis=1)
    return conductance


def of_one(excitation: DenseExcitation) -> DenseExcitation:
    """The excitation with a first axis (skin,), as that of one skin."""
    return DenseExcitation(*(np.asarray(each)[None] for each in excitation))


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


def mass_of(mass: UnpressedMass, cells: Integer, weights: Real) -> Real:
    """M of presses in F, shape (..., N + n, N + n).

    cells, weights: touched cells and the factors on their M, shape (..., touch).
    """
    terminals = len(mass.rows)
    M = np.diag(np.concatenate([np.zeros(terminals), mass.diagonal]))
    M[:terminals] = mass.rows
    M[:, :terminals] = mass.rows.T
    return M + added(mass.factors, cells, weights)


def added(factors: Real, cells: Integer, weights: Real) -> Real:
    """Terms that cells add to M, F, see `mass_of`."""
    count, rank, m = cells.shape[-1], *factors.shape[1:]
    U = factors[cells].reshape(*cells.shape[:-1], count * rank, m)
    return (U.swapaxes(-1, -2) * np.repeat(weights, rank, axis=-1)[..., None, :]) @ U


MANY = 2
"""If the touches' factors have more rows than the basis size over this, M is diagonalised
instead."""
Solved = tuple[Complex, Complex]


class Networks(NamedTuple):
    """Presses as networks of their terminals.

    Y: between terminals, beyond that at zero frequency, S, shape (press, s, N, N). inside:
    potentials at 1 V of each terminal, shape (press, s, n, N). axes: axes that these are in, shape
    (press, n, n), unless they are those of the basis.
    """

    Y: Complex
    inside: Complex
    axes: Real | None = None


def networks(mass: UnpressedMass, cells: Integer, weights: Real, s: Complex) -> Networks:
    """Networks of presses with equally many touches. s: rad/s.

    cells, weights: touched cells and the factors on their M, shape (press, touch). Few factors
    change the unpressed network by Woodbury's formula; for more of them M is diagonalised.
    """
    (_, rank, m), N, each = mass.factors.shape, len(mass.rows), s[:, None, None]
    size = cells.shape[1] * rank
    if MANY * size > len(mass.diagonal):
        return diagonalised(mass_of(mass, cells, weights), N, s)
    own, same = cells, np.arange(len(cells))
    if len(cells) > 1:
        own, same = np.unique(cells, axis=0, return_inverse=True)
        same = same.ravel()
    F, rows = mass.factors[own].reshape(len(own), 1, size, m), mass.rows
    P = 1 / (1 + s[:, None] * mass.diagonal)
    damped, C = F[..., N:] * P[:, None], np.repeat(weights, rank, axis=1)[:, None, None]
    unpressed = -each * (P[:, :, None] * rows[:, N:].T)
    E = (F[..., :N] - each * (damped @ rows[:, N:].T))[same]
    system = (each * (damped @ F[..., N:].swapaxes(2, 3)))[same] * C
    system[..., range(size), range(size)] += 1.0
    charge = C.swapaxes(2, 3) * np.linalg.solve(system, E)
    added = (each * P[:, :, None]) * _times(F[same, 0, :, N:].swapaxes(1, 2), charge)
    Y = each * (rows[:, :N] + rows[:, N:] @ unpressed + E.swapaxes(2, 3) @ charge)
    return Networks(Y, unpressed - added)


def _times(real: Real, values: Complex) -> Complex:
    """Real matrices (press, a, b) times complex ones (press, s, b, N), without complex products."""
    press, s, b, N = values.shape
    columns = np.ascontiguousarray(values.transpose(0, 2, 1, 3)).reshape(press, b, s * N)
    found = (real @ columns.view(np.float64)).view(np.complex128)
    return found.reshape(press, -1, s, N).transpose(0, 2, 1, 3)


def diagonalised(masses: Real, terminals: int, s: Complex) -> Networks:
    """Networks of presses with these M, F, shape (press, N + n, N + n). s: rad/s."""
    N, each = terminals, s[:, None, None]
    diagonal, axes = np.linalg.eigh(masses[:, N:, N:])
    coupling = axes.swapaxes(1, 2) @ masses[:, N:, :N]
    P = 1 / (1 + s[:, None] * diagonal[:, None])
    inside = -each * (P[..., None] * coupling[:, None])
    Y = each * (masses[:, None, :N, :N] + coupling[:, None].swapaxes(2, 3) @ inside)
    return Networks(Y, inside, axes)


def networks_in_air(
    masses: Iterable[tuple[Real, Real]],
    terminals: int,
    s: Complex,
    omega: Real,
    inside_K: Real | None = None,
) -> Networks:
    """Networks where a part of M is in air and lacks the foam's loss: K + s M + (j omega - s) M'.

    masses: M and its part M' in air of each press, F, shape (N + n, N + n). omega: rad/s. inside_K:
    K in the other coordinates than terminals, which it does not couple to these, S, shape (n, n);
    None for 1. There is one factorization for each s.
    """
    N, found = terminals, []
    for M, air in masses:
        C = s[:, None, None] * M + (1j * omega - s)[:, None, None] * air
        K = np.eye(len(M) - N) if inside_K is None else inside_K
        inside = -np.linalg.solve(K + C[:, N:, N:], C[:, N:, :N])
        found.append((C[:, :N, :N] + C[:, :N, N:] @ inside, inside))
    Y, inside = zip(*found, strict=True)
    return Networks(np.stack(Y), np.stack(inside))


def at_terminals(excited: ExcitedTerminals, Y: Complex) -> tuple[Complex, Complex]:
    """Potentials of the terminals under an excitation, V, (press, s, N), and its Y in S.

    Y: between terminals, see `Networks`.
    """
    driven, F = excited.potential, excited.floating
    own, charge = excited.floating_conductance + F.T @ Y @ F, -((Y @ driven) @ F)
    u = driven + np.linalg.solve(own, charge[..., None])[..., 0] @ F.T
    return u, excited.conductance + (Y @ u[..., None])[..., 0] @ driven


def solved(excitations: Sequence[ExcitedTerminals], press: Networks) -> list[Solved]:
    """Potentials of each excitation in V, shape (press, s, N + n), and its Y in S, (press, s)."""
    each = []
    for excited in excitations:
        u, Y = at_terminals(excited, press.Y)
        inside = np.einsum("pfnk,pfk->pfn", press.inside, u)
        if press.axes is not None:
            inside = inside @ press.axes.swapaxes(1, 2)
        each.append((np.concatenate([u, inside], axis=2), Y))
    return each
