"""Adaptation of a localizer by a few labelled touches, of classes or of positions.

It is scored on other touches than those that it learns from.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..simulator.arrays import Real
from ..simulator.sweeps import InputError
from .evaluation.evaluation import ClassScore, PositionScore, Score, join_scores, score
from .inputs.samples import Samples
from .inversion.estimators import MODEL_ADAPTED, MODEL_BASED, estimators
from .learners.drift import affine_correction, class_offsets
from .model.localizer_model import Model
from .parts.predictor import Chain
from .trust.answers import NOTHING_PRESSED, threshold_of
from .trust.fitted import Classifier, Guards, Regressor, with_known_baseline
from .trust.folds import describe_splits, splits_of
from .trust.temperature import probabilities, sharpness_of

MIN_TOUCHES_PER_CLASS = 2
"""Minimum number of touches of each class: one trains while another is scored."""
ACCEPTED_SHARE = 0.98
"""Share of the training touches that a widened guard accepts."""
FOLDS = 5
PRIOR_SWEEPS = 50
"""Weight of the training's sharpness, as a number of sweeps."""
FINE_TUNED = (MODEL_BASED, MODEL_ADAPTED)
"""Estimators that are trained again, and fine-tuned by the touches."""


@dataclass(frozen=True, eq=False)
class Adaptation:
    """The adapted model, with its scores before and after adaptation.

    model: adapted by all touches. before, after: scores on the same touches; each is scored after
    adaptation by other touches. validation: how the scored touches were held out. notes: remarks
    for the user.
    """

    model: Model
    before: Score
    after: Score
    validation: str
    notes: tuple[str, ...] = ()


def adapt_classes(model: Model, samples: Samples) -> Adaptation:
    """Adapt the model by all of the samples, which are of the skin to be localized on.

    samples: from `Model.samples`. Raises InputError for models that were adapted before, labels
    that the model does not know, and fewer than MIN_TOUCHES_PER_CLASS sweeps of one of its classes.
    """
    learned = checked_classifier(model, samples)
    splits = splits_of(samples.strata, samples.sessions, FOLDS)
    parts = [(samples.part(train), samples.part(test)) for train, test in splits]
    fitted_folds = [(fine_tuned(model, learned, train), test) for train, test in parts]
    held_out = [(each.predictor.decisions(test.X), test.y) for each, test in fitted_folds]
    whole = fine_tuned(model, learned, samples)
    index = np.concatenate([np.searchsorted(whole.classes, y) for _, y in held_out])
    decided = np.concatenate([each for each, _ in held_out])
    sharpness = _shrunk_sharpness(sharpness_of(decided, index), learned.sharpness, index.size)
    probability = probabilities(decided, sharpness)
    right = probability.argmax(axis=1) == index
    threshold, notes = _threshold(model, learned, probability.max(axis=1), right)
    found = {"sharpness": sharpness, "threshold": threshold}
    after = join_scores([score(replace(each, **found), test) for each, test in fitted_folds])
    before = join_scores([score(learned, test) for _, test in parts])
    assert isinstance(before, ClassScore) and isinstance(after, ClassScore)
    answered = int((probability.max(axis=1) >= threshold).sum())
    counts = {"right": int(right.sum()), "answered": answered, "held_out": right.size}
    validation = (
        f"{describe_splits(splits, samples.sessions)}, of {right.size} sweeps of the skin at hand"
    )
    better = replace(whole, **found, **counts)
    better = replace(model, learned=better, validation=validation, adapted=True)
    return Adaptation(better, before, after, validation, notes)


def checked_classifier(model: Model, samples: Samples) -> Classifier:
    """The model's classifier, if these samples can adapt it. Raises InputError as `adapted`."""
    learned = model.learned
    assert isinstance(learned, Classifier)
    if model.adapted:
        raise InputError(
            "the model was adapted before: adapt the original model by all touches, old and new"
        )
    known, counts = np.unique(samples.y, return_counts=True)
    unknown = np.setdiff1d(known, learned.classes)
    if unknown.size:
        raise InputError(
            f"{model.target} {unknown[0]} was touched, but it is no class of the model"
        )
    met = dict(zip(known.tolist(), counts.tolist(), strict=True))
    needed = known if model.estimator in FINE_TUNED else learned.classes
    few = [
        (each, met.get(each, 0))
        for each in needed.tolist()
        if met.get(each, 0) < MIN_TOUCHES_PER_CLASS
    ]
    if few:
        others = f" (and {len(few) - 1} more)" if len(few) > 1 else ""
        label, got = few[0]
        missing = "the unpressed skin" if str(label) in NOTHING_PRESSED else label
        raise InputError(
            f"needs at least {MIN_TOUCHES_PER_CLASS} sweeps of each {model.target}, got "
            f"{got} of {missing}{others}"
        )
    return learned


