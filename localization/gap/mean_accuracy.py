"""How often a localizer is right that was trained on one side or both, tested on the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from sklearn import config_context

from ...simulator.sweeps import InputError
from ..evaluation.confusion import Confusion, compare, over_folds
from ..evaluation.evaluation import UNCHECKED
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
"""From the hardest test to the easiest; the first that the sweeps allow is taken."""


@dataclass(frozen=True, eq=False)
class MeanAccuracy:
    """Fraction right: mean and standard deviation over the draws of what is added and tested.

    confusion: of all draws together.
    """

    mean: float
    spread: float
    draws: int
    confusion: Confusion


@dataclass(frozen=True, eq=False)
class CrossValidated:
    """grouping: what is left out as a whole, None for single sweeps."""

    accuracy: MeanAccuracy
    grouping: str | None
    folds: int


def transfer_accuracy(
    simulated: PairedSamples, other: PairedSamples, splits: Sequence[Split], estimator: Estimator
) -> MeanAccuracy:
    """Trained on all that is simulated and on what a split adds, tested on what it tests."""
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
    """Trained and tested on the same side; None where it has too few sweeps of a class.

    grouped: by the first of GROUPINGS that leaves every class in every training; else by none.
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
    """What a localizer that is trained on the ones tells of the others."""
    training = training.chosen(training.has_features)
    with config_context(**UNCHECKED):
        trained = estimator.build(training.problem).fit(training.X, training.y)
        return trained.predict(test.X)


def _over_folds(
    samples: PairedSamples, folds: Sequence[tuple[NDArray, NDArray]], estimator: Estimator
) -> MeanAccuracy:
    with config_context(**UNCHECKED):
        untrained = estimator.build(samples.problem)
        confusion = over_folds(untrained, samples.X, samples.y, folds)
    return MeanAccuracy(confusion.accuracy, 0.0, 1, confusion)


def mean_over_draws(outcomes: Sequence[Confusion]) -> MeanAccuracy:
    """Mean and spread, and all counted together."""
    values = [outcome.accuracy for outcome in outcomes]
    return MeanAccuracy(
        mean=float(np.mean(values)),
        spread=float(np.std(values, ddof=1)) if len(values) > 1 else 0.0,
        draws=len(values),
        confusion=_pooled(outcomes),
    )


def _pooled(outcomes: Sequence[Confusion]) -> Confusion:
    """All counted together; draws need not have met the same classes."""
    rows = [row for outcome in outcomes for row in outcome.table()]
    counts = [count for *_, count in rows]
    targets, outputs = (np.repeat([row[side] for row in rows], counts) for side in (0, 1))
    return compare(targets, outputs)
