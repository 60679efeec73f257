"""Galerkin's method in one trial space: everything that does not depend on the press, and Y.

With the lift G (each terminal at 1 V in turn, the others at 0 V, no capacitance: K G = 0 inside)
the potentials are G U + d, and the deviation d solves (K + s M) d = -s M G U. The terminals'
admittance is then Y = G'KG + s G'MG - s² (MG)' (K + s M)^-1 (MG). This is the variational form: its
error is the square of the field's error, and it keeps all digits at low frequency. Under a foil
with contact resistance the unknown is lifted to the foil's potential first. A small resistance is
then a stiff film on a small deviation, and no small difference of large numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import overload

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import SuperLU

from ..arrays import Complex, Real
from .circuit import Circuit
from .factors import Bordered, Factors, LowRankMass, Mass, factorised, without_zeros
from .lanczos import Pencil, Pencils, Steps
from .system import Films, System
from .terminals import (
    Excitation,
    ExcitedTerminals,
    Network,
    Unshifted,
    excited_terminals,
    potentials,
    shifted,
    unshifted_pencils,
)


class Galerkin:
    """A system restricted to the trial functions of elements up to some order.

    K: of the inner unknowns, S, sparse. lift: shape (inner + terminals, terminals). conductance:
    between terminals at zero frequency, S. entries: indices of this space's entries in the system's
    pattern.
    """

    def __init__(self, system: System, circuit: Circuit, order: int) -> None:
        """order: that of the system, or a lower one from 2 on."""
        self.circuit, self.order = circuit, order
        self.terminal_field = np.array([terminal.field for terminal in circuit.terminals])
        terminals = len(self.terminal_field)
        inner = np.flatnonzero(system.unknowns.degree <= order)
        self.inner = len(inner)
        rows = np.concatenate([inner, system.unknowns.inner + np.arange(terminals)])
        self._system, self._rows = system, rows
        self._whole, self.entries = (
            system.pattern.within(rows)
            if len(inner) < system.unknowns.inner
            else (system.pattern, slice(None))
        )
        self._block, self._block_entries = self._whole.within(np.arange(self.inner))
        self.K = self._inner(self.restricted(system.stiffness))
        self.lift, self.conductance = self._terminal_lift()
        self._driven: dict[Excitation, ExcitedTerminals] = {}

    @overload
    def restricted(self, matrix: csc_matrix) -> csc_matrix: ...

    @overload
    def restricted(self, matrix: Mass) -> Mass: ...

    def restricted(self, matrix: Mass) -> Mass:
        """A matrix in the system's pattern, for the unknowns of this space and the terminals."""
        if isinstance(matrix, LowRankMass):
            return LowRankMass(self.restricted(matrix.near), self.own(matrix.far))
        return self.matrix(matrix.data[self.entries])

    def own(self, values: NDArray) -> NDArray:
        """Values of this space and the terminals, along the first axis, from those of the
        system."""
        return values[self._rows]

    def matrix(self, values: NDArray) -> csc_matrix:
        """Matrix of this space and the terminals from its values at `entries`."""
        return self._whole.matrix(values)

    def solve(self, y: Real) -> Real:
        """K^-1 y inside, all terminals at 0 V. y: A, shape (inner, ...)."""
        return self._factors.solve(y)

    def _inner(self, whole: csc_matrix) -> csc_matrix:
        return self._block.matrix(whole.data[self._block_entries])

    def network(self, mass: csc_matrix, s: Complex) -> Network:
        """N-terminal network at each s in rad/s: one complex system for each s. mass: M in F."""
        mass = self.restricted(mass)
        charge = mass @ self.lift
        at_once = self.lift.T @ charge
        inner_charge = charge[: self.inner]
        delayed = np.stack(
            [
                inner_charge.T @ self._shifted(each, mass).solve(inner_charge.astype(complex))
                for each in s
            ]
        )
        s = s[:, None, None]
        return Network(self.terminal_field, self.conductance, s * at_once - s**2 * delayed)

    def moments(self, mass: csc_matrix, count: int) -> Real:
        """Taylor coefficients of Y(s) = Y_0 + Y_1 s + ... + Y_count s^count, shape (k, N, N).

        One real factorisation: Y_1 = G'MG, Y_k = (-1)^(k-1) (MG)' (K^-1 M)^(k-2) K^-1 (MG).
        """
        mass = self.restricted(mass)
        inner_mass = self._inner(mass)
        charge = mass @ self.lift
        right = inner_charge = charge[: self.inner]
        moments: list[Real] = [self.conductance, self.lift.T @ charge]
        for k in range(2, count + 1):
            solution = self._factor.solve(right)
            moments.append((-1) ** (k - 1) * inner_charge.T @ solution)
            right = inner_mass @ solution
        return np.array(moments)

    def pencil(self, mass: Mass, excitation: Excitation, shift: float) -> Pencil:
        """K + s M of one excitation, its floating terminals among the unknowns. shift: sigma in
        1/s."""
        mass, driven = self.restricted(mass), self.driven(excitation)
        if shift == 0:
            return Unshifted(driven, mass).pencil(self._factor)
        return shifted(driven, mass, self._shifted(shift, mass), shift, self._power)

    def pencils(self, masses: Sequence[Mass], excitations: Sequence[Excitation]) -> Pencils:
        """K + s M of each excitation with each M, of this space in F; those of one M are
        adjacent."""
        each = [
            Unshifted(self.driven(excitation), mass)
            for mass in masses
            for excitation in excitations
        ]
        return unshifted_pencils(each, self.solve, self.inner)

    def potentials(self, mass: Mass, excitation: Excitation, s: complex) -> NDArray:
        """Potentials for 1 V between high and low at s in rad/s, real or complex; V.

        For all unknowns of the system, 0 where this space has none. mass: M in F.
        """
        mass = self.restricted(mass)
        return self.spread(potentials(self.driven(excitation), mass, self._shifted(s, mass), s))

    def form(self, mass: Mass, excitation: Excitation, s: complex) -> complex:
        """Q in S of an excitation at s in rad/s, real or complex. mass: M in F, real or complex."""
        driven, u = self.driven(excitation), self.own(self.potentials(mass, excitation, s))
        charge = self.restricted(mass) @ driven.potential
        return complex(driven.conductance + s * (charge @ u))

    def potentials_by(self, steps: Steps, mass: Mass, excitation: Excitation, s: Real) -> Real:
        """Potentials at real s >= 0 from the Lanczos steps of a sweep; shape (..., s)."""
        at_zero = Unshifted(self.driven(excitation), self.restricted(mass)).potential
        return self.spread(at_zero[:, None] + steps.potentials(s))

    def spread(self, u: NDArray) -> NDArray:
        """Values of this space, along the first axis, among those of the whole system; 0
        elsewhere."""
        whole = np.zeros((self._system.pattern.size, *u.shape[1:]), dtype=u.dtype)
        whole[self._rows] = u
        return whole

    def currents(self, u: NDArray, sheets: csc_matrix, films: Films) -> NDArray:
        """K u in A of inner unknowns. u: V, shape (inner + terminals, k). sheets: of this space."""
        in_sheets = (sheets @ u)[: self.inner]
        if not films.any:
            return in_sheets
        U = u[self.inner :]
        V = u - self._system.unknowns.at_foils[self._rows] @ U
        in_films = self.restricted(films.stiffness) @ V + films.current[self._rows] @ U
        return in_sheets + in_films[: self.inner]

    def sheet_energy(self, W: Real, sheets: csc_matrix) -> Real:
        """W'KW in W of the sheets alone. W: V, shape (inner + terminals, k). sheets: of the
        system."""
        return W.T @ (self.restricted(sheets) @ W)

    def film_energy(self, W: Real, films: Films) -> Real:
        """W'KW in W of the films of contact resistance alone."""
        U = W[self.inner :]
        current = films.current[self._rows] @ U
        V = W - self._system.unknowns.at_foils[self._rows] @ U
        coupled = V.T @ current
        in_films = V.T @ (self.restricted(films.stiffness) @ V)
        return in_films + coupled + coupled.T + U.T @ (films.conductance @ U)

    def _power(self, v: Real) -> float:
        """v'Kv in W. v: V, shape (inner + terminals,)."""
        W, system = v[:, None], self._system
        in_films = self.film_energy(W, system.films)
        return (self.sheet_energy(W, system.sheets) + in_films).item()

    def driven(self, excitation: Excitation) -> ExcitedTerminals:
        """Driven potentials and floating terminals of one excitation."""
        if excitation not in self._driven:
            self._driven[excitation] = excited_terminals(
                excitation, self.terminal_field, self.conductance, self.lift
            )
        return self._driven[excitation]

    def _shifted(self, s: complex, mass: Mass) -> SuperLU | Bordered:
        """Factors of the inner block of K + s M. mass: of this space."""
        if isinstance(mass, LowRankMass):
            return Bordered(self._sparse_shifted(s, mass.near), mass.far[: self.inner], s)
        return self._sparse_shifted(s, mass)

    def _sparse_shifted(self, s: complex, mass: csc_matrix) -> SuperLU:
        return factorised(self._block.matrix(self.K.data + s * self._inner(mass).data))

    @cached_property
    def _factor(self) -> SuperLU:
        return factorised(without_zeros(self.K) if self._system.fields_decoupled else self.K)

    @cached_property
    def _factors(self) -> Factors:
        return Factors(self._factor)

    def _terminal_lift(self) -> tuple[Real, Real]:
        """G, shape (inner + terminals, terminals), and G'KG in S, shape (terminals, terminals).

        The columns of a field add up to 1 V, which costs no current; that gives the column of its
        first terminal.
        """
        system, terminals = self._system, len(self.terminal_field)
        first_of_field = [
            int(np.argmax(self.terminal_field == f)) for f in range(self.circuit.fields)
        ]
        separate = {*first_of_field, *self.circuit.conductors}
        others = np.array([k for k in range(terminals) if k not in separate], dtype=int)
        inner = np.zeros((self.inner, terminals))
        conductance = np.zeros((terminals, terminals))
        if others.size:
            at_foils, films = system.unknowns.at_foils[self._rows][:, others], system.films
            current = self.restricted(system.sheets) @ at_foils
            current += films.current[self._rows][:, others]
            deviation = -self._factor.solve(current[: self.inner])
            inner[:, others] = at_foils[: self.inner] + deviation
            conductance[np.ix_(others, others)] = (
                at_foils.T @ (self.restricted(system.sheets) @ at_foils)
                + films.conductance[np.ix_(others, others)]
                + current[: self.inner].T @ deviation
            )
        one = system.unknowns.one[self._rows[: self.inner]]
        inner[:, first_of_field] = one
        for field, first in enumerate(first_of_field if others.size else []):
            rest = others[self.terminal_field[others] == field]
            inner[:, first] -= inner[:, rest].sum(axis=1)
            conductance[first, rest] = -conductance[np.ix_(rest, rest)].sum(axis=0)
            conductance[rest, first] = conductance[first, rest]
            conductance[first, first] = -conductance[first, rest].sum()
        return np.vstack([inner, np.eye(terminals)]), conductance
