"""Accuracies in pairs: of models on both sides of a gap, in the same folds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Integer, Mask, Real
from ...simulator.sweeps import InputError
from ...simulator.sweeps.errors import named
from ..adaptation import checked_classifier, fine_tuned
from ..evaluation.confusion import Confusion, compare, over_folds, together
from ..evaluation.evaluation import ClassScore, score, unchecked
from ..inputs.features import OF_IMPEDANCE, names_of
from ..inputs.samples import LocalizationProblem
from ..inputs.samples import Samples as Learnable
from ..inputs.samples import samples_of as learnable
from ..inputs.targets import labels
from ..learners.registry import Estimator
from ..model.localizer_model import Model
from ..trust.fitted import Classifier, Regressor
from ..trust.folds import folds_of
from .pair import pixel_of

if TYPE_CHECKING:
    import xarray as xr


class Split(NamedTuple):
    """Indices of sweeps added to training, and of those tested."""

    added: NDArray[np.intp]
    tested: NDArray[np.intp]


def reserved_for_calibration(row: Integer, column: Integer, touches: int, session: Integer) -> Mask:
    """Half of each session's unpressed sweeps, and one of each of `touches` distant pixels.

    The larger half of an odd number of unpressed sweeps. Shape (sweep,), as the arguments. Raises
    InputError if `touches` is below 0.
    """
    if touches < 0:
        raise InputError(f"{named('calibration_touches')} must be >= 0, got {touches}")
    reserved = np.zeros(row.size, dtype=bool)
    for each in np.unique(session):
        rest = np.flatnonzero((row == 0) & (session == each))
        reserved[rest[: (rest.size + 1) // 2]] = True
    pressed = np.unique(np.stack([row, column], axis=1)[row > 0], axis=0)
    for i, j in _distant(pressed, touches):
        reserved[np.flatnonzero((row == i) & (column == j))[0]] = True
    return reserved


def touch_splits(
    pixel: Integer, reserved: Mask, k: int, draws: int, seed: int
) -> list[Split] | None:
    """`draws` ways to add k sweeps of every pixel to training and to test the others.

    Reserved sweeps are never tested, and are the first of the k. For k = 0 there is one way. Pixels
    with only reserved sweeps are neither added nor tested. None if a pixel has too few sweeps, or
    all are reserved.
    """
    groups = _groups(pixel, reserved)
    if not groups or any(each.size - max(k, kept.sum()) < 1 for each, kept in groups):
        return None
    random = np.random.default_rng([seed, k])
    return [_split(groups, k, random) for _ in range(draws if k else 1)]


def largest_k(pixel: Integer, reserved: Mask) -> int:
    """Largest number of added sweeps of every pixel that leaves one to test."""
    return min((each.size - 1 for each, _ in _groups(pixel, reserved)), default=0)


def _groups(pixel: Integer, reserved: Mask) -> list[tuple[NDArray[np.intp], Mask]]:
    """Sweeps of each pixel that has unreserved ones, and a mask of the reserved ones."""
    groups = [np.flatnonzero(pixel == each) for each in np.unique(pixel)]
    return [(each, reserved[each]) for each in groups if not reserved[each].all()]


def _split(
    groups: Sequence[tuple[NDArray[np.intp], Mask]], k: int, random: np.random.Generator
) -> Split:
    added, tested = [], []
    for each, kept in groups:
        order = np.concatenate([each[kept], random.permutation(each[~kept])])
        added.append(order[:k])
        tested.append(order[max(k, kept.sum()) :])
    return Split(np.sort(np.concatenate(added)), np.sort(np.concatenate(tested)))


def _distant(places: Integer, count: int) -> Integer:
    """The first of the places, and others, each as far as possible from the previous ones."""
    if not len(places) or not count:
        return places[:0]
    chosen = [0]
    distance = np.full(len(places), np.inf)
    while len(chosen) < min(count, len(places)):
        last = np.linalg.norm(places - places[chosen[-1]], axis=1)
        distance = np.minimum(distance, last)
        chosen.append(int(distance.argmax()))
    return places[chosen]


FEATURE_LABELS = {
    "absolute": "Rs and Cp",
    "relative": "changes of ln|Z| and phase from the unpressed skin",
    "gains": "the gain",
    "gain-changes": "changes of the gain from the unpressed skin",
    "model": "the model's own features",
}


def feature_sets(sweeps: xr.Dataset) -> dict[str, tuple[str, ...]]:
    """Features of the sweeps as they are, and relative to the baseline of the same session.

    Of impedances the first are the paper's.
    """
    names = names_of(sweeps.variables)
    sets = ("absolute", "relative") if names is OF_IMPEDANCE else ("gains", "gain-changes")
    return dict(zip(sets, (names.default, names.relative), strict=True))


@dataclass(frozen=True, eq=False)
class PairedSamples:
    """Samples of one side.

    X: features, shape (sweep, feature), NaN for a sweep without a baseline. y: class, pixel: its
    number; both of shape (sweep,).
    """

    problem: LocalizationProblem
    X: Real
    y: NDArray
    pixel: Integer

    @property
    def has_features(self) -> Mask:
        """True for sweeps that have features, shape (sweep,)."""
        return np.isfinite(self.X[:, 0])

    def chosen(self, which: NDArray) -> PairedSamples:
        """The samples of an index or a mask."""
        return PairedSamples(self.problem, self.X[which], self.y[which], self.pixel[which])

    def joined(self, more: PairedSamples) -> PairedSamples:
        """These samples and more with the same features."""
        return PairedSamples(
            self.problem,
            np.concatenate([self.X, more.X]),
            np.concatenate([self.y, more.y]),
            np.concatenate([self.pixel, more.pixel]),
        )


def paired_samples(
    sweeps: xr.Dataset, quantities: Sequence[str], target: str, rest: xr.Dataset | None = None
) -> PairedSamples:
    """Samples of sweeps. Raises InputError as the features and the labels do.

    rest: baseline sweeps; by default those among `sweeps`.
    """
    found = learnable(sweeps, target, quantities, rest=rest)
    X = np.full((sweeps.sizes["sweep"], found.X.shape[1]), np.nan)
    X[found.rows] = found.X
    return PairedSamples(found.problem, X, labels(sweeps, target), pixel_of(sweeps))


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


FOLDS = 5
GROUPINGS = ("session", "press", None)
"""Groupings from the hardest test to the easiest; the first possible one is used."""


@dataclass(frozen=True, eq=False)
class MeanAccuracy:
    """Mean accuracy and its standard deviation over draws of added and tested sweeps.

    confusion: confusion of all draws together.
    """

    mean: float
    spread: float
    draws: int
    confusion: Confusion


@dataclass(frozen=True, eq=False)
class CrossValidated:
    """Accuracy by cross-validation.

    grouping: what is left out as a whole, None for single sweeps.
    """

    accuracy: MeanAccuracy
    grouping: str | None
    folds: int


def transfer_accuracy(
    simulated: PairedSamples, other: PairedSamples, splits: Sequence[Split], estimator: Estimator
) -> MeanAccuracy:
    """Accuracy after training on all simulated sweeps and those that a split adds."""
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
    """Cross-validated accuracy of one side; None if a class has too few sweeps.

    grouped: by the first of GROUPINGS with which every training contains every class; else
    ungrouped.
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
    """Predictions for the test sweeps by a localizer trained on the others."""
    training = training.chosen(training.has_features)
    with unchecked():
        return estimator.fit(training.problem, training.X, training.y).predict(test.X)


def _over_folds(
    samples: PairedSamples, folds: Sequence[tuple[NDArray, NDArray]], estimator: Estimator
) -> MeanAccuracy:
    with unchecked():
        fit = partial(estimator.fit, samples.problem)
        confusion = over_folds(fit, samples.X, samples.y, folds)
    return MeanAccuracy(confusion.accuracy, 0.0, 1, confusion)


def mean_over_draws(outcomes: Sequence[Confusion]) -> MeanAccuracy:
    """Mean and spread of the accuracy, and the counts of all draws together."""
    values = [outcome.accuracy for outcome in outcomes]
    return MeanAccuracy(
        mean=float(np.mean(values)),
        spread=float(np.std(values, ddof=1)) if len(values) > 1 else 0.0,
        draws=len(values),
        confusion=together(outcomes),
    )
