"""How the admittance of a reduced skin changes with its parameters, without any further solve.

K + s M is symmetric, so the problem is its own adjoint: dY = u'(dK + s dM) u with the potentials u
of 1 V, transposed and not conjugated; floating terminals carry no net current and add nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..skin import ReducedSkin


@dataclass(frozen=True)
class Sensitivity:
    """Y of each interface and its exact derivatives.

    Y: S, shape (interface, s). by_cell: S, to c of each pixel over the scene's own at rest, shape
    (interface, s, pixel). by_weight: S, to the weight of each term of K (see `family.weights_of`)
    and of terms beside them, shape (interface, s, term). by_s: F, to s, shape (interface, s).
    """

    Y: NDArray[np.complex128]
    by_cell: NDArray[np.complex128]
    by_weight: NDArray[np.complex128]
    by_s: NDArray[np.complex128]


def sensitivity(
    skin: ReducedSkin,
    cells: NDArray[np.int64],
    rises: NDArray[np.float64],
    s: NDArray[np.complex128],
    beside: NDArray[np.float64] | None = None,
) -> Sensitivity:
    """Of one press on one skin; cells, rises: as of `ReducedSkin.sweeps`. s: rad/s.

    beside: further terms of K, in the model's coordinates, S, shape (term, N + n, N + n).
    """
    own = skin.reduced.stiffness
    stiffness = own if beside is None else np.concatenate([own, beside])
    found = [
        _of_drive(skin.charges(cells, rises, u), stiffness, u, s, Y)
        for u, Y in skin.solved(cells, rises, s)
    ]
    return Sensitivity(*(np.stack(each) for each in zip(*found, strict=True)))


def _of_drive(
    charges: tuple[NDArray[np.complex128], NDArray[np.complex128]],
    stiffness: NDArray[np.float64],
    u: NDArray[np.complex128],
    s: NDArray[np.complex128],
    Y: NDArray[np.complex128],
) -> tuple[NDArray[np.complex128], ...]:
    by_cell, whole = charges
    by_weight = np.stack([((term @ u) * u).sum(axis=0) for term in stiffness], axis=1)
    return Y, s[:, None] * by_cell, by_weight, whole
