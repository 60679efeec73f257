"""QR reduction of a least-squares problem of many sweeps, each with touches of its own.

A QR factorization of each sweep alone, Q'[J r], separates the rows of its own touches; the others
are as few rows as there are shared unknowns. Only these rows of all sweeps are stacked and reduced
again. Source: G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed. (2013), sections 5.2 and
5.3.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...arrays import Complex, Integer, Real

ReducedSystem = tuple[Real, Real]


@dataclass(frozen=True)
class ResidualBlock:
    """Residuals of sweeps with the same number of unknowns, and their derivatives.

    readings: numbers of the sweeps, shape (sweep,). columns: indices of the unknowns that each
    depends on, its own touches first, shape (sweep, unknown). touches: number of own touches. Z:
    fitted, ohm, shape (sweep, interface, frequency). residuals: shape (sweep, residual). slopes:
    derivatives of the residuals, shape (sweep, residual, unknown).
    """

    readings: Integer
    columns: Integer
    touches: int
    Z: Complex
    residuals: Real
    slopes: Real


def reduced_system(
    blocks: Sequence[ResidualBlock], u: Real, parameters: int, scale: float
) -> ReducedSystem:
    """Residuals r and Jacobian J of blocks and of the priors of all unknowns u, in fewer rows.

    r'r, J'r and J'J are those of the full problem. All rows are divided by the root of the scale,
    except priors of the first unknowns, the parameters.
    """
    size, share = len(u), scale**-0.5
    own, shared = [np.zeros((0, size + 1))], [_priors(blocks, u, parameters, share)]
    for block in blocks:
        touches, others = _eliminated(block, u, share)
        columns = np.column_stack([block.columns, np.full(len(block.columns), size)])
        own.append(_spread(touches, columns, size + 1))
        shared.append(_spread(others, columns[:, block.touches :], size + 1))
    rest = np.vstack(shared)
    seen = np.flatnonzero(rest.any(axis=0))
    left = np.zeros((min(len(rest), len(seen)), size + 1))
    left[:, seen] = np.linalg.qr(rest[:, seen], mode="r")
    found = np.vstack([*own, left])
    return found[:, -1], found[:, :-1]


def _priors(blocks: Sequence[ResidualBlock], u: Real, parameters: int, share: float) -> Real:
    """Rows of the priors of all unknowns but touches, shape (prior, unknown and residual)."""
    weights = np.where(np.arange(len(u)) < parameters, 1.0, share)
    whole = np.column_stack([np.diag(weights), weights * u])
    touches = [block.columns[:, : block.touches].ravel() for block in blocks]
    return np.delete(whole, np.concatenate(touches), axis=0)


def _eliminated(block: ResidualBlock, u: Real, share: float) -> tuple[Real, Real]:
    """Rows of touches, and all other rows: each of shape (sweep, row, unknown and residual)."""
    count, unknowns = block.columns.shape
    priors = np.zeros((count, block.touches, unknowns + 1))
    priors[:, range(block.touches), range(block.touches)] = 1.0
    priors[:, :, -1] = u[block.columns[:, : block.touches]]
    read = np.concatenate([block.slopes, block.residuals[:, :, None]], axis=2)
    rows = share * np.concatenate([priors, read], axis=1)
    R = np.asarray(np.linalg.qr(rows, mode="r"), dtype=np.float64)
    return R[:, : block.touches], R[:, block.touches :, block.touches :]


def _spread(rows: Real, columns: Integer, size: int) -> Real:
    """Rows of each sweep, placed among all columns, shape (row, size)."""
    found = np.zeros((*rows.shape[:2], size))
    found[np.arange(len(rows))[:, None], :, columns] = rows.transpose(0, 2, 1)
    return found.reshape(-1, size)
