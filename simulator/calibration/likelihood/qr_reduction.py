"""Least squares of many readings turned to few rows: no reading knows of another's touches.

Of each reading alone, Q'[J r] with the orthogonal Q that leaves rows of its touches, and the rest
in as few rows as there are other unknowns. Only these are joined, and turned again. Source: G. H.
Golub, C. F. Van Loan, Matrix Computations, 4th ed. (2013), sections 5.2 and 5.3.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Condensed = tuple[NDArray[np.float64], NDArray[np.float64]]


@dataclass(frozen=True)
class Block:
    """Residuals of readings that are alike, and their slopes to the unknowns they depend on.

    readings: which, shape (reading,). columns: of the unknowns, the touches of each first, shape
    (reading, unknown). touches: how many. Z: fitted, ohm, shape (reading, interface, frequency).
    off: shape (reading, residual). slopes: shape (reading, residual, unknown).
    """

    readings: NDArray[np.int64]
    columns: NDArray[np.int64]
    touches: int
    Z: NDArray[np.complex128]
    off: NDArray[np.float64]
    slopes: NDArray[np.float64]


def condensed(
    blocks: Sequence[Block], u: NDArray[np.float64], parameters: int, scale: float
) -> Condensed:
    """Residuals r and slopes J of blocks, and of a prior u of each unknown, in fewer rows.

    r'r, J'r and J'J are those of the whole ones. All but priors of the first unknowns, the
    parameters, is divided by the root of the scale.
    """
    size, share = len(u), scale**-0.5
    own, shared = [np.zeros((0, size + 1))], [_priors(blocks, u, parameters, share)]
    for block in blocks:
        touches, others = _turned(block, u, share)
        columns = np.column_stack([block.columns, np.full(len(block.columns), size)])
        own.append(_spread(touches, columns, size + 1))
        shared.append(_spread(others, columns[:, block.touches :], size + 1))
    rest = np.vstack(shared)
    seen = np.flatnonzero(rest.any(axis=0))
    left = np.zeros((min(len(rest), len(seen)), size + 1))
    left[:, seen] = np.linalg.qr(rest[:, seen], mode="r")
    found = np.vstack([*own, left])
    return found[:, -1], found[:, :-1]


def _priors(
    blocks: Sequence[Block], u: NDArray[np.float64], parameters: int, share: float
) -> NDArray[np.float64]:
    """Of what is no touch, shape (prior, unknown and residual)."""
    weights = np.where(np.arange(len(u)) < parameters, 1.0, share)
    whole = np.column_stack([np.diag(weights), weights * u])
    touches = [block.columns[:, : block.touches].ravel() for block in blocks]
    return np.delete(whole, np.concatenate(touches), axis=0)


def _turned(
    block: Block, u: NDArray[np.float64], share: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Rows of touches with their priors, and of all else: each (reading, row, unknown and r)."""
    count, unknowns = block.columns.shape
    priors = np.zeros((count, block.touches, unknowns + 1))
    priors[:, range(block.touches), range(block.touches)] = 1.0
    priors[:, :, -1] = u[block.columns[:, : block.touches]]
    read = np.concatenate([block.slopes, block.off[:, :, None]], axis=2)
    rows = share * np.concatenate([priors, read], axis=1)
    R = np.asarray(np.linalg.qr(rows, mode="r"), dtype=np.float64)
    return R[:, : block.touches], R[:, block.touches :, block.touches :]


def _spread(
    rows: NDArray[np.float64], columns: NDArray[np.int64], size: int
) -> NDArray[np.float64]:
    """Rows of each reading among all columns, shape (row, size)."""
    found = np.zeros((*rows.shape[:2], size))
    found[np.arange(len(rows))[:, None], :, columns] = rows.transpose(0, 2, 1)
    return found.reshape(-1, size)
