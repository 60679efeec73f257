"""Training of a localizer, with tuning of its parameters within the training sweeps."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import Any

import numpy as np

from ..inputs.samples import Samples
from ..learners.registry import Estimator
from ..parts.predictor import Predictor
from .folds import splits_of

Train = Callable[[Samples], Predictor]


def trainer(estimator: Estimator, *, tune: bool) -> Train:
    """Returns a function that trains the localizer on samples.

    tune: True also tunes its parameters on them.

    The function raises InputError if there are no two folds to tune on.
    """

    def train(some: Samples) -> Predictor:
        few = some.subsampled(estimator.max_sweeps)
        return _fitted(estimator, few, _best(estimator, few) if tune else {})

    return train


def _fitted(estimator: Estimator, samples: Samples, parameters: dict[str, Any]) -> Predictor:
    return estimator.fit(samples.problem, samples.X, samples.y, **parameters)


def _best(estimator: Estimator, samples: Samples) -> dict[str, Any]:
    """The parameters of the grid with the best mean score of held-out sweeps; ties: the first."""
    grid = estimator.grid_for(samples.problem)
    choices = [dict(zip(grid, values, strict=True)) for values in product(*grid.values())]
    if len(choices) == 1:
        return choices[0]
    splits = splits_of(_shared(samples.strata), samples.sessions, folds=3)
    parts = [(samples.part(train), samples.part(test)) for train, test in splits]
    scores = [
        np.mean([_score(_fitted(estimator, train, chosen), test) for train, test in parts])
        for chosen in choices
    ]
    return choices[int(np.argmax(scores))]


def _shared(strata: np.ndarray | None) -> np.ndarray | None:
    """The strata if every fold can have sweeps of each, else None."""
    few = strata is not None and np.unique(strata, return_counts=True)[1].min() < 2
    return None if few else strata


def _score(predictor: Predictor, samples: Samples) -> float:
    """Accuracy, or minus the mean distance in mm."""
    found = predictor.predict(samples.X)
    if not samples.problem.continuous:
        return float((found == samples.y).mean())
    return -float(np.linalg.norm((found - samples.y)[:, :2], axis=1).mean())
