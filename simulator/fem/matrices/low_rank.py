"""Mass matrix with charges by distant potentials: a sparse and a dense low-rank part."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import SuperLU

from ...arrays import Real


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
