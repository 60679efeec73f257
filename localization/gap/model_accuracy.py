"""Accuracy of the user's own model on the other side's sweeps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...simulator.sweeps import InputError
from ..adaptation.class_adaptation import checked_classifier, fine_tuned
from ..evaluation.evaluation import ClassScore, score
from ..inputs.samples import Samples as Learnable
from ..model.localizer_model import Model
from ..trust.fitted import Classifier, Regressor
from .mean_accuracy import MeanAccuracy, mean_over_draws
from .paired_samples import PairedSamples
from .splits import Split

MODEL_FEATURES = "model"
"""Name of the set of features of the model."""


def model_accuracies(
    model: Model, other: PairedSamples, splits: Mapping[int, Sequence[Split]]
) -> tuple[dict[int, MeanAccuracy], list[str]]:
    """Accuracy by number of sweeps of every pixel that adapted the model; and notes.

    0 sweeps: the model as it is. A note says which number of sweeps was not possible, and why.
    """
    found, notes = {}, []
    for k, some in splits.items():
        try:
            scores = [_outcome(model, other, split, adapt=k > 0) for split in some]
            found[k] = mean_over_draws([each.confusion for each in scores])
        except InputError as error:
            notes.append(f"The model is not adapted by k = {k}: {error}.")
    return found, notes


def scored(model: Model, other: PairedSamples) -> ClassScore:
    """Score of the model as it is, with its probabilities."""
    return _scored(model.learned, other)


def _outcome(model: Model, other: PairedSamples, split: Split, *, adapt: bool) -> ClassScore:
    learned = model.learned
    if adapt:
        touches = _learnable(other.chosen(split.added))
        learned = fine_tuned(model, checked_classifier(model, touches), touches)
    return _scored(learned, other.chosen(split.tested))


def _scored(learned: Classifier | Regressor, samples: PairedSamples) -> ClassScore:
    found = score(learned, _learnable(samples))
    assert isinstance(found, ClassScore)
    return found


def _learnable(samples: PairedSamples) -> Learnable:
    every = np.arange(len(samples.y))
    return Learnable(samples.problem, samples.X, samples.y, np.zeros_like(every), every)
