"""How surely each parameter is told, and which only together: from the Gauss-Newton information.

All in deviations of the parameters' priors: the information of the data is then 1 in a direction
that they tell as well as the prior does.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .fit import Fit
from .prior import Prior
from .problem import LeastSquaresProblem

TOLD = 0.25
"""Of the prior's deviation: what is left of it where the data tell a parameter."""
LEAST_TOLD = 1 / TOLD**2 - 1
"""Information along a direction, in the prior's, from which the data tell it."""
WIDER, HANGING = 10.0, 2.0
"""Times the priors: how wide they are made to see what hangs on them; and how much wider an
estimate then is that the data do not tell by themselves."""
PART = 0.2
"""Of a direction: a parameter with a smaller share is not what it moves."""
SEEN = 4.0
"""Chi-squared that a parameter's share alone would make, where it has a part in a direction."""


@dataclass(frozen=True)
class Information:
    """Of all parameters that are not known, fitted or held.

    data: information of the data alone, (parameter, parameter), all else that is unknown and the
    size of the residuals accounted for. freedom: numbers beyond what the fit took of them. scale:
    chi-squared per degree of freedom, at least 1, that errors were enlarged by.
    """

    names: tuple[str, ...]
    data: NDArray[np.float64]
    freedom: float
    scale: float

    @cached_property
    def covariance(self) -> NDArray[np.float64]:
        """With the prior: of each parameter whatever the others are."""
        return np.linalg.inv(self.data + np.eye(len(self.names))).astype(np.float64)

    @cached_property
    def _hanging(self) -> NDArray[np.float64]:
        """The covariance, were the priors WIDER."""
        return np.linalg.inv(self.data + np.eye(len(self.names)) / WIDER**2).astype(np.float64)

    def tells(self, weights: NDArray[np.float64]) -> bool:
        """Whether the data tell a sum of parameters, far better than and without their priors."""
        left = weights @ self.covariance @ weights
        without = weights @ self._hanging @ weights
        return self.narrows(weights) and bool(without < HANGING**2 * left)

    def narrows(self, weights: NDArray[np.float64]) -> bool:
        """Whether data and priors tell a sum of parameters far better than their priors alone."""
        left = weights @ self.covariance @ weights
        return bool(left < TOLD**2 * weights @ weights)

    def weakest(self, first: int, second: int) -> NDArray[np.float64]:
        """Of the unit directions of two parameters alone the one that the data tell least."""
        own = [first, second]
        direction = np.zeros(len(self.names))
        direction[own] = np.linalg.eigh(self.data[np.ix_(own, own)])[1][:, 0]
        return direction

    @property
    def deviation(self) -> NDArray[np.float64]:
        """Of each parameter in deviations of its prior: 1 where the data say nothing."""
        return np.sqrt(self.covariance.diagonal())

    @property
    def correlation(self) -> NDArray[np.float64]:
        """Of the estimates."""
        return self.covariance / np.outer(self.deviation, self.deviation)

    @property
    def told(self) -> dict[str, bool]:
        """Whether the data tell a parameter."""
        each = np.eye(len(self.names))
        return {name: self.tells(own) for name, own in zip(self.names, each, strict=True)}

    def hardly_tells(self, direction: NDArray[np.float64]) -> bool:
        """Whether the data tell hardly more along a unit direction than the priors do."""
        return bool(direction @ self.data @ direction < LEAST_TOLD)

    @property
    def silent(self) -> NDArray[np.bool_]:
        """Whether a parameter changes nothing that could be seen."""
        return self.data.diagonal() <= SEEN

    def weak(self, known: Sequence[NDArray[np.float64]] = ()) -> list[NDArray[np.float64]]:
        """Unit directions that the data hardly tell, the weakest first.

        known: such directions, that others are sought orthogonal to. Silent parameters are
        directions of their own, as those that nothing is told of could be mixed anyhow.
        """
        alone = np.eye(len(self.names))[self.silent]
        found = [each for each in alone if all(abs(each @ other) < PART for other in known)]
        given = np.reshape([*known, *found], (-1, len(self.names)))
        left = _beside(given)
        strength, directions = np.linalg.eigh(left.T @ self.data @ left)
        return [*found, *(left @ directions[:, strength < LEAST_TOLD]).T]

    def moved(self, direction: NDArray[np.float64]) -> list[str]:
        """Parameters that a direction moves most, the largest first."""
        order = np.argsort(-np.abs(direction))
        return [self.names[k] for k in order if abs(direction[k]) > PART]

    def parts(self, direction: NDArray[np.float64]) -> list[str]:
        """Those that undo each other's effect along it, the largest first; or one without any."""
        effect = direction**2 * self.data.diagonal()
        order = [k for k in np.argsort(-np.abs(direction)) if effect[k] > SEEN]
        return [self.names[k] for k in order] if len(order) > 1 else self.moved(direction)[:1]


def _beside(given: NDArray[np.float64]) -> NDArray[np.float64]:
    """An orthonormal basis of all that is orthogonal to the rows, shape (parameter, direction)."""
    full, _ = np.linalg.qr(given.T, mode="complete")
    return full[:, len(given) :].astype(np.float64)


def information(fit: Fit, held: Mapping[str, Prior] | None = None) -> Information:
    """At a solution. held: priors of parameters that the fit left as they are, unknown though."""
    data = _of_data(fit)
    taken = np.trace(np.linalg.solve(data + np.eye(len(data)), data))
    freedom = max(fit.spec.measurements.numbers - float(taken), 1.0)
    scale = max(1.0, fit.chi_squared / freedom)
    opened = with_unknown(fit, held or {})
    return Information(opened.spec.names, _of_data(opened) / scale, freedom, scale)


def with_unknown(fit: Fit, held: Mapping[str, Prior]) -> Fit:
    """The same solution of the problem where the parameters that were held are unknown too."""
    asked, values = fit.spec, fit.values
    unknown = {**asked.fitted, **held}
    opened = replace(
        asked,
        fitted={name: unknown[name] for name in values if name in unknown},
        fixed={name: value for name, value in asked.fixed.items() if name not in unknown},
    )
    u = opened.unknowns(values)
    u[len(opened.fitted) :] = fit.u[len(asked.fitted) :]
    return replace(fit, problem=LeastSquaresProblem(opened, fit.problem.around), u=u)


def _of_data(fit: Fit) -> NDArray[np.float64]:
    """Information of the data on the parameters, in units of their priors'."""
    J = fit.problem.jacobian(fit.u)
    count, readings = len(fit.spec.fitted), len(J) - len(fit.u)
    own, others = J[:readings, :count], J[:readings, count:]
    between = own.T @ others
    known = others.T @ others + np.eye(others.shape[1])
    data = own.T @ own - between @ np.linalg.solve(known, between.T)
    return (data + data.T) / 2
