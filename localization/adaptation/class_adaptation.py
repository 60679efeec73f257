"""Adaptation of a classifier by a few labelled touches; scored on other touches."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Real
from ...simulator.sweeps import InputError
from ..evaluation.evaluation import ClassScore, Score, join_scores, score
from ..inputs.samples import Samples
from ..inversion.estimators import MODEL_ADAPTED, MODEL_BASED, estimators
from ..learners.drift import class_offsets
from ..model.localizer_model import Model
from ..parts.predictor import Chain
from ..trust.answers import NOTHING_PRESSED, threshold_of
from ..trust.fitted import Classifier, Guards, with_known_baseline
from ..trust.folds import describe_splits, splits_of
from ..trust.temperature import probabilities, sharpness_of

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
