"""Adaptation of a model of positions by a few touches at known places."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...simulator.sweeps import InputError
from ..evaluation.evaluation import PositionScore, join_scores, score
from ..inputs.samples import Samples
from ..learners.drift import affine_correction
from ..model.localizer_model import Model
from ..parts.predictor import Chain
from ..trust.fitted import Guards, Regressor
from ..trust.folds import describe_splits, splits_of
from .class_adaptation import FINE_TUNED, FOLDS, PRIOR_SWEEPS, Adaptation, widened_guards

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
