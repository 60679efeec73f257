"""Learner of a touch's position and strength by kernels."""

from __future__ import annotations

from typing import Any

from ...simulator.arrays import Real
from ..inputs.samples import LocalizationProblem
from ..parts.parts import KernelSum
from ..parts.predictor import Chain
from .classifiers import leading_components, on_one_scale, standardized

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
