"""A model of the user's own, asked of the other side in place of localizers trained for it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...simulator.sweeps import InputError
from ..adaptation.class_adaptation import checked, taught
from ..evaluation.evaluation import ClassScore, score
from ..inputs.samples import Samples as Learnable
from ..model.localizer_model import Model
from ..trust.fitted import Classifier, Regressor
from .mean_accuracy import MeanAccuracy, mean_over_draws
from .paired_samples import PairedSamples
from .splits import Split

MODEL_FEATURES = "model"
"""Name of the set of features that it looks at."""


def model_accuracies(
    model: Model, other: PairedSamples, splits: Mapping[int, Sequence[Split]]
) -> tuple[dict[int, MeanAccuracy], list[str]]:
    """By how many sweeps of every pixel adapted it, 0 as it is; and what could not be had."""
    found, notes = {}, []
    for k, some in splits.items():
        try:
            scores = [_outcome(model, other, split, adapt=k > 0) for split in some]
            found[k] = mean_over_draws([each.confusion for each in scores])
        except InputError as error:
            notes.append(f"The model is not adapted by k = {k}: {error}.")
    return found, notes


def scored(model: Model, other: PairedSamples) -> ClassScore:
    """What the model as it is tells of sweeps, with its probabilities."""
    return _scored(model.learned, other)


def _outcome(model: Model, other: PairedSamples, split: Split, *, adapt: bool) -> ClassScore:
    learned = model.learned
    if adapt:
        touches = _learnable(other.chosen(split.added))
        learned = taught(model, checked(model, touches), touches)
    return _scored(learned, other.chosen(split.tested))


def _scored(learned: Classifier | Regressor, samples: PairedSamples) -> ClassScore:
    found = score(learned, _learnable(samples))
    assert isinstance(found, ClassScore)
    return found


def _learnable(samples: PairedSamples) -> Learnable:
    every = np.arange(len(samples.y))
    return Learnable(samples.problem, samples.X, samples.y, np.zeros_like(every), every)
