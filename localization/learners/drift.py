"""Drifts of sessions, and corrections of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...simulator.arrays import Real
from ..inputs.features import ABSOLUTE, BASELINE, RELATIVE, in_blocks
from ..inputs.samples import LocalizationProblem
from ..parts.parts import AffineMap, Scaling

PRIOR = 5.0
"""Weight of the prior of no correction, as a number of sweeps."""


def class_offsets(decisions: Real, index: NDArray[np.intp], sharpness: float) -> Scaling:
    """One offset per class, of least penalised log loss.

    This is vector scaling (C. Guo et al., Proc. 34th Int. Conf. Machine Learning (2017), section
    4.2) without the scales, which a few sweeps do not determine. The prior of offsets is normal
    about zero. decisions: shape (n, K). index: true classes, (n,). sharpness: factor of decisions
    before the softmax.
    """
    from scipy.optimize import minimize
    from scipy.special import log_softmax

    count = decisions.shape[1]
    met = np.eye(count)[index]
    scale = float(decisions.std()) or 1.0

    def loss(p):
        steepness, moved = sharpness * np.exp(p[0]), decisions + scale * p[1:]
        logarithm = log_softmax(steepness * moved, axis=1)
        off = np.exp(logarithm) - met
        slope = steepness * np.append((off * moved).sum(), scale * off.sum(axis=0))
        penalty = PRIOR * p @ p / 2
        return penalty - logarithm[met == 1].sum(), slope + PRIOR * p

    found = minimize(loss, np.zeros(1 + count), jac=True, method="L-BFGS-B")
    return Scaling(-scale * found.x[1:], np.ones(count))


def affine_correction(places: Real, truth: Real) -> AffineMap:
    """Places plus b + A (place - c), by ridge regression; c: mean of the places.

    Source: A. E. Hoerl, R. W. Kennard, Technometrics 12 (1970) 55-67. places, truth: predicted and
    true x, y [mm] and strength of touches, shape (n, 3).
    """
    centre = places.mean(axis=0)
    scale = np.maximum(places.std(axis=0), 1e-6)
    G = np.column_stack([np.ones(len(places)), (places - centre) / scale])
    shift, *turn = np.linalg.solve(G.T @ G + PRIOR * np.eye(4), G.T @ (truth - places))
    return AffineMap(centre, np.eye(3) + np.array(turn) / scale[:, None], centre + shift)


DRIFT = 0.02
"""Drift relative to the differences between skins: 0.3 % of sheets that differ by 15 %."""


def add_drift(X: Real, curve: ArrayLike, moved: Sequence[ArrayLike], drift: float = DRIFT) -> Real:
    """The sweeps shifted by a fraction of the difference of a random skin from the mean.

    X: shape (sweep, feature). curve: features of the baseline curve. moved: features that shift
    with them, as many each time. drift: as DRIFT. Only X itself is copied, as it may fill
    half the memory.
    """
    found, curve = X.copy(), np.asarray(curve, dtype=np.intp)
    order, mean = np.random.default_rng(0).permutation(len(X)), X.mean(axis=0)[curve]
    for rows in in_blocks(np.arange(len(X))):
        moves = drift * (X[np.ix_(order[rows], curve)] - mean)
        for columns in moved:
            found[np.ix_(rows, np.asarray(columns, dtype=np.intp))] += moves
    return found


def with_drift(problem: LocalizationProblem, X: Real) -> Real:
    """The sweeps with synthetic drift, if each change has its baseline curve.

    X: shape (sweep, feature). Only training sweeps drift, not those to be predicted.
    """
    blocks = problem.blocks
    changes = [name for name in RELATIVE if name in blocks]
    partners = [BASELINE[RELATIVE.index(name)] for name in changes]
    if not changes or not set(partners) <= set(blocks):
        return X
    read = [ABSOLUTE[RELATIVE.index(name)] for name in changes]
    moved = [changes, read] if set(read) <= set(blocks) else [changes]
    columns = [_indices(blocks, each) for each in moved]
    return add_drift(X, _indices(blocks, partners), columns)


def _indices(blocks: Mapping[str, NDArray[np.intp]], names: list[str]) -> tuple[int, ...]:
    return tuple(int(k) for name in names for k in blocks[name])
