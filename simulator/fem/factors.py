"""Sparse factors that solve many right-hand sides in one pass, and masses with a low-rank part.

Charges by distant potentials are a dense matrix of low rank beside the sparse one.
"""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import SuperLU, splu
from threadpoolctl import ThreadpoolController

from ..arrays import Real
from ..sweeps import ToleranceError

MIN_RIGHT_HAND_SIDES = 3
"""Number of right-hand sides from which on one pass pays."""


def factorised(matrix: csc_matrix) -> SuperLU:
    """LU without pivoting: stable, because real and imaginary part are positive semidefinite.

    Raises ToleranceError where the factors outgrow what SuperLU can address, or the matrix is
    singular in double precision.
    """
    try:
        return splu(
            matrix,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True, "Equil": False},
        )
    except MemoryError as error:
        raise ToleranceError(f"{len(matrix.indptr) - 1} unknowns: too many to factorise") from error
    except RuntimeError as error:
        raise ToleranceError(
            "the equations of the skin are singular in double precision: its sizes, resistances, "
            "capacitances or frequencies lie too far apart; bring them nearer to those of a skin"
        ) from error


def without_zeros(matrix: csc_matrix) -> csc_matrix:
    """Copy of a matrix without stored zeros; the pattern of a system has entries between fields
    that K lacks."""
    own = matrix.copy()
    own.eliminate_zeros()
    return own


class Factors:
    """Factors of SuperLU; SuperLU's own `solve` is the readable twin."""

    def __init__(self, lu: SuperLU) -> None:
        self._lu = lu

    @cached_property
    def _both(self) -> list[tuple[NDArray, NDArray, NDArray]]:
        """L and U by columns, in the form that the kernel takes."""
        both: tuple[Any, Any] = self._lu.L, self._lu.U
        ordered = (each.sorted_indices() for each in both)
        return [(each.indptr, each.indices, each.data) for each in ordered]

    def solve(self, y: Real) -> Real:
        """A^-1 y. y: shape (unknown, ...)."""
        if y.ndim == 1 or y.shape[1] < MIN_RIGHT_HAND_SIDES:
            return self._lu.solve(y)
        from .kernels import substitute

        x = np.empty(y.shape)
        x[self._lu.perm_r] = y
        lower, upper = self._both
        substitute(lower, upper, x)
        return x[self._lu.perm_c]


def one_blas_thread() -> AbstractContextManager:
    """Limit BLAS to one thread: blocks of sparse factors are too small to share."""
    return _blas().limit(limits=1, user_api="blas")


@cache
def _blas() -> ThreadpoolController:
    return ThreadpoolController()


@dataclass(frozen=True)
class LowRankMass:
    """M = near + F F', in F.

    near: sparse, shape (unknown, unknown). far: F, shape (unknown, rank), real or complex.
    """

    near: csc_matrix
    far: NDArray

    def dot(self, v: NDArray) -> NDArray:
        """Return M v."""
        return self.near @ v + self.far @ (self.far.T @ v)

    __matmul__ = dot


Mass = csc_matrix | LowRankMass


class Bordered:
    """Factors of A + s F F' from those of a sparse A.

    Source: M. A. Woodbury, Inverting Modified Matrices, 1950.
    """

    def __init__(self, sparse: SuperLU, far: Real, s: complex) -> None:
        """far: F, shape (unknown, rank)."""
        self.shape = sparse.shape
        self._sparse, self._far = sparse, far
        self._followed = s * sparse.solve(far.astype(type(s)))
        self._own = np.eye(far.shape[1]) + far.T @ self._followed

    def solve(self, y: NDArray) -> NDArray:
        """Return (A + s F F')^-1 y."""
        x = self._sparse.solve(y)
        return x - self._followed @ np.linalg.solve(self._own, self._far.T @ x)
