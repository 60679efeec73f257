"""Assembly into a sparsity pattern that is built once; later only the values are filled.

The matrix of a parallelogram is a weighted sum of a few reference matrices. Any other shape has its
own reference matrices; a mesh needs few of those. The weights change with the capacitance map, the
pattern never does: it is cut into blocks without a search.
"""

from __future__ import annotations

from collections.abc import Iterable
from copy import copy
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix
from skfem import Element, ElementQuad1, ElementQuad2, ElementQuadP

from ..arrays import Integer, Real
from ..mesh.quadrilaterals import QuadrilateralCells
from .lazy_kernel import LazyKernel
from .quadrature import Rule, edge_rule, gauss_rule, mass_terms, rule_at, stiffness_terms, surface

DROPPED = -1


TABLE = 32
"""Largest size of a lookup table over the number of keys; below it a table is faster than sorting.
"""


@dataclass(frozen=True)
class Pattern:
    """A square sparsity pattern in CSC form, rows ascending in each column.

    indices, indptr: as scipy has them.
    """

    size: int
    indices: NDArray[np.int32]
    indptr: NDArray[np.int32]

    def matrix(self, values: NDArray) -> csc_matrix:
        """The sparse matrix with these values."""
        matrix = copy(self._empty)
        matrix.data = values
        return matrix

    def within(self, kept: Integer) -> tuple[Pattern, Integer]:
        """Pattern of the block of some rows and columns, and the positions of its values in the
        whole.

        kept: their indices, ascending.
        """
        number = np.full(self.size, DROPPED, dtype=np.int32)
        number[kept] = np.arange(len(kept), dtype=np.int32)
        indices, indptr, entries = block(self.indices, self.indptr, kept, number)
        return Pattern(len(kept), indices, indptr), entries

    @cached_property
    def _empty(self) -> csc_matrix:
        zeros = np.zeros(len(self.indices))
        matrix = csc_matrix((zeros, self.indices, self.indptr), shape=(self.size, self.size))
        matrix.has_canonical_format = True
        return matrix


def pattern_of_pairs(rows: Integer, columns: Integer, size: int) -> tuple[Pattern, Integer]:
    """Pattern that holds every pair (row, column), and the slot of each pair in its values.

    Pairs with a negative index get the slot DROPPED. rows and columns have the same shape.
    """
    row, column = (each.ravel().astype(np.int64, copy=False) for each in (rows, columns))
    indices, indptr, slots = compressed(row, column, int(size))
    return Pattern(size, indices, indptr), slots.reshape(rows.shape)


def compressed_readable(
    rows: Integer, columns: Integer, size: int
) -> tuple[NDArray[np.int32], NDArray[np.int32], Integer]:
    """Do what `compressed` does: by a table of all keys for small matrices, by sorting for
    others."""
    kept = (rows >= 0) & (columns >= 0)
    keys = columns[kept] * size + rows[kept]
    if size**2 <= TABLE * keys.size:
        there = np.zeros(size**2, dtype=bool)
        there[keys] = True
        distinct = np.flatnonzero(there)
        number = np.empty(size**2, dtype=np.int32)
        number[distinct] = np.arange(len(distinct), dtype=np.int32)
        position = number[keys]
    else:
        distinct, position = np.unique(keys, return_inverse=True)
    slots = np.full(rows.shape, DROPPED, dtype=np.int64)
    slots[kept] = position
    counts = np.bincount(distinct // size, minlength=size)
    indptr = np.concatenate([[0], np.cumsum(counts)])
    return (distinct % size).astype(np.int32), indptr.astype(np.int32), slots


def block_readable(
    indices: NDArray[np.int32], indptr: NDArray[np.int32], kept: Integer, number: NDArray[np.int32]
) -> tuple[NDArray[np.int32], NDArray[np.int32], Integer]:
    """Do what `block` does, for all entries at once."""
    column = number[np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))]
    entries = np.flatnonzero((number[indices] >= 0) & (column >= 0))
    counts = np.bincount(column[entries], minlength=len(kept))
    indptr = np.concatenate([[0], np.cumsum(counts)])
    return number[indices[entries]], indptr.astype(np.int32), entries


