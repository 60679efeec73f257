"""A bound on what a reduced skin leaves out of Rs and Cp: from the residual, of second order.

With r = (K + s M) u of the reduced potentials u at 1 V, |Y - Y_r| <= sqrt(2) r*(K + omega M)^-1 r,
of which K^-1 in place of the inverse is an upper bound, and K of the scene's own skin over the
least factor on its conductance another.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from simulator.family import weights_of
from simulator.sweeps import InputError

if TYPE_CHECKING:
    from simulator.reduced import ReducedSkin


def certificate(
    skin: ReducedSkin,
    cells: NDArray[np.int64],
    rises: NDArray[np.float64],
    s: NDArray[np.complex128],
) -> NDArray[np.float64]:
    """Bound on the relative errors of Rs and Cp, shape (2, interface, s); of the reduction alone.

    cells, rises: of one press, as in `ReducedSkin.sweeps`. s: rad/s.
    """
    family, W = skin.reduced.family, skin.reduced.coordinates
    space = family.space
    mass = space.restricted(family.mass(skin.map_of(cells, rises)))
    system = family.system if skin.variation is None else family.varied(skin.variation)
    least = least_conductance(skin)
    bounds = []
    for reduced, Y in skin.solved(cells, rises, s):
        u = W @ reduced
        current = space.currents(u, system.sheets, system.films)
        residual = current + s * (mass @ u)[: space.inner]
        power = sum((part * space.solve(part)).sum(axis=0) for part in _parts(residual))
        bounds.append(relative_bound(Y, np.sqrt(2) * power / least))
    return np.stack(bounds, axis=1)


def least_conductance(skin: ReducedSkin) -> float:
    """A lower bound of the factor on K anywhere. Raises InputError where it is not above zero."""
    if skin.variation is None:
        return 1.0
    reduced = skin.reduced
    weights = weights_of(skin.variation, reduced.scene, reduced.circuit)
    count = reduced.circuit.fields * reduced.modes
    modes, films = weights[:count].reshape(-1, reduced.modes), weights[count:]
    least = min([*(modes[:, 0] - np.abs(modes[:, 1:]).sum(axis=1)), *films])
    if not least > 0:
        raise InputError(f"conductance must stay above zero everywhere, got {least:g} of nominal")
    return float(least)


def _parts(residual: NDArray[np.complex128]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return np.ascontiguousarray(residual.real), np.ascontiguousarray(residual.imag)


def relative_bound(Y: NDArray[np.complex128], error: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of Rs and Cp, shape (2, s), from a bound on |Y| - inf where that says nothing."""
    size = np.abs(Y)
    Z_error = np.divide(
        error, size * (size - error), out=np.full(size.shape, np.inf), where=size > error
    )
    return np.stack([Z_error / (1 / Y).real, error / np.abs(Y.imag)])
