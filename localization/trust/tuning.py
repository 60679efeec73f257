"""Tuning of hyper-parameters by cross-validation within the training sweeps."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np
from sklearn.exceptions import ConvergenceWarning
from sklearn.model_selection import GridSearchCV
from sklearn.pipeline import Pipeline

from ..inputs.samples import LocalizationProblem, Samples
from ..learners.registry import Estimator
from .folds import splits_of


def trainer(estimator: Estimator, *, tune: bool) -> Callable[[Samples], Pipeline]:
    """Returns a function that trains the localizer on samples.

    tune: True also tunes its parameters on them.

    The function raises InputError if there are no two folds to tune on.
    """

    def train(some: Samples) -> Pipeline:
        few = some.subsampled(estimator.max_sweeps)
        chosen = _best(estimator, few) if tune else {}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ConvergenceWarning)  # a kernel's parameter at its bound
            return estimator.build(some.problem).set_params(**chosen).fit(few.X, few.y)

    return train


def _best(estimator: Estimator, samples: Samples) -> dict[str, object]:
    grid = estimator.grid_for(samples.problem)
    if not grid:
        return {}
    search = GridSearchCV(
        estimator.build(samples.problem),
        dict(grid),
        scoring=_score(samples.problem),
        cv=splits_of(_shared(samples.strata), samples.sessions, folds=3),
        refit=False,
    ).set_params(error_score="raise")
    return search.fit(samples.X, samples.y).best_params_


def _shared(strata: np.ndarray | None) -> np.ndarray | None:
    """The strata if every fold can have sweeps of each, else None."""
    few = strata is not None and np.unique(strata, return_counts=True)[1].min() < 2
    return None if few else strata


def _score(problem: LocalizationProblem) -> Callable[..., float]:
    return _minus_distance if problem.continuous else _accuracy


def _accuracy(pipeline: Pipeline, X: np.ndarray, y: np.ndarray) -> float:
    return float((pipeline.predict(X) == y).mean())


def _minus_distance(pipeline: Pipeline, X: np.ndarray, y: np.ndarray) -> float:
    """Minus the mean distance in mm."""
    away = pipeline.predict(X)[:, :2] - y[:, :2]
    return -float(np.linalg.norm(away, axis=1).mean())
