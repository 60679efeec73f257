"""Training of a localizer on sweeps whose presses are known."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.progress import ProgressCallback, silent
from ...simulator.sweeps import InputError
from ..inputs.features import Quantities, default_quantities
from ..inputs.samples import Samples, fingerprints_of, samples_of
from ..inputs.targets import has_target, labels
from ..inversion.estimators import chosen
from ..trust.diagnosis import Diagnosis, diagnosis_of, faults_of
from ..trust.fitted import Classifier, Regressor
from ..trust.fitting import learn_classes, learn_positions
from ..trust.folds import describe_splits, scoring_splits
from .localizer_model import Model, current_versions

if TYPE_CHECKING:
    import xarray as xr


def train(
    sweeps: xr.Dataset,
    target: str = "column",
    estimator: str | None = None,
    *,
    quantities: Quantities | None = None,
    interfaces: Sequence[str] | None = None,
    rest: xr.Dataset | None = None,
    certain: float | None = None,
    tune: bool = False,
    progress: ProgressCallback = silent,
) -> Model:
    """Train a model that predicts the `target` of sweeps like these.

    Sweeps whose press has no such target are left out. Sweeps with a fault are not used to learn
    presses: they teach the model to name the faults that sweeps resemble. target, quantities,
    interfaces, rest: see `samples_of`. estimator: of `estimators()`, by default that of
    DEFAULT_ESTIMATORS. certain: the accuracy that answers must have on held-out sweeps; by default
    every sweep that is not novel is answered. tune: choose the estimator's parameters by
    cross-validation. progress: callback for the fits. Raises InputError if these are not available,
    if the sweeps are of one class, or if every sweep has a fault.
    """
    made, given = chosen(estimator, target), sweeps
    sweeps = _without_faults(sweeps)
    if quantities is None:
        quantities = default_quantities(sweeps, rest, made.curve)
    samples = samples_of(sweeps, target, quantities, interfaces=interfaces, rest=rest)
    if samples.problem.continuous:
        gate = _gate(sweeps, samples, rest, certain)
        learned = learn_positions(samples, made, tune=tune, progress=progress)
    else:
        gate = None
        learned = learn_classes(samples, made, certain=certain, tune=tune, progress=progress)
    held_out = describe_splits(scoring_splits(samples.strata, samples.sessions), samples.sessions)
    diagnosis = None if sweeps is given else _diagnosis(given, learned, samples, rest)
    return Model(
        learned=learned,
        estimator=made.name,
        problem=samples.problem,
        certain=certain,
        validation=held_out,
        versions=current_versions(),
        trained_on=min(len(samples.first_sessions(made.max_sessions).X), made.max_sweeps),
        left_out=samples.left_out.describe(target),
        fingerprints=fingerprints_of(sweeps)[samples.rows],
        gate=gate,
        diagnosis=diagnosis,
    )


def _diagnosis(
    sweeps: xr.Dataset,
    learned: Classifier | Regressor,
    samples: Samples,
    rest: xr.Dataset | None,
) -> Diagnosis | None:
    """Diagnosis by all sweeps, with and without faults. learned: by `samples` without faults."""
    problem, right = samples.problem, np.full(sweeps.sizes["sweep"], np.nan)
    if isinstance(learned, Classifier):
        every = samples_of(
            sweeps, problem.target, problem.quantities, interfaces=problem.interfaces, rest=rest
        )
        right[every.rows] = learned.predict(every.X) == every.y
    return diagnosis_of(sweeps, problem.interfaces, right)


def _without_faults(sweeps: xr.Dataset) -> xr.Dataset:
    """The sweeps of skins without a fault. Raises InputError if there is none."""
    faulty = faults_of(sweeps) != ""
    if faulty.all():
        raise InputError("every sweep has a fault; a localizer needs sweeps without a fault")
    return sweeps.isel(sweep=~faulty) if faulty.any() else sweeps


def _gate(
    sweeps: xr.Dataset, samples: Samples, rest: xr.Dataset | None, certain: float | None
) -> Model | None:
    """Model of the number of touches from these features; None if all sweeps have one number."""
    counted = sweeps.isel(sweep=has_target(sweeps, "touches"))
    if np.unique(labels(counted, "touches")).size < 2:
        return None
    return train(
        sweeps,
        "touches",
        quantities=samples.problem.quantities,
        interfaces=samples.problem.interfaces,
        rest=rest,
        certain=certain,
    )
