"""Predictions for held-out sweeps."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Real
from ..inputs.samples import Samples
from .folds import Split
from .tuning import Train


def held_out_decisions(
    train: Train,
    samples: Samples,
    splits: Iterable[Split],
    held_out: NDArray[np.intp],
    classes: NDArray,
) -> Real:
    """Decisions for each sweep and class by a predictor that was not trained on the sweep.

    held_out: indices of the sweeps of all tests, ascending. A class that a training lacks takes the
    decision of the least likely class. Shape (held out, K).
    """
    decided = np.empty((held_out.size, classes.size))
    for train_on, test in splits:
        predictor = train(samples.part(train_on))
        found = predictor.decisions(samples.X[test])
        rows = np.searchsorted(held_out, test)
        places = np.searchsorted(classes, np.asarray(predictor.classes))
        decided[rows] = found.min(axis=1, keepdims=True)
        decided[np.ix_(rows, places)] = found
    return decided


def held_out_positions(
    train: Train, samples: Samples, splits: Iterable[Split]
) -> tuple[Real, Real | None]:
    """Positions by a predictor that was not trained on the sweep, and their deviations.

    Each has shape (n, 3), NaN if a sweep is in no test. The deviations are None if the regressor
    gives none.
    """
    predicted, deviation = np.full((2, *samples.y.shape), np.nan)
    own = None
    for train_on, test in splits:
        predicted[test], own = train(samples.part(train_on)).positions(samples.X[test])
        if own is not None:
            deviation[test] = own
    return predicted, None if own is None else deviation
