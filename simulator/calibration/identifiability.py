"""Identifiability of the parameters, alone and combined, from the Gauss-Newton information.

All parameters are counted in standard deviations of their priors. The information of the data is
then 1 in a direction where they are as precise as the prior.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..arrays import Mask, Real
from .fit import Fit
from .prior import Noise, Prior
from .problem import LeastSquaresProblem
from .residual_correlation import readings_per_independent_one

IDENTIFIED_SHARE = 0.25
"""Largest posterior deviation over the prior's, for a parameter that the data identify."""
MIN_INFORMATION = 1 / IDENTIFIED_SHARE**2 - 1
"""Information of the data over the prior's, from which they identify a direction."""
PRIOR_WIDENING, MAX_WIDENING = 10.0, 2.0
"""PRIOR_WIDENING: factor on the priors in the test of their influence. MAX_WIDENING: an estimate
that gets wider than this depends on a prior; the data alone do not identify it."""
MIN_COMPONENT = 0.2
"""Smallest component of a unit direction with which a parameter is part of it."""
MIN_INDEPENDENT = 3.0
"""Fewest degrees of freedom of correlated residuals: Student's t with two has no variance."""
MIN_EFFECT = 4.0
"""Smallest chi-squared by which a parameter has an effect."""


@dataclass(frozen=True)
class Information:
    """Information on all unknown parameters, fitted or not.

    data: information of the data alone, shape (parameter, parameter), with all other unknowns
    marginalized and errors scaled. freedom: degrees of freedom of the residuals. correlated: number
    of readings for each independent one, see `residual_correlation`. independent: degrees of
    freedom of the independent ones. scale: factor on the error variance, at least 1: their
    chi-squared per degree of freedom, times `correlated`.
    """

    names: tuple[str, ...]
    data: Real
    freedom: float
    correlated: float
    independent: float
    scale: float

    def variance_freedom(self, noise: Noise) -> float:
        """Degrees of freedom of the error variance, infinite where it is known.

        Residuals estimate it where the noise is unknown, and where they exceed the noise.
        """
        if noise.guessed:
            return self.independent
        exceeding = self.scale > self.correlated
        return min(noise.freedom, self.independent) if exceeding else noise.freedom

    @cached_property
    def covariance(self) -> Real:
        """Marginal posterior covariance of the parameters, shape (parameter, parameter)."""
        return np.linalg.inv(self.data + np.eye(len(self.names))).astype(np.float64)

    @cached_property
    def _with_wide_priors(self) -> Real:
        """Posterior covariance with priors that are PRIOR_WIDENING times as wide."""
        return np.linalg.inv(self.data + np.eye(len(self.names)) / PRIOR_WIDENING**2).astype(
            np.float64
        )

    def identifies(self, weights: Real) -> bool:
        """True if the data identify a weighted sum of parameters, independently of the priors."""
        left = weights @ self.covariance @ weights
        without = weights @ self._with_wide_priors @ weights
        return self.narrows(weights) and bool(without < MAX_WIDENING**2 * left)

    def narrows(self, weights: Real) -> bool:
        """True if the posterior of a weighted sum of parameters is far narrower than its prior."""
        left = weights @ self.covariance @ weights
        return bool(left < IDENTIFIED_SHARE**2 * weights @ weights)

    def weakest(self, first: int, second: int) -> Real:
        """Unit direction of two parameters with the least information of the data."""
        own = [first, second]
        direction = np.zeros(len(self.names))
        direction[own] = np.linalg.eigh(self.data[np.ix_(own, own)])[1][:, 0]
        return direction

    @property
    def deviation(self) -> Real:
        """Posterior deviation of each parameter over its prior's: 1 without information."""
        return np.sqrt(self.covariance.diagonal())

    @property
    def correlation(self) -> Real:
        """Correlation matrix of the estimates."""
        return self.covariance / np.outer(self.deviation, self.deviation)

    @property
    def identified(self) -> dict[str, bool]:
        """True for each parameter that the data identify."""
        each = np.eye(len(self.names))
        return {name: self.identifies(own) for name, own in zip(self.names, each, strict=True)}

    def barely_identifies(self, direction: Real) -> bool:
        """True if the data add little to the priors along a unit direction."""
        return bool(direction @ self.data @ direction < MIN_INFORMATION)

    @property
    def without_effect(self) -> Mask:
        """True for each parameter whose effect on the data is too small to be measured."""
        return self.data.diagonal() <= MIN_EFFECT

    def weak_directions(self, known: Sequence[Real] = ()) -> list[Real]:
        """Unit directions that the data barely identify, the weakest first.

        known: such directions; all others are orthogonal to them. Parameters without effect are
        directions of their own, because any mixture of them would be one too.
        """
        alone = np.eye(len(self.names))[self.without_effect]
        found = [
            each for each in alone if all(abs(each @ other) < MIN_COMPONENT for other in known)
        ]
        given = np.reshape([*known, *found], (-1, len(self.names)))
        left = _orthogonal_complement(given)
        strength, directions = np.linalg.eigh(left.T @ self.data @ left)
        return [*found, *(left @ directions[:, strength < MIN_INFORMATION]).T]

    def moved(self, direction: Real) -> list[str]:
        """Parameters with large components in a direction, the largest first."""
        order = np.argsort(-np.abs(direction))
        return [self.names[k] for k in order if abs(direction[k]) > MIN_COMPONENT]

    def parts(self, direction: Real) -> list[str]:
        """Parameters whose effects cancel along a direction, the largest first.

        A direction without effects returns its largest parameter.
        """
        effect = direction**2 * self.data.diagonal()
        order = [k for k in np.argsort(-np.abs(direction)) if effect[k] > MIN_EFFECT]
        return [self.names[k] for k in order] if len(order) > 1 else self.moved(direction)[:1]


