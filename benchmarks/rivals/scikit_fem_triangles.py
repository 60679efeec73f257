"""A plain script on scikit-fem's triangles of one size: one sparse solve a frequency."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.rivals.scikit_fem_script import laplacian, product
from scipy.sparse.linalg import spsolve
from skfem import Basis, ElementTriP1, ElementTriP2, MeshTri

ELEMENTS = {1: ElementTriP1, 2: ElementTriP2}

Places = Callable[[NDArray[np.float64]], NDArray]


def impedance(
    mesh: MeshTri,
    order: int,
    fed: Places,
    c: Places,
    resistance: float,
    frequencies: NDArray[np.float64],
) -> NDArray[np.complex128]:
    """Z in ohm, shape (frequency,). fed: whether an edge at x (2, ...) lies under the foils. c: at
    x, F/m². resistance: of both sheets together, ohm/sq."""
    basis = Basis(mesh, ELEMENTS[order](), intorder=2 * order)
    K = laplacian.assemble(basis) / resistance
    M = product.assemble(basis, c=c(np.asarray(basis.global_coordinates())))
    under = basis.get_dofs(mesh.facets_satisfying(fed, boundaries_only=True)).flatten()
    free = np.setdiff1d(np.arange(K.shape[0]), under)

    def admittance(s: complex) -> complex:
        A = (K + s * M).tocsr()
        u = np.ones(A.shape[0], dtype=complex)
        u[free] = spsolve(A[free][:, free].tocsc(), -A[free][:, under].sum(axis=1))
        return complex((A[under] @ u).sum())

    return 1 / np.array([admittance(2j * np.pi * f) for f in frequencies])