def fine_tuned(model: Model, learned: Classifier, samples: Samples) -> Classifier:
    """Classifier fine-tuned by these samples; the sharpness is not changed."""
    guards = learned.guards and widened_guards(learned.guards, samples)
    predictor = learned.predictor
    if isinstance(predictor, Chain):
        index = np.searchsorted(learned.classes, samples.y)
        offsets = class_offsets(predictor.decisions(samples.X), index, learned.sharpness)
        predictor = predictor.then(offsets)
    else:
        fit = estimators()[model.estimator].fit
        predictor = fit(model.problem, samples.X, samples.y, learn="skin")
    return replace(learned, predictor=predictor, guards=guards)


def widened_guards(guards: Guards, samples: Samples) -> Guards:
    """Guards that accept most of these sweeps."""
    own, changes = _wider(guards, samples.X), guards.changes
    if changes is None or samples.changes is None:
        return own
    known = with_known_baseline(samples.changes)
    return replace(own, changes=_wider(changes, samples.changes[known]) if known.size else changes)


def _wider(guards: Guards, X: Real) -> Guards:
    kinds = guards.kinds
    reach = float(np.quantile(kinds.distances(X), ACCEPTED_SHARE, method="lower"))
    return replace(guards, kinds=replace(kinds, limit=kinds.limit * max(1.0, reach)))


def _shrunk_sharpness(found: float, before: float, count: int) -> float:
    """Geometric mean of the new sharpness, of weight `count`, and the old one of PRIOR_SWEEPS."""
    share = count / (count + PRIOR_SWEEPS)
    return float(np.exp(share * np.log(found) + (1 - share) * np.log(before)))


def _threshold(
    model: Model, learned: Classifier, probability: NDArray, right: NDArray
) -> tuple[float, tuple[str, ...]]:
    if model.certain is None:
        return 0.0, ()
    try:
        return threshold_of(probability, right, model.certain), ()
    except InputError:
        return learned.threshold, (
            f"too few sweeps for a new threshold at which answers are right at a rate of "
            f"{model.certain:g}: the old threshold, probability {learned.threshold:.3f}, is kept",
        )


MIN_TOUCHES = 6
"""Minimum number of touches: some in each direction, and some to score."""


def adapt_positions(model: Model, samples: Samples, counted: Samples | None = None) -> Adaptation:
    """Adapt the model by all of the samples, which are of the skin to be localized on.

    samples: from `Model.samples`. counted: samples of the same sweeps for the model's gate, if it
    has one, whose guards are widened to accept them. Raises InputError for models that invert the
    simulator or were adapted before, and for fewer than MIN_TOUCHES touches.
    """
    learned, predictor = _checked(model, samples)
    splits = splits_of(None, samples.sessions, FOLDS)
    parts = [(samples.part(train), samples.part(test)) for train, test in splits]
    fitted_folds = [(_fine_tuned(learned, predictor, train), test) for train, test in parts]
    after, before = (
        join_scores([score(each, test) for each, test in pairs])
        for pairs in (fitted_folds, [(learned, test) for _, test in parts])
    )
    assert isinstance(after, PositionScore) and isinstance(before, PositionScore)
    factor = learned.factor * _deviation_correction(after)
    after = replace(after, deviation=after.deviation * _deviation_correction(after))
    median = float(np.median(after.distance))
    better = _fine_tuned(learned, predictor, samples)
    better = replace(better, factor=factor, median_error=median)
    held_out = describe_splits(splits, samples.sessions)
    validation = f"{held_out}, of {len(samples.X)} touches of the skin at hand"
    gate = model.gate
    if gate is not None and counted is not None:
        widened = _widened(gate.learned.guards, counted)
        gate = replace(gate, learned=replace(gate.learned, guards=widened))
    found = replace(model, learned=better, gate=gate, validation=validation, adapted=True)
    return Adaptation(found, before, after, validation)


def _checked(model: Model, samples: Samples) -> tuple[Regressor, Chain]:
    learned, predictor = model.learned, model.predictor
    assert isinstance(learned, Regressor)
    if model.estimator in FINE_TUNED:
        raise InputError(
            f"a model of positions by {model.estimator} cannot be adapted: calibrate its scene by "
            "these touches, then train a new model"
        )
    if model.adapted:
        raise InputError(
            "the model was adapted before: adapt the original model by all touches, old and new"
        )
    if len(samples.X) < MIN_TOUCHES:
        raise InputError(
            f"needs at least {MIN_TOUCHES} touches of known place, got {len(samples.X)}"
        )
    assert isinstance(predictor, Chain)
    return learned, predictor


def _fine_tuned(learned: Regressor, predictor: Chain, samples: Samples) -> Regressor:
    correction = affine_correction(predictor.positions(samples.X)[0], samples.y)
    guards = _widened(learned.guards, samples)
    return replace(learned, predictor=predictor.then(correction), guards=guards)


def _widened(guards: Guards | None, samples: Samples) -> Guards | None:
    return guards and widened_guards(guards, samples)


def _deviation_correction(after: PositionScore) -> np.ndarray:
    """Factor by which deviations were too small, shrunk towards 1 for few touches, (3,)."""
    off = np.square((after.predicted - after.truth) / np.maximum(after.deviation, 1e-9)).mean(
        axis=0
    )
    share = len(after.truth) / (len(after.truth) + PRIOR_SWEEPS)
    return np.exp(share * np.log(np.maximum(off, 1e-4)) / 2)