def _orthogonal_complement(given: Real) -> Real:
    """Orthonormal basis of the complement of the rows, shape (parameter, direction)."""
    full, _ = np.linalg.qr(given.T, mode="complete")
    return full[:, len(given) :].astype(np.float64)


def information(fit: Fit, not_fitted: Mapping[str, Prior] | None = None) -> Information:
    """Information at a solution. not_fitted: priors of unknown parameters that were not fitted."""
    data = _of_data(fit)
    taken = float(np.trace(np.linalg.solve(data + np.eye(len(data)), data)))
    count, correlated = fit.spec.measurements.numbers, readings_per_independent_one(fit, taken)
    freedom = max(count - taken, 1.0)
    independent = min(freedom, max(count / correlated - taken, MIN_INDEPENDENT))
    scale = max(correlated, fit.chi_squared / independent)
    opened = with_all_unknown(fit, not_fitted or {})
    data = _of_data(opened) / scale
    return Information(opened.spec.names, data, freedom, correlated, independent, scale)


def with_all_unknown(fit: Fit, not_fitted: Mapping[str, Prior]) -> Fit:
    """The solution as one of the problem in which the parameters not fitted are unknown too."""
    spec, values = fit.spec, fit.values
    unknown = {**spec.fitted, **not_fitted}
    opened = replace(
        spec,
        fitted={name: unknown[name] for name in values if name in unknown},
        fixed={name: value for name, value in spec.fixed.items() if name not in unknown},
    )
    u = opened.unknowns(values)
    u[len(opened.fitted) :] = fit.u[len(spec.fitted) :]
    return replace(fit, problem=LeastSquaresProblem(opened, fit.problem.model), u=u)


def _of_data(fit: Fit) -> Real:
    """Information of the data on the parameters, in units of their priors' information."""
    J, tail = fit.problem.jacobian(fit.u), fit.spec.tail
    count, readings = len(fit.spec.fitted), len(J) - len(fit.u)
    if tail is not None:
        J[:readings] *= fit.problem.root_information(fit.u)[:, None]
    own, others = J[:readings, :count], J[:readings, count:]
    between = own.T @ others
    known = others.T @ others + np.eye(others.shape[1])
    data = own.T @ own - between @ np.linalg.solve(known, between.T)
    return (data + data.T) / 2
