"""A model of the user's own, asked of the other side in place of localizers trained for it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...simulator.sweeps import InputError
from ..adaptation.adaptation import checked, taught
from ..evaluation.evaluation import ClassScore, score
from ..inputs.samples import Samples as Learnable
from ..model.model import Model
from .accuracy import Accuracy, over_draws
from .samples import Samples
from .splits import Split

BY_MODEL = "model"
"""Name of the set of features that it looks at."""


@dataclass(frozen=True, eq=False)
class Asked:
    model: Model

    def accuracies(
        self, other: Samples, splits: Mapping[int, Sequence[Split]]
    ) -> tuple[dict[int, Accuracy], list[str]]:
        """By how many sweeps of every pixel adapted it, 0 as it is; and what could not be had."""
        found, notes = {}, []
        for k, some in splits.items():
            try:
                found[k] = over_draws(
                    [self._outcome(other, split, adapt=k > 0).confusion for split in some]
                )
            except InputError as error:
                notes.append(f"The model is not adapted by k = {k}: {error}.")
        return found, notes

    def judged(self, other: Samples) -> ClassScore:
        """What the model as it is tells of sweeps, with its probabilities."""
        found = score(self.model.learned, _learnable(other))
        assert isinstance(found, ClassScore)
        return found

    def _outcome(self, other: Samples, split: Split, *, adapt: bool) -> ClassScore:
        learned = self.model.learned
        if adapt:
            touches = _learnable(other.chosen(split.added))
            learned = taught(self.model, checked(self.model, touches), touches)
        found = score(learned, _learnable(other.chosen(split.tested)))
        assert isinstance(found, ClassScore)
        return found


def _learnable(samples: Samples) -> Learnable:
    every = np.arange(len(samples.y))
    return Learnable(samples.problem, samples.X, samples.y, np.zeros_like(every), every)
