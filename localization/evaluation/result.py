"""Result of an evaluation, for the command's report and for scripts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ...simulator.report.findings import Findings, Result
from ...simulator.sweeps import InputError
from ..trust.answers import ONE_TOUCH
from .evaluation import (
    ANSWERED,
    MEDIAN_ERROR,
    RIGHT_OF_ALL,
    RIGHT_OF_ANSWERED,
    ClassScore,
    Nested,
    Score,
    score,
)

if TYPE_CHECKING:
    from ..inputs.samples import Samples
    from ..trust.answers import Answers
    from ..trust.fitted import Classifier, Regressor

Figures = Mapping[str, tuple[float, float | None]]
"""Value of each figure by name, and its spread over folds if there are any."""


@dataclass(frozen=True, eq=False, repr=False)
class Evaluation(Result):
    """Accuracy of a localizer on sweeps whose presses are known.

    score: predictions and truth of each sweep. target: predicted target. figures: value of each
    figure by name, and its spread over folds if there are any. validation: text on how the sweeps
    were scored. left_out: text on the sweeps that were left out. sessions: number of those of the
    sweeps; few say little on other skins.
    """

    score: Score
    target: str
    figures: Figures
    validation: str
    left_out: str
    sessions: int

    def __getitem__(self, name: str) -> float:
        """A figure by its name. Raises InputError that lists the existing names."""
        if name not in self.figures:
            raise InputError(
                f"an evaluation of `target` {self.target} has no figure {name!r}, "
                f"only {', '.join(self.figures)}"
            )
        return self.figures[name][0]

    @property
    def accuracy(self) -> float:
        """Share of all sweeps with a right answer. Raises InputError for positions."""
        return self[RIGHT_OF_ALL]

    @property
    def answered(self) -> float:
        """Share of sweeps that were answered."""
        return self[ANSWERED]

    @property
    def accuracy_of_answers(self) -> float:
        """Share of the answered that are right. Raises InputError if nothing was answered."""
        return self[RIGHT_OF_ANSWERED]

    @property
    def calibration_error(self) -> float:
        """Expected difference of stated probability and accuracy. Raises as `accuracy`."""
        return self["calibration error"]

    @property
    def median_error(self) -> float:
        """Median distance of an answered position from its touch, m.

        Raises InputError for classes, and if nothing was answered.
        """
        return 1e-3 * self[MEDIAN_ERROR]

    @property
    def report(self) -> Findings:
        """The figures, and a chart of rates or errors."""
        from .report import report_of

        return report_of(self)


def evaluated(learned: Classifier | Regressor, samples: Samples, answers: Answers) -> Evaluation:
    """Evaluate a trained localizer on samples that it was not trained on.

    answers: of its model, to all sweeps from which the samples are. Sweeps with a reading that is
    no finite number count as not answered.
    """
    scored, own = score(learned, samples), answers.part(samples.rows)
    unread = samples.left_out.not_finite
    if isinstance(scored, ClassScore):
        scored = replace(scored, answers=own, unread=unread)
    else:
        scored = replace(scored, answered=own.labels == ONE_TOUCH, unread=unread)
    figures = {name: (value, None) for name, value in scored.figures().items()}
    return _evaluation(samples, scored, figures, "scored by the model as it is")


def evaluated_by_folds(samples: Samples, found: Nested) -> Evaluation:
    """Evaluation of an estimator on the parts of samples that were held out in turn."""
    return _evaluation(samples, found.whole, found.figures(), found.validation)


def _evaluation(samples: Samples, scored: Score, figures: Figures, validation: str) -> Evaluation:
    target = samples.problem.target
    left_out = samples.left_out.describe(target)
    sessions = len(set(samples.sessions))
    return Evaluation(scored, target, figures, validation, left_out, sessions)
