"""Accuracy of localizers trained on one side or both and tested on the other."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.sweeps import InputError
from ..evaluation.confusion import Confusion, compare, over_folds, together
from ..evaluation.evaluation import unchecked
from ..learners.registry import Estimator
from ..trust.folds import folds_of
from .paired_samples import PairedSamples
from .splits import Split

if TYPE_CHECKING:
    from collections.abc import Sequence

    import xarray as xr
    from numpy.typing import NDArray

FOLDS = 5
GROUPINGS = ("session", "press", None)
"""Groupings from the hardest test to the easiest; the first possible one is used."""


@dataclass(frozen=True, eq=False)
class MeanAccuracy:
    """Mean accuracy and its standard deviation over draws of added and tested sweeps.

    confusion: confusion of all draws together.
    """

    mean: float
    spread: float
    draws: int
    confusion: Confusion


@dataclass(frozen=True, eq=False)
class CrossValidated:
    """Accuracy by cross-validation.

    grouping: what is left out as a whole, None for single sweeps.
    """

    accuracy: MeanAccuracy
    grouping: str | None
    folds: int


def transfer_accuracy(
    simulated: PairedSamples, other: PairedSamples, splits: Sequence[Split], estimator: Estimator
) -> MeanAccuracy:
    """Accuracy after training on all simulated sweeps and those that a split adds."""
    outcomes = []
    for added, tested in splits:
        training = simulated.joined(other.chosen(added))
        test = other.chosen(tested[other.has_features[tested]])
        outcomes.append(compare(test.y, predictions(training, test, estimator)))
    return mean_over_draws(outcomes)


def cross_validated(
    sweeps: xr.Dataset,
    samples: PairedSamples,
    estimator: Estimator,
    seed: int,
    grouped: bool = True,
) -> CrossValidated | None:
    """Cross-validated accuracy of one side; None if a class has too few sweeps.

    grouped: by the first of GROUPINGS with which every training contains every class; else
    ungrouped.
    """
    for grouping in GROUPINGS if grouped else (None,):
        groups = np.unique(sweeps["session"].values).size if grouping == "session" else FOLDS
        least = int(np.unique(samples.y, return_counts=True)[1].min())
        folds = min(FOLDS, groups, least)
        try:
            found = folds_of(sweeps, samples.y, folds=folds, grouping=grouping, seed=seed)
        except InputError:
            continue
        return CrossValidated(_over_folds(samples, found, estimator), grouping, folds)
    return None


def predictions(training: PairedSamples, test: PairedSamples, estimator: Estimator) -> NDArray:
    """Predictions for the test sweeps by a localizer trained on the others."""
    training = training.chosen(training.has_features)
    with unchecked():
        return estimator.fit(training.problem, training.X, training.y).predict(test.X)


def _over_folds(
    samples: PairedSamples, folds: Sequence[tuple[NDArray, NDArray]], estimator: Estimator
) -> MeanAccuracy:
    with unchecked():
        fit = partial(estimator.fit, samples.problem)
        confusion = over_folds(fit, samples.X, samples.y, folds)
    return MeanAccuracy(confusion.accuracy, 0.0, 1, confusion)


def mean_over_draws(outcomes: Sequence[Confusion]) -> MeanAccuracy:
    """Mean and spread of the accuracy, and the counts of all draws together."""
    values = [outcome.accuracy for outcome in outcomes]
    return MeanAccuracy(
        mean=float(np.mean(values)),
        spread=float(np.std(values, ddof=1)) if len(values) > 1 else 0.0,
        draws=len(values),
        confusion=together(outcomes),
    )