compressed = LazyKernel(
    lambda kernels: kernels.compressed, compressed_readable, lambda rows, *_: 2e-7 * rows.size
)
block = LazyKernel(
    lambda kernels: kernels.block, block_readable, lambda indices, *_: 1e-8 * indices.size
)


EXTRA_ORDER = 40

SHAPES_KEPT = 128
"""Cached shapes of cells that are no parallelograms, 0.1 MB each at order 8. A mesh has four for
each order."""


def fill_readable(values: NDArray, slots: NDArray, weights: NDArray, reference: NDArray) -> None:
    """Do what `fill` does, in plain numpy; terms and elements are added in the same order."""
    kept = slots != DROPPED
    totals = np.zeros(slots.shape)
    for weight, matrix in zip(weights.T, reference, strict=True):
        totals += np.multiply.outer(weight, matrix)
    np.add.at(values, slots[kept], totals[kept])


fill = LazyKernel(
    lambda kernels: kernels.fill, fill_readable, lambda values, slots, *_: 4e-8 * slots.size
)


def add_terms(values: NDArray, slots: NDArray, terms: Iterable[tuple[NDArray, NDArray]]) -> None:
    """Call `fill` with the weights and reference matrices of each term.

    Terms and entries that are zero in all elements are left out.
    """
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
    """Quadrilateral element of that polynomial order."""
    if order == 1:
        return ElementQuad1()
    return ElementQuad2() if order == 2 else ElementQuadP(order)


@dataclass(frozen=True)
class Group:
    """Cells whose matrices are weighted sums of the same reference matrices.

    cells: their indices. stiffness_weights: shape (cell, term), for the terms of `stiffness`, shape
    (term, local, local). mass_weights: m², shape (cell,), for `mass`, shape (local, local).
    """

    cells: Integer
    stiffness_weights: Real
    stiffness: Real
    mass_weights: Real
    mass: Real


def groups(cells: QuadrilateralCells, order: int) -> list[Group]:
    """Group all parallelograms, and the other cells by shape, whatever their size."""
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


@cache
def _rules(order: int) -> tuple[Rule, Rule]:
    """Rule that is exact on parallelograms, and a rule of their first corner alone."""
    element = quadrilateral(order)
    return gauss_rule(element, 2 * order), rule_at(element, np.zeros((2, 1)), np.ones(1))


@cache
def edge_masses(order: int) -> list[Real]:
    """Integrals of u v over each edge of the unit square, shape (local, local)."""
    return [edge_rule(quadrilateral(order), edge, order + 1)[0].mass for edge in range(4)]


def _parallelograms(cells: QuadrilateralCells, which: Integer, order: int) -> Group:
    """Group of parallelograms: their geometry is constant, so one point gives the weights."""
    rule, corner = _rules(order)
    at, ones = surface(cells.some(which), corner), np.ones((len(which), 1))
    ((area, mass),) = mass_terms(rule, at, ones)
    ((weights, stiffness),) = stiffness_terms(rule, at, ones)
    local = len(rule.values)
    stiffness = stiffness.reshape(-1, local, local)
    return Group(which, weights, stiffness, area[:, 0], mass.reshape(local, local))


@lru_cache(maxsize=SHAPES_KEPT)
def _shape_matrices(shape: tuple[float, ...], order: int) -> tuple[Real, Real]:
    """Mass and stiffness matrix of one quadrilateral, given along, across and twist (two numbers
    each).

    The integrand of the stiffness is rational. EXTRA_ORDER more than for a polynomial leaves 1e-13.
    """
    along, across, twist = np.array(shape).reshape(3, 2, 1)
    cell = QuadrilateralCells(
        np.zeros((2, 1)), np.zeros((4, 1), dtype=np.int64), along, across, twist
    )
    rule = gauss_rule(quadrilateral(order), 2 * order + EXTRA_ORDER)
    at = surface(cell, rule)
    local, ones = len(rule.values), np.ones_like(at.area)
    mass, stiffness = (
        np.sum([weights @ matrices for weights, matrices in terms(rule, at, ones)], axis=0)
        for terms in (mass_terms, stiffness_terms)
    )
    return mass.reshape(local, local), stiffness.reshape(local, local)
