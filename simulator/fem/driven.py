"""One drive of a skin: the driven potentials, and the floating terminals among the unknowns.

Floating terminals carry no current. Their potentials U_f join the inner unknowns through the lift F
of each: K F = 0 inside, so K falls apart into the conductance between them and the inner block.
Potentials that a whole sheet floats at cost no current at all; the sheet then keeps its charge,
which at zero frequency determines them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import SuperLU

from .circuit import Drive
from .lanczos import Pencil
from .network import allowed_potentials


@dataclass(frozen=True)
class Driven:
    """What drives and what floats, in the unknowns of a space: inner ones, then terminals.

    conductance: between high and low at zero frequency, S. potential: g in V, shape (unknown,), the
    floating terminals where they carry no direct current. floating: F, shape (unknown, floating).
    floating_conductance: in S, zero for those that are `common`: potentials of a whole sheet.
    """

    conductance: float
    potential: NDArray[np.float64]
    floating: NDArray[np.float64]
    floating_conductance: NDArray[np.float64]
    common: NDArray[np.bool_]


def driven_by(
    drive: Drive,
    terminal_field: NDArray[np.int64],
    conductance: NDArray[np.float64],
    lift: NDArray[np.float64],
) -> Driven:
    """What a drive drives. conductance: between terminals, S. lift: shape (unknown, terminal)."""
    modes, common = allowed_potentials(tuple(terminal_field.tolist()), drive)
    S = modes.T @ conductance @ modes
    S[common, :] = 0.0
    S[:, common] = 0.0
    tied = np.flatnonzero(~common[1:]) + 1
    driven, through = modes[:, 0], S[0, 0]
    if tied.size:
        follow = -np.linalg.solve(S[np.ix_(tied, tied)], S[tied, 0])
        driven, through = driven + modes[:, tied] @ follow, through + S[0, tied] @ follow
    return Driven(
        conductance=float(through),
        potential=lift @ driven,
        floating=lift @ modes[:, 1:],
        floating_conductance=S[1:, 1:],
        common=common[1:],
    )


def unshifted(driven: Driven, mass: csc_matrix, K: SuperLU) -> Pencil:
    """The pencil for sigma = 0. mass: M in F. K: factors of the inner block."""
    sheets, tied = driven.floating[:, driven.common], driven.floating[:, ~driven.common]
    tied_conductance = driven.floating_conductance[np.ix_(~driven.common, ~driven.common)]
    sheets_charge = mass @ sheets
    own_charge = sheets.T @ sheets_charge
    inner = K.shape[0]

    def neutral(v: NDArray[np.float64]) -> NDArray[np.float64]:
        if not sheets.size:
            return v
        return v - sheets @ np.linalg.solve(own_charge, sheets_charge.T @ v)

    def inverse(y: NDArray[np.float64]) -> NDArray[np.float64]:
        v = np.zeros_like(y)
        v[:inner] = K.solve(y[:inner])
        if tied.size:
            v += tied @ np.linalg.solve(tied_conductance, tied.T @ y)
        return neutral(v)

    potential = neutral(driven.potential)
    start = mass @ potential
    return Pencil(start, mass.dot, inverse, driven.conductance, float(potential @ start), 0.0)


def shifted(
    driven: Driven,
    mass: csc_matrix,
    A: SuperLU,
    shift: float,
    power: Callable[[NDArray[np.float64]], float],
) -> Pencil:
    """The pencil for sigma > 0, in 1/s. A: factors of the inner block of K + sigma M.

    mass: M in F. power: v'Kv in W of potentials v. The driven potentials are those of s = sigma.
    """
    inverse = _inverse(driven, mass, A, shift)
    potential = driven.potential - shift * inverse(mass @ driven.potential)
    start = mass @ potential
    capacitance = float(potential @ start)
    admittance = power(potential) + shift * capacitance
    return Pencil(start, mass.dot, inverse, admittance, capacitance, shift)


def potentials(driven: Driven, mass: csc_matrix, A: SuperLU, s: complex) -> NDArray:
    """V of all unknowns for 1 V between high and low, shape (unknown,).

    A: factors of the inner block of K + s M. s: rad/s, real or complex. mass: M in F.
    """
    charge = (mass @ driven.potential).astype(type(s))
    return driven.potential - s * _inverse(driven, mass, A, s)(charge)


def _inverse(
    driven: Driven, mass: csc_matrix, A: SuperLU, s: complex
) -> Callable[[NDArray], NDArray]:
    """y to (K + s M)^-1 y, the floating terminals among the unknowns, the driven ones at 0 V."""
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
