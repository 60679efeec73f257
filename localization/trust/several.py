"""Guard of a localizer of single touches, trained on sweeps of several touches.

If the strength of a touch varies, two weak touches resemble one touch. An SVM learns to separate
them from sweeps of both. It uses changes from the baseline: sweeps as read differ more between
skins than between touches, and an unknown skin would be taken for two touches.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Mask, Real
from ..inputs.features import press_features
from ..inputs.samples import Samples, draw_stratified
from ..learners.classifiers import separating_svm, standardized
from ..parts.parts import KernelSum, Scaling
from ..parts.plain import Plain, Sizes, require
from .answers import NOTHING_PRESSED
from .folds import Splits, by_session

MIN_SWEEPS, MAX_SWEEPS_PER_KIND = 50, 5000
"""Minimum number of sweeps of several touches, and maximum number of sweeps of each kind."""
PENALTY = 10.0
"""Penalty of sweeps on the wrong side, `C` of the SVM."""


@dataclass(frozen=True, eq=False)
class SeveralGuard(Plain):
    """Guard by the decision of an SVM between one touch and several.

    The limit is a quantile of the decisions of held-out sweeps of one touch. It fixes the share of
    single touches that are answered; the share of several touches that are detected follows.

    features: number of features of a sweep. columns: indices of those used, shape (T,). machine:
    its decision is positive for several touches. limit: exp of the largest decision that is no
    novelty.
    """

    features: Annotated[int, ">0"]
    columns: Annotated[NDArray[np.intp], "T <features"]
    scaling: Scaling
    machine: KernelSum
    limit: Annotated[float, ">0"]

    def _check(self, sizes: Sizes) -> None:
        size = sizes["T"]
        require(self.scaling.sizes[0] == size, "scaling", "must be of as many numbers as `columns`")
        require(self.machine.sizes == (size, 1), "machine", "must take them and give one number")

    def distances(self, X: Real) -> Real:
        """exp of the decision over the limit: above 1 is novel. X: (n, feature). Shape (n,)."""
        return np.exp(_decision(self.scaling, self.machine, X[:, self.columns])) / self.limit

    def novel(self, X: Real) -> Mask:
        """True for sweeps of several touches, shape (n,)."""
        return self.distances(X) > 1


def several_guard(samples: Samples, splits: Splits) -> SeveralGuard | None:
    """Guard against several touches; None where it does not apply.

    It does not apply if the target has several touches, if no feature uses the baseline, or if too
    few sweeps show more than one touch. splits: sweeps to train on and to hold out. A held-out
    session is left out of the training, its sweeps of several touches included.
    """
    problem = samples.problem
    if not problem.single_touch or problem.ignores_baseline:
        return None
    here = np.isin(samples.several.sessions, samples.sessions)
    several, sessions = samples.several.X[here], samples.several.sessions[here]
    whole = by_session(samples.sessions)
    parts = [
        np.flatnonzero(~np.isin(sessions, samples.sessions[test]) | (not whole))
        for _, test in splits
    ]
    if min(map(len, parts)) < MIN_SWEEPS:
        return None
    columns, _ = press_features(problem.quantities, problem.features)
    one = problem.continuous or ~np.isin(samples.y.astype(str), NOTHING_PRESSED)
    touched = np.broadcast_to(one, len(samples.X))
    return fitted_several_guard(samples.X, several, columns, splits, parts, touched)


def fitted_several_guard(
    X: Real,
    several: Real,
    columns: NDArray[np.intp],
    splits: Splits,
    several_parts: list[NDArray[np.intp]],
    touched: Mask,
    share: float = 0.99,
) -> SeveralGuard:
    """Fit the SVM that separates several touches from fewer, and the limit.

    X: sweeps of one touch or none, shape (n, feature). several: sweeps of more touches, shape
    (m, feature). columns: indices of the features to use. splits: sweeps of X to train on and to
    hold out. several_parts: for each split, the sweeps of `several` to train on. touched: True for
    sweeps of X with a touch, shape (n,). share: share of the held-out sweeps of one touch to be
    recognized as one touch.
    """
    features, X, several = X.shape[1], X[:, columns], several[:, columns]
    decisions = []
    for (known, held_out), others in zip(splits, several_parts, strict=True):
        parts = _separating(X[known], several[others])
        decisions.append(_decision(*parts, X[held_out[touched[held_out]]]))
    limit = np.quantile(np.exp(np.concatenate(decisions)), share, method="higher")
    return SeveralGuard(features, columns, *_separating(X, several), float(limit))


def _separating(one: Real, several: Real) -> tuple[Scaling, KernelSum]:
    """Fit an SVM whose decision is positive for several touches."""
    parts = [_at_most(part) for part in (one, several)]
    is_several, X = np.repeat([False, True], [len(part) for part in parts]), np.concatenate(parts)
    scaling = standardized(X)
    machine = separating_svm(scaling(X), is_several, C=PENALTY, class_weight="balanced")
    return scaling, machine


def _decision(scaling: Scaling, machine: KernelSum, X: Real) -> Real:
    return machine(scaling(X))[:, 0]


def _at_most(X: Real) -> Real:
    return (
        X
        if len(X) <= MAX_SWEEPS_PER_KIND
        else X[draw_stratified(np.zeros(len(X)), MAX_SWEEPS_PER_KIND)]
    )
