"""Registry of trained localizers: targets, training and grid of tuned parameters of each."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from numpy.typing import NDArray

from ...simulator.arrays import Real
from ..inputs.samples import LocalizationProblem
from ..inputs.targets import CLASSES, TARGETS
from ..parts.parts import KernelSum
from ..parts.predictor import Chain, Predictor
from . import gaussians
from .classifiers import (
    KERNEL_WIDTH,
    REFERENCE,
    components_svm,
    curve_and_absolute,
    gaussian,
    leading_components,
    on_one_scale,
    reference,
    standardized,
)
from .drift import with_drift
from .networks import SHORT_STAGES, STAGES, network

WIDTH = 0.3
"""gamma of the kernel exp(-gamma |x - x'|²) of components that vary by 1 in sum."""


def kernel_ridge(
    problem: LocalizationProblem, X: Real, y: Real, alpha: float = 1e-4, gamma: float = WIDTH
) -> Chain:
    """Kernel ridge regression of standardised positions on components.

    X: shape (n, feature). y: x, y [mm] and strength, (n, 3). alpha: penalty.
    """
    from sklearn.kernel_ridge import KernelRidge

    first, X = on_one_scale(problem, X)
    components, target = leading_components(X), standardized(y)
    Z = components(X)
    ridge: Any = KernelRidge(kernel="rbf", gamma=gamma).set_params(alpha=alpha)
    weights = ridge.fit(Z, target(y)).dual_coef_
    regress = KernelSum(Z, gamma, weights, target.centre * 0)
    return Chain((*first, components, regress, target.back))


Grid = Mapping[str, Sequence[Any]]
Fit = Callable[..., Predictor]
"""Function of a problem, features X and targets y, and parameters by name."""


CURVE_SESSIONS = 40
"""Number of sessions from which on the baseline curve is learned by default.

It tells skins apart. The paper's SVM finds 96.7 % of the columns of other skins after 20 sessions
of skins, and 98.4 % after 40, where without the curve it finds 95.5 and 97.8 %. Too few curves are
learned by heart: of one session, 17 % are right with all answered, of 10 sessions of one skin 97 %
where 98.5 % are without, and `gaussian` finds 67 %.
"""


@dataclass(frozen=True)
class Estimator:
    """A localizer to be trained.

    targets: targets that it can predict. fit: trains it. grid: values of the parameters of `fit`
    that tuning tries, or a function of the problem that returns them. check: raises InputError for
    a problem that it cannot learn. drifted: adds the synthetic drift of its training to sweeps.
    max_sweeps: maximum number of training sweeps; more are subsampled evenly. max_sessions: maximum
    number of training sessions, None for all. uses_sweeps: True if predictions depend on the
    training sweeps. curve: number of sessions from which on its default features hold the baseline
    curve, None for never.
    """

    name: str
    targets: tuple[str, ...]
    fit: Fit
    grid: Grid | Callable[[LocalizationProblem], Grid] = field(default_factory=dict)
    check: Callable[[LocalizationProblem], object] = lambda problem: None
    drifted: Callable[[LocalizationProblem, Real], Real] = lambda problem, X: X
    max_sweeps: int = 20_000
    max_sessions: int | None = None
    uses_sweeps: bool = True
    curve: int | None = CURVE_SESSIONS

    def grid_for(self, problem: LocalizationProblem) -> Grid:
        """Values of parameters that tuning tries for a problem."""
        return self.grid(problem) if callable(self.grid) else self.grid


SVM_GRID = {"C": [10.0, 100.0, 1000.0, 1e4], "gamma": [0.01, 0.1, 1.0]}
RIDGE_GRID = {"alpha": [1e-5, 1e-4, 1e-3, 1e-2], "gamma": [0.1, 0.3, 1.0]}
NETWORK_GRID = {"stages": [STAGES, SHORT_STAGES]}


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
    drift: dict[str, Any] = {"drifted": with_drift, "max_sweeps": 500_000}
    of_gaussian: dict[str, Any] = {
        "check": curve_and_absolute,
        "drifted": _drifted_for_gaussian,
    }
    of_ridge: dict[str, Any] = {"max_sweeps": 6000, "curve": None}
    made = [
        Estimator(REFERENCE, few, _reference, _reference_grid),
        Estimator("ksvm-components", CLASSES, components_svm, SVM_GRID),
        Estimator("gaussian", CLASSES, gaussian, **of_gaussian, max_sweeps=100_000),
        Estimator("kernel-ridge", ("position",), kernel_ridge, RIDGE_GRID, **of_ridge),
        Estimator("network", TARGETS, network, NETWORK_GRID, **drift),
    ]
    return {each.name: each for each in made}


def _reference(problem: LocalizationProblem, X: Real, y: NDArray, **parameters: Any) -> Predictor:
    return reference(X, y, **parameters)


def _drifted_for_gaussian(problem: LocalizationProblem, X: Real) -> Real:
    return gaussians.drifted(X, *curve_and_absolute(problem))


def _reference_grid(problem: LocalizationProblem) -> Grid:
    widths = [factor * KERNEL_WIDTH / problem.features for factor in (0.1, 1.0, 10.0)]
    return {"C": [10.0, 100.0, 1000.0], "gamma": widths}
