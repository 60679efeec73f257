"""Certificates: bounds on the errors of Rs and Cp of a reduced skin, from its residual.

With the residual r = (K + s M) u of the reduced potentials u of an excitation, |Q - Q_r| <= sqrt(2)
r*(K + omega M)^-1 r, which is of second order. K^-1 in place of the inverse gives an upper bound.
K^-1 of the scene's own skin, over the least factor on its conductance, gives another. Interfaces
are sums of excitations, and bounds add.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...arrays import Complex, Real
from ...fem.circuit import Circuit
from ...fem.error_estimate import certified
from ...fem.factors import Mass
from ...fem.galerkin import Galerkin
from ...fem.terminals import Combination
from ...sweeps import InputError
from .families.family import Weights


class AirCharges(NamedTuple):
    """Share of air in M of each press in the space, F, and its factor at each s less 1."""

    masses: Sequence[Mass]
    more: Complex


def certificate(
    space: Galerkin,
    masses: Sequence[Mass],
    potential: Real,
    current: Real,
    Q: Complex,
    s: Complex,
    least: float,
    combination: Combination,
    in_air: AirCharges | None = None,
) -> Real:
    """Bounds on the relative errors of Rs and Cp by the reduction.

    Shape (2, press, interface, s). masses: M of each press in the space, F. potential: potentials
    of each excitation in the full space, real parts before imaginary ones, V, shape (unknown, 2 *
    press * excitation * s). current: K of the skin times these potentials at the inner unknowns, A.
    Q: S, shape (press, excitation, s). s: rad/s. least: see `min_conductance_factor`. in_air: where
    air lacks the loss of s.
    """
    charge = _charges(masses, potential)[: space.inner]
    if in_air is not None:
        beyond = _charges(in_air.masses, potential)[: space.inner]
        charge += _times(np.tile(in_air.more, Q.size // len(s)), beyond)
    power = residual_power(space, current, charge, np.tile(s, Q.size // len(s)))
    power = power.reshape(Q.shape) / least
    if combination.one_to_one:
        return certified(Q, power)
    Y, error = combination.admittance(np.moveaxis(Q, 1, 0)), combination.bound(power.swapaxes(0, 1))
    return certified(np.asarray(Y, dtype=np.complex128).swapaxes(0, 1), error.swapaxes(0, 1))


def _charges(masses: Sequence[Mass], potential: Real) -> Real:
    """M of each press times the potentials of that press, C."""
    own = potential.reshape(len(potential), 2, len(masses), -1)
    each = [mass @ own[:, :, k].reshape(len(own), -1) for k, mass in enumerate(masses)]
    return np.stack([found.reshape(len(own), 2, -1) for found in each], axis=2).reshape(
        potential.shape
    )


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
