"""Findings of the report: the same quantities before and after calibration."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.arrays import Real
from ...simulator.notebook_display import SmallChart, Tabular
from ...simulator.progress import ProgressCallback, tracked
from ...simulator.sweeps import InputError, ToleranceError
from ..evaluation.evaluation import ClassScore
from .comparison import PreparedComparison
from .discrepancy import Discrepancy, discrepancy
from .distance import Distance, distances
from .mean_accuracy import CrossValidated, MeanAccuracy, cross_validated, transfer_accuracy
from .model_accuracy import MODEL_FEATURES, model_accuracies, scored
from .pair import pixel_of
from .paired_samples import FEATURE_LABELS, PairedSamples, paired_samples

if TYPE_CHECKING:
    import xarray as xr

    from ...simulator.calibration.misfit import JointEffect, MisfitCauses, ParameterEffect

ALL = "all"


@dataclass(frozen=True, eq=False)
class CalibrationStage:
    """Findings before or after calibration.

    pressed, rest: distances by quantity; None if there is no such press on both sides. transfer:
    accuracy by set of features and by number of added sweeps of every pixel. discrepancies: by set
    of features and by class, ALL of them first.
    """

    pressed: Mapping[str, Distance] | None
    rest: Mapping[str, Distance] | None
    transfer: Mapping[str, Mapping[int, MeanAccuracy]]
    discrepancies: Mapping[str, Mapping[str, Discrepancy]]


@dataclass(frozen=True, eq=False)
class ModelFindings:
    """Findings about the user's own model.

    accuracies: by number of sweeps of every pixel that adapted it. score: score of the unadapted
    model on all tested sweeps.
    """

    accuracies: Mapping[int, MeanAccuracy]
    score: ClassScore


@dataclass(frozen=True, eq=False, repr=False)
class GapFindings(Tabular):
    """Gap between simulated and measured sweeps: distances, accuracies, and causes.

    stages: before and after calibration. own: training and test on the other side, by set of
    features, `grouped` as hard as possible and `single` sweeps. causes: share that each parameter
    explains if it alone is fitted, the largest first. model: findings about the user's own model,
    if given. together: share that pairs of parameters explain if both are fitted, the largest
    first.
    """

    trial: PreparedComparison
    stages: Mapping[str, CalibrationStage]
    own: Mapping[str, Mapping[str, CrossValidated]]
    causes: Sequence[ParameterEffect]
    notes: Sequence[str]
    model: ModelFindings | None = None
    together: Sequence[JointEffect] = ()

    @property
    def summary(self) -> list[str]:
        """Sentences on the distance, the accuracy, and the parameter that explains most."""
        from .report.sentences import summary

        return summary(self)

    def write(self, folder: str | Path, *, overwrite: bool = False) -> None:
        """Write gap.html with charts, and gap.json with all numbers.

        folder: made if absent. overwrite: True replaces files that exist. Raises InputError if the
        folder cannot be made, or if files exist that may not be replaced.
        """
        from ...simulator.sweeps.output_files import replacing
        from .report.html_report import write_report

        with replacing(overwrite):
            write_report(Path(folder), self)

    def _table(self) -> tuple[str, list[tuple[str, ...]]]:
        from .report.sentences import accuracy_table

        title = f"Accuracy on {self.trial.pair.label.adjective} sweeps"
        return title, accuracy_table(self)

    def _chart(self) -> SmallChart | None:
        from .report.gap_curves import small_distance_chart

        return small_distance_chart(self)


def find_gap(trial: PreparedComparison, progress: ProgressCallback) -> GapFindings:
    """Compute all findings of a comparison; what is not possible is left out and noted.

    progress: see `ProgressCallback`.
    """
    stages = {name: _stage(trial, name, progress) for name in trial.versions}
    own = {name: _own(trial, samples) for name, samples in trial.others.items()}
    causes, why = _causes(trial, progress)
    model, model_notes = _by_model(trial)
    notes = [*trial.notes, *why, *model_notes]
    if not all(own.values()):
        notes.append(
            f"A class has a single {trial.pair.label.adjective} sweep: no training on these."
        )
    alone, together = (causes.alone, causes.together) if causes else ((), ())
    return GapFindings(trial, stages, own, alone, notes, model, together)


def _by_model(trial: PreparedComparison) -> tuple[ModelFindings | None, list[str]]:
    if trial.model is None:
        return None, []
    other = trial.others[MODEL_FEATURES]
    accuracies, notes = model_accuracies(trial.model, other, trial.splits)
    tested = np.unique(np.concatenate([split.tested for split in trial.splits[0]]))
    return ModelFindings(accuracies, scored(trial.model, other.chosen(tested))), notes


def _stage(trial: PreparedComparison, name: str, progress: ProgressCallback) -> CalibrationStage:
    version, target = trial.versions[name], trial.options.target
    other = trial.pair.other.isel(sweep=trial.not_calibrating)
    ours = {
        each: _common(trial, paired_samples(version.read, quantities, target, version.rest))
        for each, quantities in trial.features.items()
        if each in trial.others
    }
    return CalibrationStage(
        pressed=distances(version.exact, other, trial.reading_deviation, target, pressed=True),
        rest=distances(version.exact, other, trial.reading_deviation, target, pressed=False),
        transfer={}
        if trial.model
        else {each: _transfer(trial, ours[each], each, name, progress) for each in ours},
        discrepancies={each: _discrepancies(trial, ours[each], each) for each in ours},
    )


def _common(trial: PreparedComparison, samples: PairedSamples) -> PairedSamples:
    return samples.chosen(samples.has_features & np.isin(samples.pixel, trial.common))


def _transfer(
    trial: PreparedComparison,
    ours: PairedSamples,
    feature_set: str,
    stage: str,
    progress: ProgressCallback,
) -> dict[int, MeanAccuracy]:
    other, estimator = trial.others[feature_set], trial.estimator
    work = f"{stage} calibration, {FEATURE_LABELS[feature_set]}"
    return {
        k: transfer_accuracy(ours, other, trial.splits[k], estimator)
        for k in tracked(list(trial.splits), work, progress)
    }


def _own(trial: PreparedComparison, samples: PairedSamples) -> dict[str, CrossValidated]:
    which = samples.has_features & np.isin(samples.pixel, trial.common)
    sweeps, samples = trial.pair.other.isel(sweep=which), samples.chosen(which)
    estimator, seed = trial.estimator, trial.options.seed
    found = {
        kind: cross_validated(sweeps, samples, estimator, seed, grouped=kind == "grouped")
        for kind in ("grouped", "single")
    }
    return {kind: each for kind, each in found.items() if each is not None}


def _discrepancies(
    trial: PreparedComparison, ours: PairedSamples, feature_set: str
) -> dict[str, Discrepancy]:
    """Discrepancies of features in units of their spread over the other side's sweeps."""
    theirs = _common(trial, trial.others[feature_set].chosen(trial.not_calibrating))
    scale, random = _spread(theirs.X), np.random.default_rng(trial.options.seed)
    found = {ALL: discrepancy(ours.X / scale, theirs.X / scale, random)}
    for label in np.unique(theirs.y).tolist():
        X, Y = (part.X[part.y == label] / scale for part in (ours, theirs))
        found[str(label)] = discrepancy(X, Y, random)
    return {label: each for label, each in found.items() if each is not None}


def _spread(X: Real) -> Real:
    """Standard deviation of each feature, 1 where it does not vary."""
    spread = X.std(axis=0)
    return np.where(spread > 0, spread, 1.0)


def _one_of_each(sweeps: xr.Dataset) -> xr.Dataset:
    """All unpressed sweeps, and the first sweep of each pixel."""
    pixel = pixel_of(sweeps)
    first = np.unique(pixel, return_index=True)[1]
    return sweeps.isel(sweep=np.union1d(first, np.flatnonzero(pixel == 0)))


def _causes(
    trial: PreparedComparison, progress: ProgressCallback
) -> tuple[MisfitCauses | None, list[str]]:
    """Causes of the gap, None without a scene; and notes on untried parameters."""
    from ...simulator.calibration.misfit import gap_by_parameter

    if trial.pair.scene is None:
        return None, []
    sweeps = _one_of_each(trial.pair.other)
    try:
        causes = gap_by_parameter(trial.pair.scene.parts, sweeps, progress=progress)
    except (InputError, ToleranceError) as error:
        return None, [f"No causes: {error}."]
    return causes, [f"{remark[0].upper()}{remark[1:]}." for remark in causes.remarks]
