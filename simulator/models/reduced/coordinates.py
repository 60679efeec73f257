"""The coordinates in which a reduced skin is diagonal."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh


def own_coordinates(
    K: NDArray[np.float64], M: NDArray[np.float64], terminal_field: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Conductance between terminals, S, and the turn to where K is 1 and M diagonal."""
    N = len(terminal_field)
    coupling = K[N:, :N]
    lift = -np.linalg.solve(K[N:, N:], coupling)
    lifted = np.vstack([np.eye(N), lift])
    conductance = _without_common(K[:N, :N] + coupling.T @ lift, terminal_field)
    _, basis = eigh(M[N:, N:], K[N:, N:])
    turn = np.hstack([lifted, np.vstack([np.zeros((N, len(basis))), basis])])
    return conductance, turn.astype(np.float64)


def _without_common(
    conductance: NDArray[np.float64], terminal_field: NDArray[np.int64]
) -> NDArray[np.float64]:
    """The same, rows and columns of one field adding up to nothing without rounding."""
    conductance = conductance.copy()
    for each in np.unique(terminal_field):
        first, *others = np.flatnonzero(terminal_field == each)
        conductance[first] = -conductance[others].sum(axis=0)
        conductance[:, first] = -conductance[:, others].sum(axis=1)
    return conductance
