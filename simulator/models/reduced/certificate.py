"""A bound on what a reduced skin leaves out of Rs and Cp: from the residual, of second order.

With r = (K + s M) u of the reduced potentials u at 1 V, |Y - Y_r| <= sqrt(2) r*(K + omega M)^-1 r,
of which K^-1 in place of the inverse is an upper bound, and K of the scene's own skin over the
least factor on its conductance another.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from ...fem.circuit import Circuit
from ...fem.estimate import certified
from ...fem.galerkin import Galerkin
from ...fem.system import System
from ...sweeps import InputError
from .family import Weights


def certificate(
    space: Galerkin,
    system: System,
    mass: csc_matrix,
    solved: Iterable[tuple[NDArray[np.complex128], NDArray[np.complex128]]],
    s: NDArray[np.complex128],
    least: float,
) -> NDArray[np.float64]:
    """Bound on the relative errors of Rs and Cp, shape (2, interface, s); of the reduction alone.

    system, mass: K of the skin and M of the press, in F. solved: of each interface, potentials of 1
    V in the full space, shape (unknown, s), and Y in S. s: rad/s. least: as `least_conductance`.
    """
    mass = space.restricted(mass)
    bounds = []
    for u, Y in solved:
        current = space.currents(u, system.sheets, system.films)
        residual = current + s * (mass @ u)[: space.inner]
        power = np.sum(
            [(part * space.solve(part)).sum(axis=0) for part in _parts(residual)], axis=0
        )
        bounds.append(certified(Y, power / least))
    return np.stack(bounds, axis=1)


def least_conductance(weights: Weights, circuit: Circuit, modes_of_sheet: int, parts: int) -> float:
    """A lower bound of the factor on K anywhere. Raises InputError where it is not above zero.

    parts: of each term of a sheet.
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


def _parts(residual: NDArray[np.complex128]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return np.ascontiguousarray(residual.real), np.ascontiguousarray(residual.imag)
