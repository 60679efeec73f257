"""Synthetic drift between a baseline and a later touch, from the differences between skins.

Simulated skins do not drift while they are pressed, but real ones do: foam gets stiffer and sheets
conduct less. Drift has the few directions in which skins also differ, but is much smaller.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, TransformerMixin
from sklearn.pipeline import Pipeline
from sklearn.utils.validation import check_is_fitted, validate_data

from ...simulator.arrays import Real
from ..inputs.feature_names import ABSOLUTE, BASELINE, RELATIVE
from ..inputs.features import in_blocks
from ..inputs.samples import LocalizationProblem

DRIFT = 0.02
"""Drift relative to the differences between skins: 0.3 % of sheets that differ by 15 %."""


class Drifting(TransformerMixin, BaseEstimator):
    """Adds synthetic drift to training sweeps. Sweeps to be predicted are not changed.

    Parameters
    ----------
    curve: indices of the features of the baseline curve. moved: indices of the features that shift
    with the curve, shape (k, len(curve)); may be empty. drift: as DRIFT.
    """

    def __init__(self, curve=(), moved=(), drift=DRIFT):
        self.curve = curve
        self.moved = moved
        self.drift = drift

    def fit(self, X, y=None):
        """X: shape (sweep, feature). Returns self."""
        validate_data(self, X)
        return self

    def fit_transform(self, X, y=None):
        """Training sweeps with synthetic drift, see `drifted`."""
        return self.fit(X, y).drifted(X)

    def transform(self, X):
        """Sweeps to be predicted, unchanged."""
        check_is_fitted(self)
        return validate_data(self, X, reset=False)

    def drifted(self, X) -> Real:
        """The sweeps with synthetic drift since their baseline; X as in `fit`."""
        return add_drift(np.asarray(X, np.float64), self.curve, self.moved, self.drift)


def add_drift(X: Real, curve: ArrayLike, moved: Iterable[ArrayLike], drift: float) -> Real:
    """The sweeps shifted by a fraction of the difference of a random skin from the mean.

    X: shape (sweep, feature). curve: features of the baseline curve. moved: features that shift
    with them, as many each time. Only X itself is copied, as it may fill half the memory.
    """
    found, curve = X.copy(), np.asarray(curve, dtype=np.intp)
    order, mean = np.random.default_rng(0).permutation(len(X)), X.mean(axis=0)[curve]
    for rows in in_blocks(np.arange(len(X))):
        moves = drift * (X[np.ix_(order[rows], curve)] - mean)
        for columns in moved:
            found[np.ix_(rows, np.asarray(columns, dtype=np.intp))] += moves
    return found


def with_drift(pipeline: Pipeline, problem: LocalizationProblem) -> Pipeline:
    """The pipeline with a step that adds drift, if each change has its baseline curve."""
    blocks = problem.blocks
    changes = [name for name in RELATIVE if name in blocks]
    partners = [BASELINE[RELATIVE.index(name)] for name in changes]
    if not changes or not set(partners) <= set(blocks):
        return pipeline
    read = [ABSOLUTE[RELATIVE.index(name)] for name in changes]
    moved = [changes, read] if set(read) <= set(blocks) else [changes]
    drifting = Drifting(_indices(blocks, partners), tuple(_indices(blocks, each) for each in moved))
    return Pipeline([("drift", drifting), *pipeline.steps])


def drifting(pipeline: Pipeline) -> Callable[[Real], Real]:
    """Function that adds the synthetic drift of a pipeline; the identity if it has none."""
    steps = (step for _, step in pipeline.steps if hasattr(step, "drifted"))
    allowing = next(steps, None)
    return lambda X: X if allowing is None else allowing.drifted(X)


def _indices(blocks: Mapping[str, NDArray[np.intp]], names: list[str]) -> tuple[int, ...]:
    return tuple(int(k) for name in names for k in blocks[name])
