"""Findings of the report: the same quantities before and after calibration."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.distance import cdist

from ...simulator.arrays import Mask, Real
from ...simulator.progress import ProgressCallback, tracked
from ...simulator.report.findings import Findings, Result
from ...simulator.sweeps import InputError, ToleranceError
from ..evaluation.evaluation import ClassScore
from .comparison import PreparedComparison
from .distance import Distance, distances
from .mean_accuracy import (
    FEATURE_LABELS,
    MODEL_FEATURES,
    CrossValidated,
    MeanAccuracy,
    PairedSamples,
    cross_validated,
    model_accuracies,
    paired_samples,
    scored,
    transfer_accuracy,
)
from .pair import pixel_of

if TYPE_CHECKING:
    import xarray as xr

    from ...simulator.calibration.misfit import JointEffect, MisfitCauses, ParameterEffect

HTML, JSON = "gap.html", "gap.json"
"""Names of the report's files."""
PERMUTATIONS = 499
MIN_SAMPLE = 2
MAX_SAMPLE = 500
"""Maximum number of sweeps of a sample; larger samples are subsampled."""


@dataclass(frozen=True)
class Discrepancy:
    """Distances between two samples of sizes `first` and `second`.

    mmd2: squared maximum mean discrepancy, unbiased, so it may be negative; of features of unit
    spread. p: probability of a value as large if both samples have one distribution. energy: energy
    distance. coefficient: energy distance divided by the mean distance between the samples, 0 to 1.
    """

    first: int
    second: int
    mmd2: float
    p: float
    energy: float
    coefficient: float


def discrepancy(X: Real, Y: Real, random: np.random.Generator) -> Discrepancy | None:
    """Discrepancy of samples of the same features, shapes (n, feature) and (m, feature).

    None if either has fewer than MIN_SAMPLE. random: draws permutations, and subsamples to
    MAX_SAMPLE sweeps.
    """
    if min(len(X), len(Y)) < MIN_SAMPLE:
        return None
    X, Y = _subsampled(X, random), _subsampled(Y, random)
    both = np.concatenate([X, Y])
    distances = cdist(both, both).astype(np.float64)
    K = kernel(distances)
    energy, coefficient = energy_distance(distances, len(X))
    return Discrepancy(
        first=len(X),
        second=len(Y),
        mmd2=unbiased_mmd2(K, len(X)),
        p=permutation_p(K, len(X), random),
        energy=energy,
        coefficient=coefficient,
    )


def kernel(distances: Real) -> Real:
    """exp(-d²/(2 w²)), w the median of all distances between different sweeps; shape as given."""
    between = distances[np.triu_indices(len(distances), 1)]
    width = float(np.median(between)) or float(between.max()) or 1.0
    return np.exp(-((distances / width) ** 2) / 2)


def unbiased_mmd2(K: Real, n: int) -> float:
    """Gretton et al. (2012), Eq. 3, of a kernel matrix whose first n rows are the first sample."""
    first = np.arange(len(K)) < n
    return float(_mmd2(K, first[:, None])[0])


def permutation_p(K: Real, n: int, random: np.random.Generator) -> float:
    """Share of PERMUTATIONS, and of the actual samples, with an MMD² at least as large."""
    first = np.arange(len(K)) < n
    shuffled = random.permuted(np.tile(first[:, None], (1, PERMUTATIONS)), axis=0)
    rounding = 1e-12
    as_large = _mmd2(K, shuffled) >= unbiased_mmd2(K, n) - rounding
    return float((1 + as_large.sum()) / (1 + PERMUTATIONS))


def energy_distance(distances: Real, n: int) -> tuple[float, float]:
    """2 E|X - Y| - E|X - X'| - E|Y - Y'|, and that over 2 E|X - Y|; the first n rows are X."""
    between = 2 * distances[:n, n:].mean()
    within = distances[:n, :n].mean() + distances[n:, n:].mean()
    energy = max(0.0, float(between - within))
    return energy, energy / float(between) if between > 0 else 0.0


def _mmd2(K: Real, first: Mask) -> Real:
    """Unbiased MMD² for each column of `first`, which marks the rows of K in the first sample."""
    one, two = first.astype(float), (~first).astype(float)
    off_diagonal = K - np.diag(np.diag(K))
    n, m = one.sum(axis=0), two.sum(axis=0)
    from_one, from_two = off_diagonal @ one, off_diagonal @ two
    within = (one * from_one).sum(axis=0) / (n * (n - 1))
    beyond = (two * from_two).sum(axis=0) / (m * (m - 1))
    return within + beyond - 2 * (one * from_two).sum(axis=0) / (n * m)


def _subsampled(X: Real, random: np.random.Generator) -> Real:
    return X if len(X) <= MAX_SAMPLE else X[random.choice(len(X), MAX_SAMPLE, replace=False)]


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
class GapFindings(Result):
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
        from .gap_report import summary

        return summary(self)

    def write(self, folder: str | Path, *, overwrite: bool = False) -> None:
        """Write gap.html with charts, and gap.json with all numbers.

        folder: made if absent. overwrite: True replaces files that exist. Raises InputError if the
        folder cannot be made, or if files exist that may not be replaced.
        """
        from ...simulator.sweeps.output_files import replacing

        with replacing(overwrite):
            self.report.write(Path(folder), json=JSON, page=HTML, charts=())

    @property
    def report(self) -> Findings:
        """Sentences, tables, charts and numbers."""
        from .gap_report import report_of

        return report_of(self)


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
