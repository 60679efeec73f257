"""One excitation of a skin: the driven potentials, and the floating terminals among the unknowns.

Floating terminals carry no net current. Their potentials U_f join the inner unknowns through the
lift F of each: K F = 0 inside, so K splits into the conductance between them and the inner block.
A potential of a whole floating sheet causes no current. The sheet keeps its charge, which
determines that potential at zero frequency.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import SuperLU

from ...arrays import Integer, Mask, Real
from ..lanczos.lanczos import Pencil, Pencils
from ..matrices.low_rank import Bordered, Mass
from .excitation import Excitation
from .terminal_network import allowed_potentials

Solve = Callable[[Real], Real]
"""Maps currents inside, shape (unknown, side), to potentials."""


@dataclass(frozen=True)
class ExcitedTerminals:
    """Driven and floating terminals, in the unknowns of a space: inner ones, then terminals.

    conductance: between high and low at zero frequency, S. potential: g in V, shape (unknown,); the
    floating terminals carry no direct current in it. floating: F, shape (unknown, floating).
    floating_conductance: S, zero for those that are `common`, the potentials of a whole sheet.
    """

    conductance: float
    potential: Real
    floating: Real
    floating_conductance: Real
    common: Mask


def excited_terminals(
    excitation: Excitation, terminal_field: Integer, conductance: Real, lift: Real
) -> ExcitedTerminals:
    """Driven potentials and floating terminals of one excitation.

    conductance: between terminals, S. lift: shape (unknown, terminal).
    """
    modes, common = allowed_potentials(tuple(terminal_field.tolist()), excitation)
    S = modes.T @ conductance @ modes
    S[common, :] = 0.0
    S[:, common] = 0.0
    tied = np.flatnonzero(~common[1:]) + 1
    driven, through = modes[:, 0], S[0, 0]
    if tied.size:
        follow = -np.linalg.solve(S[np.ix_(tied, tied)], S[tied, 0])
        driven, through = driven + modes[:, tied] @ follow, through + S[0, tied] @ follow
    return ExcitedTerminals(
        conductance=float(through),
        potential=lift @ driven,
        floating=lift @ modes[:, 1:],
        floating_conductance=S[1:, 1:],
        common=common[1:],
    )


@dataclass(frozen=True)
class Unshifted:
    """One excitation at sigma = 0 with one M, in F, of the space.

    K^-1 is that of the inner block, `completed` by the floating terminals.
    """

    driven: ExcitedTerminals
    mass: Mass

    @cached_property
    def potential(self) -> Real:
        """Driven potentials at s = 0, V."""
        return self._neutral(self.driven.potential)

    @cached_property
    def start(self) -> Real:
        """Charge of the driven potentials, C."""
        return self.mass @ self.potential

    def completed(self, y: Real, inside: Real) -> Real:
        """K^-1 y with the floating terminals among the unknowns. inside: K^-1 y of the inner
        block."""
        v = np.zeros_like(y)
        v[: len(inside)] = inside
        tied, conductance = self._tied
        if tied.size:
            v += tied @ np.linalg.solve(conductance, tied.T @ y)
        return self._neutral(v)

    def pencil(self, K: SuperLU) -> Pencil:
        """Pencil for Lanczos' method. K: factors of the inner block."""
        inner, start = K.shape[0], self.start
        return Pencil(
            start,
            self.mass.dot,
            lambda y: self.completed(y, K.solve(y[:inner])),
            self.driven.conductance,
            float(self.potential @ start),
            0.0,
        )

    def _neutral(self, v: Real) -> Real:
        sheets, charge, own = self._sheets
        return v - sheets @ np.linalg.solve(own, charge.T @ v) if sheets.size else v

    @cached_property
    def _tied(self) -> tuple[Real, Real]:
        """Potentials of floating terminals that currents tie to others, and the conductance between
        them."""
        tied = ~self.driven.common
        conductance = self.driven.floating_conductance[np.ix_(tied, tied)]
        return self.driven.floating[:, tied], conductance

    @cached_property
    def _sheets(self) -> tuple[Real, ...]:
        """Potentials of sheets that float as a whole, their charges, and the capacitance between
        them."""
        sheets = self.driven.floating[:, self.driven.common]
        charge = self.mass @ sheets
        return sheets, charge, sheets.T @ charge


def unshifted_pencils(each: Sequence[Unshifted], solve: Solve, inner: int) -> Pencils:
    """Pencils of one K for several excitations and M. solve: of the block of `inner` unknowns."""

    def mass(v: Real, which: Integer) -> Real:
        masses = [each[k].mass for k in which]
        first = [k for k, own in enumerate(masses) if k == 0 or own is not masses[k - 1]]
        parts = zip(first, np.split(v, first[1:]), strict=True)
        return np.concatenate([(masses[k] @ own.T).T for k, own in parts])

    def inverse(y: Real, which: Integer) -> Real:
        inside = solve(y[:, :inner].T).T
        parts = zip(which, y, inside, strict=True)
        return np.stack([each[k].completed(own, inner_part) for k, own, inner_part in parts])

    return Pencils(np.stack([one.start for one in each]), mass, inverse)


def shifted(
    driven: ExcitedTerminals,
    mass: Mass,
    A: SuperLU | Bordered,
    shift: float,
    power: Callable[[Real], float],
) -> Pencil:
    """Pencil for sigma > 0, in 1/s. A: factors of the inner block of K + sigma M.

    mass: M in F. power: v'Kv in W of potentials v. The driven potentials are those of s = sigma.
    """
    inverse = _inverse(driven, mass, A, shift)
    potential = driven.potential - shift * inverse(mass @ driven.potential)
    start = mass @ potential
    capacitance = float(potential @ start)
    admittance = power(potential) + shift * capacitance
    return Pencil(start, mass.dot, inverse, admittance, capacitance, shift)


def potentials(driven: ExcitedTerminals, mass: Mass, A: SuperLU | Bordered, s: complex) -> NDArray:
    """Potentials of all unknowns for 1 V between high and low, V, shape (unknown,).

    A: factors of the inner block of K + s M. s: rad/s, real or complex. mass: M in F.
    """
    charge = (mass @ driven.potential).astype(type(s))
    return driven.potential - s * _inverse(driven, mass, A, s)(charge)


def _inverse(
    driven: ExcitedTerminals, mass: Mass, A: SuperLU | Bordered, s: complex
) -> Callable[[NDArray], NDArray]:
    """Map from y to (K + s M)^-1 y with floating terminals as unknowns and driven ones at 0 V."""
    inner, floating = A.shape[0], driven.floating
    charge = s * np.asarray(mass @ floating)
    coupling = charge[:inner]
    followed = A.solve(coupling) if coupling.size else coupling
    own = driven.floating_conductance + floating.T @ charge - coupling.T @ followed

    def inverse(y: NDArray) -> NDArray:
        v = np.zeros_like(y)
        v[:inner] = A.solve(y[:inner])
        if floating.size:
            U = np.linalg.solve(own, floating.T @ y - coupling.T @ v[:inner])
            v[:inner] -= followed @ U
            v += floating @ U
        return v

    return inverse
