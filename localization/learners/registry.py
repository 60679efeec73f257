"""Registry of trained localizers: targets, pipeline and grid of tuned parameters of each."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from sklearn.pipeline import Pipeline

from ..inputs.samples import LocalizationProblem
from ..inputs.targets import CLASSES, TARGETS
from . import classifiers, regressors
from .classifiers import (
    KERNEL_WIDTH,
    REFERENCE,
    components_svm,
    gaussian,
    on_one_scale,
    reference,
)
from .drift import with_drift
from .networks import SHORT_STAGES, STAGES
from .regressors import kernel_ridge

Grid = Mapping[str, Sequence[Any]]


@dataclass(frozen=True)
class Estimator:
    """A localizer to be trained.

    targets: targets that it can predict. build: makes an untrained pipeline for a problem; a
    regressor's last step may take `return_std` in `predict`. grid: values of the pipeline's
    parameters that tuning tries, or a function of the problem that returns them. max_sweeps:
    maximum number of training sweeps; more are subsampled evenly. max_sessions: maximum number of
    training sessions, None for all. uses_sweeps: True if predictions depend on the training sweeps.
    """

    name: str
    targets: tuple[str, ...]
    build: Callable[[LocalizationProblem], Pipeline]
    grid: Grid | Callable[[LocalizationProblem], Grid] = field(default_factory=dict)
    max_sweeps: int = 20_000
    max_sessions: int | None = None
    uses_sweeps: bool = True

    def grid_for(self, problem: LocalizationProblem) -> Grid:
        """Values of parameters that tuning tries for a problem."""
        return self.grid(problem) if callable(self.grid) else self.grid


SVM_GRID = {"classify__C": [10.0, 100.0, 1000.0, 1e4], "classify__gamma": [0.01, 0.1, 1.0]}
RIDGE_GRID = {
    "regress__regressor__alpha": [1e-5, 1e-4, 1e-3, 1e-2],
    "regress__regressor__gamma": [0.1, 0.3, 1.0],
}


REMOVED = {
    "ksvm-ova": REFERENCE,
    "ksvm-ordinal": REFERENCE,
    "svc": REFERENCE,
    "knn": "ksvm-components",
    "knn-position": "kernel-ridge",
    "gaussian-process": "kernel-ridge",
}
"""Removed estimators, which were best in no table, and their replacements."""


def removal_message(name: str) -> str:
    """Message about a removed estimator."""
    return f"{name} was removed, because others are more accurate: use {REMOVED[name]}"


def learners() -> dict[str, Estimator]:
    """The estimators that are trained on sweeps alone, by name."""
    few = tuple(target for target in CLASSES if target != "pair")
    made = [
        Estimator(REFERENCE, few, lambda each: reference(each.features), _reference_grid),
        Estimator("ksvm-components", CLASSES, _scaled(components_svm), SVM_GRID),
        Estimator(
            "gaussian", CLASSES, lambda each: on_one_scale(gaussian(each), each), max_sweeps=100_000
        ),
        Estimator("kernel-ridge", ("position",), _scaled(kernel_ridge), RIDGE_GRID, 6000),
        _network(),
    ]
    return {each.name: each for each in made}


def _network() -> Estimator:
    def build(problem: LocalizationProblem) -> Pipeline:
        network = regressors.network() if problem.continuous else classifiers.network()
        return with_drift(on_one_scale(network, problem), problem)

    def grid(problem: LocalizationProblem) -> Grid:
        last = "regress__regressor" if problem.continuous else "classify"
        return {f"{last}__stages": [STAGES, SHORT_STAGES]}

    return Estimator("network", TARGETS, build, grid, max_sweeps=500_000)


def _scaled(build: Callable[[], Pipeline]) -> Callable[[LocalizationProblem], Pipeline]:
    """A builder for features with equal noise, with scaling added if their noise differs."""
    return lambda problem: on_one_scale(build(), problem)


def _reference_grid(problem: LocalizationProblem) -> Grid:
    widths = [factor * KERNEL_WIDTH / problem.features for factor in (0.1, 1.0, 10.0)]
    return {
        "classify__estimator__C": [10.0, 100.0, 1000.0],
        "classify__estimator__gamma": widths,
    }
