"""Assembly into a sparsity pattern built once: the scatter map is kept, only values are filled.

A parallelogram's matrix is a weighted sum of a few reference matrices; any other shape has its own,
of which a mesh needs few. The weights change with the capacitance map, the pattern never does.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from skfem import (
    Element,
    ElementQuad1,
    ElementQuad2,
    ElementQuadP,
    MeshQuad,
)
from skfem.assembly import Basis, FacetBasis
from skfem.assembly.basis import AbstractBasis

from ..mesh.rings import Cells
from .dropped import DROPPED
from .warming import Warming

EXTRA_ORDER = 40

ROUNDING = 1e-14
"""Of the largest integral: what is smaller is 0. Factors of sparse matrices are the smaller."""

SHAPES_KEPT = 128
"""Of cells that are no parallelograms, 0.1 MB each at order 8; a mesh has four for each order."""


def fill_readable(values: NDArray, slots: NDArray, weights: NDArray, reference: NDArray) -> None:
    """What `fill` does, in plain numpy, terms and elements added in the same order."""
    kept = slots != DROPPED
    totals = np.zeros(slots.shape)
    for weight, matrix in zip(weights.T, reference, strict=True):
        totals += np.multiply.outer(weight, matrix)
    np.add.at(values, slots[kept], totals[kept])


fill = Warming(
    lambda kernels: kernels.fill, fill_readable, lambda values, slots, *_: 4e-8 * slots.size
)


def add_terms(values: NDArray, slots: NDArray, terms: Iterable[tuple[NDArray, NDArray]]) -> None:
    """`fill` with the weights and reference of each term, without what is zero in all elements."""
    for weights, reference in terms:
        there, used = weights.any(axis=0), reference.any(axis=0)
        own = slots if used.all() else slots[:, used]
        matrices = np.ascontiguousarray(reference[there][:, used])
        fill(values, own, np.ascontiguousarray(weights[:, there]), matrices)


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
    """Of the quadrilateral of that order, integrated exactly by scikit-fem's quadrature."""
    mesh, element = MeshQuad(), quadrilateral(order)
    inside = _at_points(Basis(mesh, element, intorder=2 * order))
    edges = [
        FacetBasis(mesh, element, facets=np.asarray(mesh.t2f)[edge], intorder=2 * order)
        for edge in range(4)
    ]
    return ReferenceMatrices(
        mass=inside.products(inside.values, inside.values),
        stiffness=np.stack(
            [
                inside.products(inside.slopes[0], inside.slopes[0]),
                inside.products(inside.slopes[1], inside.slopes[1]),
                2 * inside.products(inside.slopes[0], inside.slopes[1]),
            ]
        ),
        edge_mass=np.stack(
            [on.products(on.values, on.values) for on in map(_at_points, edges)],
        ),
    )


class AtPoints(NamedTuple):
    """Functions of one element at points of a quadrature.

    values: shape (local, point). slopes: along x and y, shape (2, local, point). weights: (point,).
    """

    values: NDArray[np.float64]
    slopes: NDArray[np.float64]
    weights: NDArray[np.float64]

    def products(self, u: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
        """Integrals of (u_i v_j + u_j v_i) / 2, shape (local, local); 0 where rounding is left."""
        one_way = (u * self.weights) @ v.T
        found = (one_way + one_way.T) / 2
        return np.where(np.abs(found) > ROUNDING * np.abs(found).max(), found, 0.0)


def _at_points(basis: AbstractBasis) -> AtPoints:
    fields = [field for (field,) in basis.basis]
    values = np.stack([np.asarray(field)[0] for field in fields])
    slopes = np.stack([np.asarray(field.grad)[:, 0] for field in fields], axis=1)
    return AtPoints(values, slopes, basis.dx[0])


@dataclass(frozen=True)
class Group:
    """Cells whose matrices are weighted sums of the same reference matrices.

    cells: their indices. stiffness_weights: shape (cell, term) for the terms of `stiffness`, shape
    (term, local, local). mass_weights: m², shape (cell,), for `mass`, shape (local, local).
    """

    cells: NDArray[np.int64]
    stiffness_weights: NDArray[np.float64]
    stiffness: NDArray[np.float64]
    mass_weights: NDArray[np.float64]
    mass: NDArray[np.float64]


def groups(cells: Cells, order: int) -> list[Group]:
    """All parallelograms as one group, and one for each other shape, whatever its size."""
    straight = (cells.twist == 0).all(axis=0)
    found = [_parallelograms(cells, np.flatnonzero(straight), order)]
    if straight.all():
        return found
    bent = np.flatnonzero(~straight)
    size = np.linalg.norm(cells.along[:, bent], axis=0)
    vectors = np.concatenate([v[:, bent] for v in (cells.along, cells.across, cells.twist)])
    shapes = vectors / size
    _, first, which = np.unique(np.round(shapes, 9), axis=1, return_index=True, return_inverse=True)
    for number, of_shape in enumerate(first):
        same = which == number
        mass, stiffness = _shape_matrices(tuple(np.round(shapes[:, of_shape], 14)), order)
        weights = np.ones((int(same.sum()), 1))
        found.append(Group(bent[same], weights, stiffness[None], size[same] ** 2, mass))
    return found


def _parallelograms(cells: Cells, which: NDArray[np.int64], order: int) -> Group:
    """Weights of the three stiffness reference matrices are |J| J^-1 J^-T."""
    reference, along, across = (
        reference_matrices(order),
        cells.along[:, which],
        cells.across[:, which],
    )
    area = np.abs(along[0] * across[1] - along[1] * across[0])
    weights = np.stack(
        [
            np.sum(across * across, axis=0) / area,
            np.sum(along * along, axis=0) / area,
            -np.sum(along * across, axis=0) / area,
        ],
        axis=1,
    )
    return Group(which, weights, reference.stiffness, area, reference.mass)


@lru_cache(maxsize=SHAPES_KEPT)
def _shape_matrices(
    shape: tuple[float, ...], order: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mass and stiffness of one quadrilateral: along, across and twist, two numbers each.

    The integrand of the stiffness is rational; EXTRA_ORDER more than a polynomial's leaves 1e-13.
    """
    along, across, twist = np.array(shape).reshape(3, 2)
    corners = np.stack([np.zeros(2), along, along + across + twist, across], axis=1)
    basis = Basis(MeshQuad(corners), quadrilateral(order), intorder=2 * order + EXTRA_ORDER)
    inside = _at_points(basis)
    x, y = (inside.products(slope, slope) for slope in inside.slopes)
    return inside.products(inside.values, inside.values), x + y
