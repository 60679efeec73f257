"""Synthetic drift between a baseline and a later touch, from the differences between skins.

Simulated skins do not drift while they are pressed, but real ones do: foam gets stiffer and sheets
conduct less. Drift has the few directions in which skins also differ, but is much smaller.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...simulator.arrays import Real
from ..inputs.features import ABSOLUTE, BASELINE, RELATIVE, in_blocks
from ..inputs.samples import LocalizationProblem

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
