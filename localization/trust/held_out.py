"""Predictions for held-out sweeps."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray
from sklearn.pipeline import Pipeline

from ...simulator.arrays import Real
from ..inputs.samples import Samples
from ..learners.decisions import decisions
from .folds import Split


def held_out_decisions(
    train: Callable[[Samples], Pipeline],
    samples: Samples,
    splits: Iterable[Split],
    held_out: NDArray[np.intp],
    classes: NDArray,
) -> Real:
    """Decisions for each sweep and class by a pipeline that was not trained on the sweep.

    held_out: indices of the sweeps of all tests, ascending. A class that a training lacks takes the
    decision of the least likely class. Shape (held out, K).
    """
    decided = np.empty((held_out.size, classes.size))
    for train_on, test in splits:
        pipeline = train(samples.part(train_on))
        found = decisions(pipeline, samples.X[test])
        rows = np.searchsorted(held_out, test)
        places = np.searchsorted(classes, pipeline.classes_)
        decided[rows] = found.min(axis=1, keepdims=True)
        decided[np.ix_(rows, places)] = found
    return decided


def held_out_positions(
    train: Callable[[Samples], Pipeline], samples: Samples, splits: Iterable[Split]
) -> tuple[Real, Real | None]:
    """Positions by a pipeline that was not trained on the sweep, and their deviations.

    Each has shape (n, 3), NaN if a sweep is in no test. The deviations are None if the regressor
    gives none.
    """
    predicted, deviation = np.full((2, *samples.y.shape), np.nan)
    own = False
    for train_on, test in splits:
        pipeline = train(samples.part(train_on))
        own = has_deviation(pipeline)
        if own:
            predicted[test], deviation[test] = pipeline.predict(samples.X[test], return_std=True)
        else:
            predicted[test] = pipeline.predict(samples.X[test])
    return predicted, deviation if own else None


def has_deviation(pipeline: Pipeline) -> bool:
    """True if the last step's `predict` takes `return_std`."""
    return "return_std" in inspect.signature(pipeline[-1].predict).parameters
