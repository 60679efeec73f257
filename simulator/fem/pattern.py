"""Sparsity patterns: built once, filled for every press, cut into blocks without a search."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

DROPPED = -1


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

    def within(self, kept: NDArray[np.int64]) -> tuple[Pattern, NDArray[np.int64]]:
        """The pattern of the block of some rows and columns, and where its values are in the whole.

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


def pattern_of_pairs(
    rows: NDArray[np.int64], columns: NDArray[np.int64], size: int
) -> tuple[Pattern, NDArray[np.int64]]:
    """The pattern that holds every pair (row, column), and where in its values each pair goes.

    Pairs with a negative index are left out: they go to DROPPED. Both are of one shape.
    """
    indices, indptr, slots = compressed(rows.ravel(), columns.ravel(), size)
    return Pattern(size, indices, indptr), slots.reshape(rows.shape)


@njit(cache=True)
def compressed(
    rows: NDArray, columns: NDArray, size: int
) -> tuple[NDArray, NDArray, NDArray]:  # pragma: no cover
    """Indices and column pointers of the distinct pairs, and the slot of each pair.

    Two stable counting sorts: by row, then by column.
    """
    by_row = _counted(rows, np.arange(len(rows)), columns, size)
    order = _counted(columns, by_row, rows, size)
    indices, indptr = np.empty(len(order), np.int32), np.zeros(size + 1, np.int32)
    slots = np.full(len(rows), DROPPED, np.int64)
    count = 0
    for k in range(len(order)):
        pair = order[k]
        new = k == 0
        if not new:
            before = order[k - 1]
            new = rows[pair] != rows[before] or columns[pair] != columns[before]
        if new:
            indices[count] = rows[pair]
            indptr[columns[pair] + 1] += 1
            count += 1
        slots[pair] = count - 1
    for column in range(size):
        indptr[column + 1] += indptr[column]
    return indices[:count].copy(), indptr, slots


@njit(cache=True)
def _counted(
    keys: NDArray, pairs: NDArray, others: NDArray, size: int
) -> NDArray:  # pragma: no cover
    """The pairs in order of their key, equal ones as they came; without those that are left out."""
    start = np.zeros(size + 1, np.int64)
    for pair in pairs:
        if keys[pair] >= 0 and others[pair] >= 0:
            start[keys[pair] + 1] += 1
    for key in range(size):
        start[key + 1] += start[key]
    order = np.empty(start[size], np.int64)
    for pair in pairs:
        if keys[pair] >= 0 and others[pair] >= 0:
            order[start[keys[pair]]] = pair
            start[keys[pair]] += 1
    return order


def compressed_readable(
    rows: NDArray[np.int64], columns: NDArray[np.int64], size: int
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int64]]:
    """What `compressed` does, by numpy's search for distinct keys."""
    kept = (rows >= 0) & (columns >= 0)
    distinct, position = np.unique(columns[kept] * size + rows[kept], return_inverse=True)
    slots = np.full(rows.shape, DROPPED, dtype=np.int64)
    slots[kept] = position
    counts = np.bincount(distinct // size, minlength=size)
    indptr = np.concatenate([[0], np.cumsum(counts)])
    return (distinct % size).astype(np.int32), indptr.astype(np.int32), slots


@njit(cache=True)
def block(
    indices: NDArray, indptr: NDArray, kept: NDArray, number: NDArray
) -> tuple[NDArray, NDArray, NDArray]:  # pragma: no cover
    """Indices, column pointers and places in the whole of the block of kept rows and columns.

    number: of each row in the block, negative where it is not kept.
    """
    new_indices, entries = np.empty(len(indices), np.int32), np.empty(len(indices), np.int64)
    new_indptr = np.zeros(len(kept) + 1, np.int32)
    count = 0
    for column in range(len(kept)):
        for entry in range(indptr[kept[column]], indptr[kept[column] + 1]):
            row = number[indices[entry]]
            if row >= 0:
                new_indices[count] = row
                entries[count] = entry
                count += 1
        new_indptr[column + 1] = count
    return new_indices[:count].copy(), new_indptr, entries[:count].copy()
