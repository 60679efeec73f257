"""Accuracy of a localizer on sweeps that were not used for its training."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.progress import ProgressCallback, silent, tracked
from ...simulator.scene.scene_files import carried_scene
from ...simulator.sweeps import UNPRESSED
from ..inputs.features import Quantities, available_features, chosen_quantities
from ..inputs.samples import Samples, samples_of
from ..inputs.targets import labels
from ..inversion.region import Region, region_of
from ..inversion.regions import PROBABILITY, places_of
from ..learners.classifiers import reference
from ..learners.registry import Estimator
from ..trust.answers import Answers, CountedRate
from ..trust.fitted import Classifier, Regressor
from ..trust.fitting import learn_classes, learn_positions
from ..trust.folds import describe_nested_splits, folds_of, splits_of
from ..trust.temperature import calibration_error
from .confusion import Confusion, compare, over_folds

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from ...simulator.arrays import Integer, Mask, Real

EXAMPLES = 6
"""Number of sweeps whose regions are kept."""
RIGHT_OF_ALL, RIGHT_OF_ANSWERED = "right of all", "right of those answered"
ANSWERED, MEDIAN_ERROR = "answered", "median error, mm"
REGION_FIGURE = f"touches within {100 * PROBABILITY:g} % regions"
__all__ = ["ClassScore", "PositionScore", "cross_validate", "folds_of", "nested"]


@dataclass(frozen=True, eq=False)
class ClassScore:
    """Predictions of a classifier for sweeps that it was not trained on.

    truth, predicted: labels, shape (sweep,); predicted also where the answer was CANNOT_TELL.
    sessions: shape (sweep,). unread: number of further sweeps with a reading that is no finite
    number: none is answered.
    """

    truth: NDArray
    predicted: NDArray
    answers: Answers
    sessions: Integer
    unread: int = 0

    @property
    def right(self) -> Mask:
        """True if the most probable class was the true one, answered or not, shape (sweep,)."""
        return self.truth == self.predicted

    @property
    def confusion(self) -> Confusion:
        """Confusion matrix of truth and answer; its last output is CANNOT_TELL if any is."""
        return compare(self.truth, self.predicted, ~self.answers.answered)

    def rates(self) -> dict[str, CountedRate]:
        """Rates of sweeps: a refusal is no right answer."""
        answered, sessions = self.answers.answered, self.sessions
        return {
            RIGHT_OF_ALL: CountedRate.of(self.right & answered, sessions, self.unread),
            ANSWERED: CountedRate.of(answered, sessions, self.unread),
            RIGHT_OF_ANSWERED: CountedRate.of(self.right[answered], sessions[answered]),
        }

    def figures(self) -> dict[str, float]:
        """Those of `rates` that are of any sweep, and the expected calibration error."""
        found = {name: rate.share for name, rate in self.rates().items() if rate.total}
        error = calibration_error(self.answers.probability, self.right)
        return {**found, "calibration error": error}


SCORE_EXTRAS = ("examples", "unread")
"""Fields of a `PositionScore` that are no arrays by sweep."""


@dataclass(frozen=True, eq=False)
class PositionScore:
    """Predictions of a regressor for sweeps that it was not trained on, (sweep, 3) each.

    Units are mm, mm and factor. content: probability in the smallest region that reaches the touch,
    shape (sweep,). sessions, answered: shape (sweep,); positions are also known where no answer was
    given. examples: regions of some sweeps, by number. unread: see `ClassScore`.
    """

    truth: Real
    predicted: Real
    deviation: Real
    content: Real
    sessions: Integer
    answered: Mask
    examples: Mapping[int, Region]
    unread: int = 0

    @property
    def distance(self) -> Real:
        """Distance between touch and prediction, mm, shape (sweep,)."""
        return np.linalg.norm((self.predicted - self.truth)[:, :2], axis=1)

    @property
    def of_answered(self) -> PositionScore:
        """Score of the answered sweeps alone."""
        arrays = [field.name for field in fields(self) if field.name not in SCORE_EXTRAS]
        number = np.cumsum(self.answered) - 1
        some = {int(number[k]): each for k, each in self.examples.items() if self.answered[k]}
        parts = {name: getattr(self, name)[self.answered] for name in arrays}
        return replace(self, **parts, examples=some)

    def rates(self) -> dict[str, CountedRate]:
        """Those of `figures` that are rates; regions are of the answered sweeps."""
        own = self.of_answered
        return {
            ANSWERED: CountedRate.of(self.answered, self.sessions, self.unread),
            REGION_FIGURE: CountedRate.of(own.content <= PROBABILITY, own.sessions),
        }

    def figures(self) -> dict[str, float]:
        """Rates; errors of the answered sweeps in mm and of the factor, beside their deviations."""
        rates, own = self.rates(), self.of_answered
        found = {ANSWERED: rates[ANSWERED].share}
        if not self.answered.any():
            return found
        away = np.abs(own.predicted - own.truth)
        return {
            **found,
            MEDIAN_ERROR: float(np.median(own.distance)),
            "90 % error, mm": float(np.quantile(own.distance, 0.9)),
            "median error of factor": float(np.median(away[:, 2])),
            "within 1 deviation": float((away <= own.deviation)[:, :2].mean()),
            "within 2 deviations": float((away <= 2 * own.deviation)[:, :2].mean()),
            REGION_FIGURE: rates[REGION_FIGURE].share,
        }


Score = ClassScore | PositionScore


def score(learned: Classifier | Regressor, samples: Samples) -> Score:
    """Score the predictions for samples whose targets are known."""
    if isinstance(learned, Regressor):
        return _position_score(learned, samples)
    answers = learned.answers(samples.X, samples.changes)
    return ClassScore(samples.y, learned.predict(samples.X), answers, samples.sessions)


def _position_score(learned: Regressor, samples: Samples) -> PositionScore:
    scene = carried_scene(samples.problem.scene)
    places = places_of(learned, samples.X, scene and scene.parts.skin)
    pairs = zip(places, samples.y, strict=True)
    content = np.array([each.content(x, y) for each, (x, y, _) in pairs])
    some = np.unique(np.linspace(0, len(places) - 1, EXAMPLES).astype(int)).tolist()
    examples = {k: region_of(places[k], PROBABILITY) for k in some}
    found = learned.positions(samples.X)
    answered = ~learned.novel(samples.X, samples.changes)
    return PositionScore(samples.y, *found, content, samples.sessions, answered, examples)


@dataclass(frozen=True, eq=False)
class Nested:
    """Scores of outer folds, whose sweeps were used for no training, tuning or calibration.

    validation: text on how they were held out. unread: see `ClassScore`.
    """

    folds: tuple[Score, ...]
    validation: str
    unread: int = 0

    @cached_property
    def whole(self) -> Score:
        """Score of all sweeps, each predicted by the fold that did not train on it."""
        return replace(join_scores(self.folds), unread=self.unread)

    def figures(self) -> dict[str, tuple[float, float | None]]:
        """Figures of all sweeps, and their standard deviation over the folds that have them."""
        each = [fold.figures() for fold in self.folds]
        known = {
            name: [found[name] for found in each if name in found] for name in self.whole.figures()
        }
        return {
            name: (value, float(np.std(known[name], ddof=1)) if len(known[name]) > 1 else None)
            for name, value in self.whole.figures().items()
        }


def nested(
    samples: Samples,
    estimator: Estimator,
    *,
    certain: float | None = None,
    tune: bool = False,
    folds: int = 5,
    seed: int = 0,
    progress: ProgressCallback = silent,
) -> Nested:
    """Train, tune and calibrate on all folds but one and score on that one, in turn.

    If there are enough sessions, outer and inner folds hold out whole sessions. progress: callback
    for the folds. Raises InputError as `splits_of` and `learn_classes`.
    """
    splits = splits_of(samples.strata, samples.sessions, folds, seed)
    scores = []
    for train, test in tracked(splits, f"evaluating {estimator.name}", progress):
        some = samples.part(train)
        learned = (
            learn_positions(some, estimator, tune=tune)
            if samples.problem.continuous
            else learn_classes(some, estimator, certain=certain, tune=tune)
        )
        scores.append(score(learned, samples.part(test)))
    held_out = describe_nested_splits(splits, samples.sessions, folds)
    return Nested(tuple(scores), held_out, samples.left_out.not_finite)


def cross_validate(
    sweeps: xr.Dataset,
    target: str = "column",
    *,
    folds: int = 5,
    grouping: str | None = None,
    quantities: Quantities | None = None,
    seed: int = 0,
) -> Confusion:
    """Train on all folds but one and predict that one, in turn: every sweep is predicted once.

    Sweeps before the first sweep of the unpressed skin are left out if features need it. target,
    quantities: see `samples_of`. folds, grouping, seed: see `folds_of`. Raises InputError as
    these do.
    """
    X, rows = available_features(sweeps, chosen_quantities(quantities, sweeps))
    usable = sweeps.isel(sweep=rows)
    y = labels(usable, target)
    splits = folds_of(usable, y, folds=folds, grouping=grouping, seed=seed)
    return over_folds(reference, X, y, splits)


def held_out_accuracies(
    sweeps: xr.Dataset, target: str = "column", unpressed: float | None = None
) -> list[float]:
    """Accuracy on each held-out part; `train` states their accuracy by default.

    Whole sessions are held out if there are two. unpressed: weight of the unpressed skin, in 0..1;
    None: as often as it was swept. Raises InputError as `samples_of` and `splits_of`.
    """
    samples = samples_of(sweeps, target)
    splits = splits_of(samples.strata, samples.sessions)
    X, y = samples.X, samples.y
    none = sweeps["press"].to_numpy()[samples.rows] == UNPRESSED
    with unchecked():
        learned = ((reference(X[train], y[train]), test) for train, test in splits)
        return [
            _weighted_accuracy(each.predict(X[test]) == y[test], none[test], unpressed)
            for each, test in learned
        ]


@contextmanager
def unchecked() -> Iterator[None]:
    """Leaves out checks of scikit-learn that many small SVMs on simulated sweeps do not need."""
    from sklearn import config_context

    with config_context(assume_finite=True, skip_parameter_validation=True):
        yield


def _weighted_accuracy(right: Mask, none: Mask, unpressed: float | None) -> float:
    """Accuracy where the unpressed skin has this weight; none: sweeps of it."""
    if unpressed is None or none.all() or not none.any():
        return float(np.mean(right))
    return float(unpressed * np.mean(right[none]) + (1 - unpressed) * np.mean(right[~none]))


def join_scores(folds: Sequence[Score]) -> Score:
    """One score of the sweeps of all folds, whose scores are of one kind."""
    first = folds[0]
    if isinstance(first, PositionScore):
        arrays = [field.name for field in fields(first) if field.name not in SCORE_EXTRAS]
        return replace(first, **{name: _column(folds, name) for name in arrays})
    answers = [fold.answers for fold in folds if isinstance(fold, ClassScore)]
    joined = Answers(*(_column(answers, field.name) for field in fields(Answers)))
    truth, predicted = _column(folds, "truth"), _column(folds, "predicted")
    return ClassScore(truth, predicted, joined, _column(folds, "sessions"))


def _column(parts: Sequence[object], name: str) -> NDArray:
    return np.concatenate([getattr(part, name) for part in parts])
