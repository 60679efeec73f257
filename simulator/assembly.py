"""Assembly into a sparsity pattern built once: the scatter map is kept, only values are filled.

Every element is an affine image of the reference element, so its matrix is a weighted sum of a few
reference matrices. The weights change with the capacitance map, the pattern never does.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.sparse import csc_matrix
from skfem import (
    BilinearForm,
    Element,
    ElementQuad1,
    ElementQuad2,
    ElementQuadP,
    Mesh,
    MeshQuad,
)
from skfem.assembly import Basis, FacetBasis
from skfem.assembly.basis import AbstractBasis

DROPPED = -1


@njit(cache=True)
def fill(
    values: NDArray, slots: NDArray, weights: NDArray, reference: NDArray
) -> None:  # pragma: no cover
    """values[slots[e, k]] += sum_m weights[e, m] reference[m, k], leaving out dropped slots."""
    for element in range(slots.shape[0]):
        for k in range(slots.shape[1]):
            slot = slots[element, k]
            if slot != DROPPED:
                total = 0.0
                for m in range(weights.shape[1]):
                    total += weights[element, m] * reference[m, k]
                values[slot] += total


def fill_readable(values: NDArray, slots: NDArray, weights: NDArray, reference: NDArray) -> None:
    """What `fill` does, in plain numpy."""
    kept = slots != DROPPED
    np.add.at(values, slots[kept], (weights @ reference)[kept])


@dataclass(frozen=True)
class Pattern:
    """A square sparsity pattern in CSC form, and where each local pair of unknowns goes in it.

    slots: index into the values, DROPPED for pairs outside the system, shape of the pairs.
    """

    size: int
    indices: NDArray[np.int32]
    indptr: NDArray[np.int32]
    slots: NDArray[np.int64]

    @classmethod
    def of_pairs(cls, rows: NDArray, columns: NDArray, size: int) -> Pattern:
        """The pattern that holds every pair (row, column); negative ones are left out."""
        kept = (rows >= 0) & (columns >= 0)
        keys = columns[kept].astype(np.int64) * size + rows[kept]
        distinct, position = np.unique(keys, return_inverse=True)
        slots = np.full(rows.shape, DROPPED, dtype=np.int64)
        slots[kept] = position
        counts = np.bincount(distinct // size, minlength=size)
        indptr = np.concatenate([[0], np.cumsum(counts)])
        return cls(size, (distinct % size).astype(np.int32), indptr.astype(np.int32), slots)

    def matrix(self, values: NDArray) -> csc_matrix:
        """The sparse matrix with these values."""
        return csc_matrix((values, self.indices, self.indptr), shape=(self.size, self.size))


def element_pairs(unknowns: NDArray) -> tuple[NDArray, NDArray]:
    """Rows and columns of the dense element matrices, shape (element, local²).

    unknowns: indices of each element's unknowns, shape (local, element).
    """
    local = len(unknowns)
    return np.repeat(unknowns, local, axis=0).T, np.tile(unknowns, (local, 1)).T


def quadrilateral(order: int) -> Element:
    """The quadrilateral element of that polynomial order."""
    if order == 1:
        return ElementQuad1()
    return ElementQuad2() if order == 2 else ElementQuadP(order)


@dataclass(frozen=True)
class ReferenceMatrices:
    """Element matrices of the unit square, shape (local, local), and of its four edges.

    stiffness: of d/dx d/dx, d/dy d/dy and d/dx d/dy + d/dy d/dx, shape (3, local, local).
    edge_mass: of u v on each edge, shape (4, local, local).
    """

    mass: NDArray[np.float64]
    stiffness: NDArray[np.float64]
    edge_mass: NDArray[np.float64]


@cache
def reference_matrices(order: int) -> ReferenceMatrices:
    """Of the quadrilateral of that order, integrated exactly by scikit-fem."""
    mesh, element = MeshQuad(), quadrilateral(order)
    basis = Basis(mesh, element, intorder=2 * order)
    edges = [
        FacetBasis(mesh, element, facets=np.asarray(mesh.t2f)[edge], intorder=2 * order)
        for edge in range(4)
    ]
    mass = BilinearForm(lambda u, v, _: u * v)
    xx = BilinearForm(lambda u, v, _: u.grad[0] * v.grad[0])
    yy = BilinearForm(lambda u, v, _: u.grad[1] * v.grad[1])
    xy = BilinearForm(lambda u, v, _: u.grad[0] * v.grad[1] + u.grad[1] * v.grad[0])
    local = basis.element_dofs[:, 0]

    def dense(form: BilinearForm, on: AbstractBasis) -> NDArray[np.float64]:
        return form.assemble(on).toarray()[np.ix_(local, local)]

    return ReferenceMatrices(
        mass=dense(mass, basis),
        stiffness=np.stack([dense(form, basis) for form in (xx, yy, xy)]),
        edge_mass=np.stack([dense(mass, edge) for edge in edges]),
    )


def stiffness_weights(mesh: Mesh) -> NDArray[np.float64]:
    """Weights of the three stiffness reference matrices, |J| J^-1 J^-T, shape (element, 3)."""
    first, second, area = _jacobians(mesh)
    return np.stack(
        [
            np.sum(second * second, axis=0) / area,
            np.sum(first * first, axis=0) / area,
            -np.sum(first * second, axis=0) / area,
        ],
        axis=1,
    )


def areas(mesh: Mesh) -> NDArray[np.float64]:
    """Area of each parallelogram in m², the weight of the mass matrix, shape (element,)."""
    return _jacobians(mesh)[2]


def _jacobians(mesh: Mesh) -> tuple[NDArray, NDArray, NDArray]:
    corner = mesh.p[:, mesh.t]
    first, second = corner[:, 1] - corner[:, 0], corner[:, 3] - corner[:, 0]
    return first, second, np.abs(first[0] * second[1] - first[1] * second[0])
