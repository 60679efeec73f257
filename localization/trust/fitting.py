"""Training of a localizer: predictor, then probabilities and deviations on held-out sweeps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...simulator.arrays import Real
from ...simulator.progress import ProgressCallback, silent, tracked
from ...simulator.sweeps import InputError
from ..inputs.samples import Samples, as_changes
from ..learners.classifiers import standardized
from ..learners.registry import Estimator
from ..parts.parts import NearestErrors
from ..parts.predictor import Predictor
from .answers import independent_sweeps, threshold_of
from .fitted import Classifier, Guards, Regressor, with_known_baseline
from .folds import PLENTY, Splits, held_out_indices, scoring_splits
from .held_out import held_out_decisions, held_out_positions
from .kinds import kind_guard
from .several import several_guard
from .temperature import probabilities, sharpness_of
from .tuning import Train, trainer

NEIGHBOURS, RESIDUALS = 50, 5000
"""Number of errors whose root mean square is a deviation, and of errors kept in all."""
MIN_BASELINE_SWEEPS = 10
"""Minimum number of sweeps with a baseline to fit guards of changes to, and to score them by."""
WHOLE_FIT = np.arange(0), np.arange(0)
"""Placeholder for the fit to all sweeps, which progress counts together with the splits."""


def learn_classes(
    samples: Samples,
    estimator: Estimator,
    *,
    certain: float | None = None,
    tune: bool = False,
    progress: ProgressCallback = silent,
) -> Classifier:
    """Train a classifier, and fit its sharpness and threshold to held-out sweeps.

    certain: the rate at which answers are to be right; None answers always. progress: callback for
    the fits. Raises InputError if the samples are of one class, and as `scoring_splits` and
    `threshold_of` do.
    """
    if np.unique(samples.y).size < 2:
        raise InputError(f"need sweeps of at least 2 classes, got {np.unique(samples.y).size}")
    samples = samples.first_sessions(estimator.max_sessions)
    splits = scoring_splits(samples.strata, samples.sessions)
    train = trainer(estimator, tune=tune)
    fits = iter(tracked([WHOLE_FIT, *splits], f"training {estimator.name}", progress))
    next(fits)
    predictor = train(samples)
    classes = np.asarray(predictor.classes)
    scored = held_out_indices(splits)
    again = _retrained(train, estimator, predictor)
    held_out = held_out_decisions(again, samples, fits, scored, classes)
    index = np.searchsorted(classes, samples.y[scored])
    sharpness = sharpness_of(held_out, index)
    probability = probabilities(held_out, sharpness)
    right = probability.argmax(axis=1) == index
    best = probability.max(axis=1)
    threshold = 0.0 if certain is None else threshold_of(best, right, certain)
    return Classifier(
        predictor,
        _guards(samples, splits, estimator, predictor),
        sharpness,
        threshold,
        right=int(right.sum()),
        answered=int((best >= threshold).sum()),
        held_out=len(right),
        independent=independent_sweeps(right, samples.sessions[scored]),
    )


def learn_positions(
    samples: Samples,
    estimator: Estimator,
    *,
    tune: bool = False,
    progress: ProgressCallback = silent,
) -> Regressor:
    """Train a regressor, and fit its deviations to held-out sweeps.

    progress: callback for the fits. Raises InputError as `scoring_splits` does.
    """
    samples = samples.first_sessions(estimator.max_sessions)
    splits = scoring_splits(None, samples.sessions)
    held_out = held_out_indices(splits)
    train = trainer(estimator, tune=tune)
    fits = iter(tracked([WHOLE_FIT, *splits], f"training {estimator.name}", progress))
    next(fits)
    predictor = train(samples)
    again = _retrained(train, estimator, predictor)
    predicted, deviation = held_out_positions(again, samples, fits)
    predicted, residual = predicted[held_out], (predicted - samples.y)[held_out]
    factor, spread = np.ones(predicted.shape[1]), None
    if deviation is None:
        spread = _spread(predicted, residual)
    else:
        deviation = deviation[held_out]
        z = np.divide(residual, deviation, out=np.zeros(predicted.shape), where=deviation > 0)
        factor = np.sqrt(np.square(z).mean(axis=0))
    median = float(np.median(np.linalg.norm(residual[:, :2], axis=1)))
    guards = _guards(samples, splits, estimator, predictor)
    return Regressor(predictor, guards, factor, spread, median)


def _retrained(train: Train, estimator: Estimator, whole: Predictor) -> Train:
    """Training on a part of the sweeps; that of all if it does not depend on sweeps."""
    return train if estimator.uses_sweeps else lambda part: whole


def _spread(predicted: Real, residual: Real) -> NearestErrors:
    """The variance of errors as the mean over the nearest positions of held-out sweeps."""
    kept = np.random.default_rng(0).permutation(len(predicted))[:RESIDUALS]
    scaling, squares = standardized(predicted[kept]), np.square(residual[kept])
    return NearestErrors(scaling, scaling(predicted[kept]), squares, min(NEIGHBOURS, len(kept)))


def _guards(
    samples: Samples, splits: Splits, estimator: Estimator, predictor: Predictor
) -> Guards | None:
    """Guards, fitted to sweeps with synthetic drift; None if it detects novelties itself."""
    if predictor.detects_novelty:
        return None
    drifted = replace(samples, X=estimator.drifted(samples.problem, samples.X))
    changes = _guards_of_changes(samples, splits)
    return replace(_guards_of(drifted, splits), changes=changes)


def _guards_of(samples: Samples, splits: Splits) -> Guards:
    some = samples.subsampled(PLENTY)
    own = splits if some is samples else scoring_splits(some.strata, some.sessions)
    return Guards(kind_guard(some, own), several_guard(samples, splits))


def _guards_of_changes(samples: Samples, splits: Splits) -> Guards | None:
    """Guards of changes from the baseline; None if too few sweeps have a baseline."""
    if samples.changes is None:
        return None
    known = with_known_baseline(samples.changes)
    parts = [[np.flatnonzero(np.isin(known, part)) for part in split] for split in splits]
    if min(part.size for split in parts for part in split) < MIN_BASELINE_SWEEPS:
        return None
    return _guards_of(as_changes(samples).part(known), [(a, b) for a, b in parts])
