"""How surely each parameter is told, and which only together: from the Gauss-Newton information.

All in deviations of the parameters' priors: the information of the data is then 1 in a direction
that they tell as well as the prior does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .fit import Fit

TOLD = 0.25
"""Of the prior's deviation: what is left of it where the data tell a parameter."""
PART = 0.2
"""Of a direction: a parameter with a smaller share is not what it moves."""
SEEN = 4.0
"""Chi-squared that a parameter's share alone would make, where it has a part in a direction."""


@dataclass(frozen=True)
class Information:
    """Of the fitted parameters.

    data: information of the data alone, (parameter, parameter), all else that is unknown and the
    size of the residuals accounted for. scale: chi-squared per degree of freedom, at least 1, that
    errors were enlarged by.
    """

    names: tuple[str, ...]
    data: NDArray[np.float64]
    scale: float

    @property
    def covariance(self) -> NDArray[np.float64]:
        """With the prior."""
        return np.linalg.inv(self.data + np.eye(len(self.names))).astype(np.float64)

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
        """Whether the data tell a parameter better than its prior by far."""
        return dict(zip(self.names, (self.deviation < TOLD).tolist(), strict=True))

    @property
    def weak(self) -> list[NDArray[np.float64]]:
        """Unit directions that the data hardly tell, the weakest first."""
        strength, directions = np.linalg.eigh(self.data)
        return [directions[:, k] for k in np.flatnonzero(strength < 1 / TOLD**2 - 1)]

    def moved(self, direction: NDArray[np.float64]) -> list[str]:
        """Parameters that a direction moves most, the largest first."""
        order = np.argsort(-np.abs(direction))
        return [self.names[k] for k in order if abs(direction[k]) > PART]

    def parts(self, direction: NDArray[np.float64]) -> list[str]:
        """Those that undo each other's effect along it, the largest first; or one without any."""
        effect = direction**2 * self.data.diagonal()
        order = [k for k in np.argsort(-np.abs(direction)) if effect[k] > SEEN]
        return [self.names[k] for k in order] if len(order) > 1 else self.moved(direction)[:1]


def freedom(fit: Fit, told: int) -> int:
    """Numbers beyond what is fitted; strengths and fixed errors of the meter have priors."""
    return max(fit.asked.measured.numbers - told, 1)


def information(fit: Fit) -> Information:
    """At a solution."""
    J = fit.problem.jacobian(fit.u)
    count, readings = len(fit.asked.fitted), len(J) - len(fit.u)
    own, others = J[:readings, :count], J[:readings, count:]
    between = own.T @ others
    known = others.T @ others + np.eye(others.shape[1])
    data = own.T @ own - between @ np.linalg.solve(known, between.T)
    told = Information(fit.asked.names, data, 1.0)
    scale = max(1.0, fit.chi_squared / freedom(fit, sum(told.told.values())))
    return Information(fit.asked.names, (data + data.T) / 2 / scale, scale)
