"""Sparsity patterns: built once, filled for every press, cut into blocks without a search."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from ...arrays import Integer
from .dropped import DROPPED
from .lazy_kernel import LazyKernel

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
