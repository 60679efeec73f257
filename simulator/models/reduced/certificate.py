"""Certificates: bounds on the errors of Rs and Cp of a reduced skin, from its residual.

With the residual r = (K + s M) u of the reduced potentials u of an excitation, |Q - Q_r| <= sqrt(2)
r*(K + omega M)^-1 r, which is of second order. K^-1 in place of the inverse gives an upper bound.
K^-1 of the scene's own skin, over the least factor on its conductance, gives another. Interfaces
are sums of excitations, and bounds add.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...arrays import Complex, Real
from ...fem.circuit import Circuit
from ...fem.error_estimate import certified
from ...fem.galerkin import Galerkin
from ...fem.terminals import excited_terminals
from ...press.batch import NOTHING
from ...press.parts import parts_of
from ...scene.air_nodes import air_factor
from ...scene.frequency import LOSSLESS, laplace_variable
from ...scene.parts import Skin
from ...sweeps import InputError
from ..heterogeneous.materials import gauged
from ..parameters import foam_parts
from ..small_system.system import added, networks_in_air, solved, with_terms, without_common
from .cases import Case, by_skin
from .family import Family, Weights, changes
from .family_meshes import weights_of_case
from .projection import Projection


def certificates(
    reduced: Projection,
    weights: Weights,
    foams: Sequence[Real],
    solved: tuple[Complex, Complex],
    s: Complex,
    more_in_air: Complex | None = None,
) -> Real:
    """Bounds on the relative errors of Rs and Cp by the reduction.

    Shape (2, press, interface, s). weights: of the terms of K of one skin. foams: factors of each
    press on it, as the family's `mass` takes them. solved: potentials in the model's coordinates,
    V, shape (N + n, press * excitation * s), and Q, S, shape (press, excitation, s). s: rad/s.
    more_in_air: factor on M in air at each s less 1, where air lacks a loss of the foam.
    """
    family, skin, (u, Q) = reduced.family, reduced.parts.skin, solved
    space, combination = family.space, reduced.circuit.combination
    potential = reduced.coordinates @ np.hstack([u.real, u.imag])
    current, each = family.currents(weights, potential), np.tile(s, Q.size // len(s))
    charge = _charges(family, foams, potential)
    if more_in_air is not None:
        beyond = _charges(family, [of_air(skin, foam) for foam in foams], potential)
        charge += _times(np.tile(more_in_air, Q.size // len(s)), beyond)
    parts = foam_parts(skin) if gauged(skin) else 1
    least = min_conductance_factor(weights, reduced.circuit, reduced.modes, parts)
    power = residual_power(space, current, charge, each).reshape(Q.shape) / least
    if combination.one_to_one:
        return certified(Q, power)
    Y, error = combination.admittance(np.moveaxis(Q, 1, 0)), combination.bound(power.swapaxes(0, 1))
    return certified(np.asarray(Y, dtype=np.complex128).swapaxes(0, 1), error.swapaxes(0, 1))


def of_air(skin: Skin, foam: Real) -> Real:
    """Amounts of the parts in air alone, 0 for all others. foam: see `certificates`."""
    alone, which = np.zeros(len(foam)), np.flatnonzero(parts_of(skin).in_air)
    alone[which] = foam[which]
    return alone


def _charges(family: Family, foams: Sequence[Real], potential: Real) -> Real:
    """M of each press times the potentials of that press, at the inner unknowns, C."""
    own = potential.reshape(len(potential), 2, len(foams), -1)
    each = [
        family.mass_inside(foam) @ own[:, :, k].reshape(len(own), -1)
        for k, foam in enumerate(foams)
    ]
    found = np.stack([charge.reshape(len(own), 2, -1) for charge in each], axis=2)
    return found.reshape(potential.shape)[: family.space.inner]


def residual_power(space: Galerkin, current: Real, charge: Real, s: Complex) -> Real:
    """Power r*K^-1 r of the residual r = K u + s M u, W, shape (s,).

    current, charge: K u and M u at the inner unknowns, real parts before imaginary ones, shape
    (inner, 2 s).
    """
    residual = current + _times(s, charge)
    return (residual * space.solve(residual)).sum(axis=0).reshape(2, -1).sum(axis=0)


def _times(factor: Complex, parts: Real) -> Real:
    """Factor of each column times complex values, real parts before imaginary ones."""
    real, imag = np.split(parts, 2, axis=1)
    return np.hstack(
        [factor.real * real - factor.imag * imag, factor.real * imag + factor.imag * real]
    )


def min_conductance_factor(
    weights: Weights, circuit: Circuit, modes_of_sheet: int, parts: int
) -> float:
    """Lower bound of the factor on K anywhere. Raises InputError unless it is above zero.

    parts: number of parts that each term of a sheet is split into.
    """
    if weights is None:
        return 1.0
    count = circuit.fields * modes_of_sheet * parts
    modes = weights[:count].reshape(circuit.fields, modes_of_sheet, -1)
    films = weights[count:]
    least = min([*(modes[:, 0] - np.abs(modes[:, 1:]).sum(axis=1)).ravel(), *films])
    if not least > 0:
        raise InputError(f"conductance must stay above zero everywhere, got {least:g} of nominal")
    return float(least)


def largest_bounds(reduced: Projection, cases: Sequence[Case], frequency: Real) -> Real:
    """Largest bound on the relative errors of Rs and Cp in each case, shape (case,).

    The errors are those of Galerkin's method in the basis, with M of the case as it is. frequency:
    Hz.
    """
    found = np.empty(len(cases))
    for group in by_skin(cases, reduced.parts.skin):
        skin = SkinInBasis(reduced, cases[group[0]], frequency)
        found[group] = skin.bounds([cases[k] for k in group]).max(axis=(0, 2, 3))
    return found


class SkinInBasis:
    """Galerkin's method for one skin, in the basis as it is: for few presses on each skin.

    `ReducedSkin` turns the basis so that a press costs less; that costs as much as many presses.
    """

    def __init__(self, reduced: Projection, case: Case, frequency: Real) -> None:
        """case: a press on the skin. frequency: Hz."""
        family, N = reduced.family, len(reduced.conductance)
        self._reduced, self._frequency = reduced, frequency
        self._loss = (case.variation or family.skin.foam).loss
        self._weights = weights_of_case(family, case)
        change = changes(self._weights, family.skin, family.circuit, family.modes)
        K = with_terms(reduced.conductance, reduced.stiffness, *change)
        self._K, coupling = K[N:, N:], K[N:, :N]
        self._lift = -np.linalg.solve(self._K, coupling)
        between = without_common(K[:N, :N] + coupling.T @ self._lift, reduced.terminal_field)
        self._excited = [
            excited_terminals(drive, reduced.terminal_field, between, np.eye(N))
            for drive in reduced.circuit.excitations
        ]
        unpressed = family.amounts(replace(case, cells=NOTHING.cells, rises=NOTHING.rises))
        self._amounts = unpressed[: family.parts.count]
        self._unpressed = self._mass(self._amounts), self._mass(of_air(family.skin, self._amounts))

    def bounds(self, cases: Sequence[Case]) -> Real:
        """Bounds on the relative errors of Rs and Cp, shape (2, case, interface, s)."""
        N, omega = len(self._excited[0].potential), 2 * np.pi * self._frequency
        foams = [self._reduced.family.amounts(case) for case in cases]
        s = laplace_variable(self._frequency, self._loss)
        masses = ((self._lifted(M), self._lifted(air)) for M, air in map(self._masses, foams))
        press = networks_in_air(masses, N, s, omega, self._K)
        u, Q = (np.stack(each, axis=1) for each in zip(*solved(self._excited, press), strict=True))
        u[..., N:] += u[..., :N] @ self._lift.T
        lossy = self._loss != LOSSLESS and bool(parts_of(self._reduced.parts.skin).in_air.any())
        more = air_factor(self._frequency, self._loss) - 1 if lossy else None
        given = (u.reshape(-1, u.shape[-1]).T, Q), s, more
        return certificates(self._reduced, self._weights, foams, *given)

    def _masses(self, foam: Real) -> tuple[Real, Real]:
        """M of a press and its part in air, F."""
        family, change = self._reduced.family, foam[: len(self._amounts)] - self._amounts
        M, air = self._unpressed
        M, air = M + self._mass(change), air + self._mass(of_air(family.skin, change))
        added_by_touches = family.added_inside(foam)
        if added_by_touches is not None:
            W = self._reduced.coordinates
            M += W.T @ (added_by_touches @ W)
        return M, air

    def _mass(self, amounts: Real) -> Real:
        """M of these amounts of the parts, F."""
        factors, fixed = self._reduced.factors, self._reduced.fixed
        which = np.flatnonzero(amounts[: len(factors)])
        M = added(factors, which, amounts[which])
        return M + np.tensordot(amounts[len(factors) :], fixed, axes=1) if len(fixed) else M

    def _lifted(self, M: Real) -> Real:
        """M with the potentials of this skin at 1 V of each terminal for coordinates of those."""
        N = len(self._lift.T)
        found, at_terminals = M.copy(), M[:, :N] + M[:, N:] @ self._lift
        found[N:, :N] = at_terminals[N:]
        found[:N, N:] = at_terminals[N:].T
        found[:N, :N] = at_terminals[:N] + self._lift.T @ at_terminals[N:]
        return found
