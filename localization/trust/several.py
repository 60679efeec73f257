"""Guard of a localizer of single touches, trained on sweeps of several touches.

If the strength of a touch varies, two weak touches resemble one touch. An SVM learns to separate
them from sweeps of both. It uses changes from the baseline: sweeps as read differ more between
skins than between touches, and an unknown skin would be taken for two touches.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sklearn.pipeline import Pipeline, make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC
from sklearn.utils.validation import validate_data

from ...simulator.arrays import Mask, Real
from ..inputs.features import press_features
from ..inputs.samples import Samples, draw_stratified
from ..processor_count import physical_cpu_count
from .answers import NOTHING_PRESSED
from .folds import Splits, by_session
from .guard import Guard

MIN_SWEEPS, MAX_SWEEPS_PER_KIND = 50, 5000
"""Minimum number of sweeps of several touches, and maximum number of sweeps of each kind."""
PENALTY = 10.0
"""Penalty of sweeps on the wrong side, `C` of the SVM."""


class SeveralGuard(Guard):
    """Guard by the decision of an SVM between one touch and several.

    The limit is a quantile of the decisions of held-out sweeps of one touch. It fixes the share of
    single touches that are answered; the share of several touches that are detected follows.

    Parameters
    ----------
    share: share of the held-out sweeps of one touch that are to be recognized as one touch.

    Attributes
    ----------
    told_: indices of the features used, shape (k,). parting_: the fitted pipeline. limit_: exp of
    the largest decision that is no novelty.
    """

    def __init__(self, share=0.99):
        self.share = share

    def fit(
        self,
        X,
        several: Real,
        *,
        splits: Splits,
        several_parts: list[NDArray[np.intp]],
        touched: Mask,
        columns: NDArray[np.intp],
    ):
        """Fit the SVM that separates several touches from fewer, and the limit.

        X: sweeps of one touch or none, shape (n, feature). several: sweeps of more touches, shape
        (m, feature). splits: sweeps of X to train on and to hold out. several_parts: for each
        split, the sweeps of `several` to train on. touched: True for sweeps of X with a touch,
        shape (n,). columns: indices of the features to use. Returns self.
        """
        X = np.asarray(validate_data(self, X, ensure_min_samples=2, dtype=np.float64))
        self.told_ = columns
        distances = []
        for (known, held_out), others in zip(splits, several_parts, strict=True):
            self.parting_ = _separating_svm(X[known][:, columns], several[others][:, columns])
            distances.append(self.away(X[held_out[touched[held_out]]]))
        self.parting_ = _separating_svm(X[:, columns], several[:, columns])
        self.limit_ = float(np.quantile(np.concatenate(distances), self.share, method="higher"))
        return self

    def away(self, X: Real) -> Real:
        """exp of the decision for several touches, shape (n,)."""
        physical_cpu_count()
        return np.exp(self.parting_.decision_function(X[:, self.told_])) if len(X) else np.zeros(0)


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
    return SeveralGuard().fit(
        samples.X, several, splits=splits, several_parts=parts, touched=touched, columns=columns
    )


def _separating_svm(one: Real, several: Real) -> Pipeline:
    """Fit an SVM whose decision is positive for several touches."""
    parts = [_at_most(part) for part in (one, several)]
    is_several = np.repeat([False, True], [len(part) for part in parts])
    machine = make_pipeline(StandardScaler(), SVC(C=PENALTY, class_weight="balanced"))
    return machine.fit(np.concatenate(parts), is_several)


def _at_most(X: Real) -> Real:
    return (
        X
        if len(X) <= MAX_SWEEPS_PER_KIND
        else X[draw_stratified(np.zeros(len(X)), MAX_SWEEPS_PER_KIND)]
    )
