"""Whether a sweep is of more touches than the one that a localizer tells, learned from such sweeps.

Where one touch may be weak or strong, two weak ones lie close to what one can do. What parts them
best is learned from sweeps of both, of changes from the skin at rest: as they are read, sweeps
tell skins apart before they tell touches, and a skin never seen would be taken for two touches.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sklearn.pipeline import Pipeline, make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC
from sklearn.utils.validation import validate_data

from ..inputs.features import press_features
from ..inputs.samples import Samples, draw_stratified
from ..processor_count import physical_cpu_count
from .answers import NOTHING_PRESSED
from .folds import Splits, by_session
from .guard import Guard

FEWEST, MOST = 50, 5000
"""Sweeps of several touches that it takes, and sweeps of each kind that it learns from at most."""
PENALTY = 10.0
"""Of sweeps on the wrong side, `C` of the SVM."""


class SeveralGuard(Guard):
    """By the decision of an SVM between one touch and several, against that of one touch held out.

    What one touch may look like at most is a quantile of sweeps that were not trained on, so that
    the share of presses that stays answered is chosen, whatever of the rest is noticed.

    Parameters
    ----------
    share: of the sweeps of one touch held out that are to be told as such.

    Attributes
    ----------
    told_: features looked at, shape (told,). parting_: the fitted pipeline. limit_: exp of the
    largest decision that is no novelty.
    """

    def __init__(self, share=0.99):
        self.share = share

    def fit(
        self,
        X,
        several: NDArray[np.float64],
        *,
        splits: Splits,
        apart: list[NDArray[np.intp]],
        touched: NDArray[np.bool_],
        told: NDArray[np.intp],
    ):
        """Learn what parts several touches from fewer.

        X: sweeps of one touch or none, shape (n, feature). several: those of more, (m, feature).
        splits: sweeps of X to learn from and to hold out; apart: those of `several` to learn from
        beside each. touched: which of X have a touch, (n,). told: features to look at. Returns
        self.
        """
        X = np.asarray(validate_data(self, X, ensure_min_samples=2, dtype=np.float64))
        self.told_ = told
        unseen = []
        for (known, held_out), others in zip(splits, apart, strict=True):
            self.parting_ = _separating_svm(X[known][:, told], several[others][:, told])
            unseen.append(self.away(X[held_out[touched[held_out]]]))
        self.parting_ = _separating_svm(X[:, told], several[:, told])
        self.limit_ = float(np.quantile(np.concatenate(unseen), self.share, method="higher"))
        return self

    def away(self, X: NDArray[np.float64]) -> NDArray[np.float64]:
        """exp of the decision for several touches, shape (n,)."""
        physical_cpu_count()
        return np.exp(self.parting_.decision_function(X[:, self.told_])) if len(X) else np.zeros(0)


def several_guard(samples: Samples, splits: Splits) -> SeveralGuard | None:
    """None where the target is of several touches, no feature is against the skin at rest, or too
    few sweeps show more than one touch.

    splits: sweeps to learn from and to hold out. Sweeps of a session that is held out teach it
    nothing, of several touches neither.
    """
    problem = samples.problem
    if not problem.single_touch or problem.ignores_baseline:
        return None
    here = np.isin(samples.several.sessions, samples.sessions)
    several, sessions = samples.several.X[here], samples.several.sessions[here]
    whole = by_session(samples.sessions)
    apart = [
        np.flatnonzero(~np.isin(sessions, samples.sessions[test]) | (not whole))
        for _, test in splits
    ]
    if min(map(len, apart)) < FEWEST:
        return None
    told, _ = press_features(problem.quantities, problem.features)
    one = problem.continuous or ~np.isin(samples.y.astype(str), NOTHING_PRESSED)
    touched = np.broadcast_to(one, len(samples.X))
    return SeveralGuard().fit(
        samples.X, several, splits=splits, apart=apart, touched=touched, told=told
    )


def _separating_svm(one: NDArray[np.float64], several: NDArray[np.float64]) -> Pipeline:
    """Fit an SVM whose decision is positive for several touches."""
    parts = [_at_most(part) for part in (one, several)]
    is_several = np.repeat([False, True], [len(part) for part in parts])
    machine = make_pipeline(StandardScaler(), SVC(C=PENALTY, class_weight="balanced"))
    return machine.fit(np.concatenate(parts), is_several)


def _at_most(X: NDArray[np.float64]) -> NDArray[np.float64]:
    return X if len(X) <= MOST else X[draw_stratified(np.zeros(len(X)), MOST)]
