"""The localizers by name: what each can tell, how it is made, and what of it may be tuned."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from sklearn.pipeline import Pipeline

from ...simulator.sweeps import InputError
from ..inputs.samples import Problem
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
from .networks import SHORT, STAGES
from .regressors import kernel_ridge

Grid = Mapping[str, Sequence[Any]]
Registry = Mapping[str, "Estimator"]


@dataclass(frozen=True)
class Estimator:
    """A localizer to be trained.

    targets: what it can tell. build: an untrained pipeline for a problem; a regressor's last step
    may take `return_std` in `predict`. grid: values of the pipeline's parameters that tuning tries,
    or a function of the problem that tells them. most: sweeps it is trained on; more are thinned
    out evenly. sessions: of which it is shown no more, None for all. taught: whether what it tells
    depends on the sweeps that it is fitted to. equip: gives a pipeline that was read from disk what
    could not be kept there.
    """

    name: str
    targets: tuple[str, ...]
    build: Callable[[Problem], Pipeline]
    grid: Grid | Callable[[Problem], Grid] = field(default_factory=dict)
    most: int = 20_000
    sessions: int | None = None
    taught: bool = True
    equip: Callable[[Pipeline], None] = lambda pipeline: None

    def grid_for(self, problem: Problem) -> Grid:
        """What tuning tries for a problem."""
        return self.grid(problem) if callable(self.grid) else self.grid


SVM_GRID = {"classify__C": [10.0, 100.0, 1000.0, 1e4], "classify__gamma": [0.01, 0.1, 1.0]}
RIDGE_GRID = {
    "regress__regressor__alpha": [1e-5, 1e-4, 1e-3, 1e-2],
    "regress__regressor__gamma": [0.1, 0.3, 1.0],
}
DEFAULT_OF = {
    **dict.fromkeys(CLASSES, REFERENCE),
    "touches": "ksvm-components",
    "pair": "ksvm-components",
    "position": "kernel-ridge",
}
"""The localizer of a target where none is named."""
GONE = {
    "ksvm-ova": REFERENCE,
    "ksvm-ordinal": REFERENCE,
    "svc": REFERENCE,
    "knn": "ksvm-components",
    "knn-position": "kernel-ridge",
    "gaussian-process": "kernel-ridge",
}
"""Localizers of earlier versions that were right more often than others in no table, and what to
take in the place of each."""


def estimators(extra: Iterable[Estimator] = ()) -> dict[str, Estimator]:
    """All localizers by name: those of this package, and those that are passed in."""
    return {each.name: each for each in (*_learners(), *extra)}


def chosen(name: str | None, target: str, registry: Registry | None = None) -> Estimator:
    """The localizer of that name, or the default one.

    Raises InputError for an unknown target, an unknown name, or one that cannot tell the target.
    """
    if target not in TARGETS:
        raise InputError(f"`target` must be one of {', '.join(TARGETS)}, got {target!r}")
    known = estimators() if registry is None else registry
    able = [each.name for each in known.values() if target in each.targets]
    name = name or DEFAULT_OF[target]
    if name in GONE:
        raise InputError(f"`estimator` {gone(name)}")
    if name not in able:
        raise InputError(
            f"`estimator` must be one of {', '.join(able)} for `target` {target}, got {name!r}"
        )
    return known[name]


def gone(name: str) -> str:
    """What is reported of a localizer of GONE."""
    return f"{name} is gone, for nowhere was it right more often than others: take {GONE[name]}"


def _learners() -> list[Estimator]:
    few = tuple(target for target in CLASSES if target != "pair")
    return [
        Estimator(REFERENCE, few, lambda each: reference(each.features), _reference_grid),
        Estimator("ksvm-components", CLASSES, _alike(components_svm), SVM_GRID),
        Estimator(
            "gaussian", CLASSES, lambda each: on_one_scale(gaussian(each), each), most=100_000
        ),
        Estimator("kernel-ridge", ("position",), _alike(kernel_ridge), RIDGE_GRID, 6000),
        _network(),
    ]


def _network() -> Estimator:
    def build(problem: Problem) -> Pipeline:
        network = regressors.network() if problem.continuous else classifiers.network()
        return with_drift(on_one_scale(network, problem), problem)

    def grid(problem: Problem) -> Grid:
        last = "regress__regressor" if problem.continuous else "classify"
        return {f"{last}__stages": [STAGES, SHORT]}

    return Estimator("network", TARGETS, build, grid, most=500_000)


def _alike(build: Callable[[], Pipeline]) -> Callable[[Problem], Pipeline]:
    """The same of features that err alike, whatever they are."""
    return lambda problem: on_one_scale(build(), problem)


def _reference_grid(problem: Problem) -> Grid:
    widths = [factor * KERNEL_WIDTH / problem.features for factor in (0.1, 1.0, 10.0)]
    return {
        "classify__estimator__C": [10.0, 100.0, 1000.0],
        "classify__estimator__gamma": widths,
    }
