"""Air without the foam's loss, in models with one variable s for all capacitance.

K + s M with s of the foam gives air the foam's loss. With p = j omega / s times the capacitance of
all that is in air, air has none. p is complex, but all models take real M. An admittance is an
analytic function of p wherever the real part of p is above 0. So it is interpolated from real p,
with the same weights as potentials and derivatives.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Complex, Real
from ..sweeps import ToleranceError
from .frequency import LOSSLESS, Loss, laplace_variable

SPREAD, MIN_REACH = 3.0, 0.03
"""Reach of the nodes over that of p, and their least reach: near nodes would amplify errors."""
MAX_NODES = 24
ROUGHEST = 1e-7
"""Largest error: slopes of the interpolation by the loss are then those of the skin."""
ROUNDING = 1e-14
NEAR = np.exp(1j * np.pi / 3)
"""Place x up to which an admittance is taken as analytic: beyond, its p has no positive real part.
"""


class AirNodes(NamedTuple):
    """Factors p on the capacitance in air, and the weights of their answers.

    factors: real, shape (node,). weights: shape (node, frequency); (1, 1) where the foam has no
    loss. precision: tolerance of each answer over that of their mean.
    """

    factors: Real
    weights: Complex
    precision: float

    @property
    def single(self) -> bool:
        """True if nothing is interpolated."""
        return len(self.factors) == 1

    def mean(self, answers: Iterable[NDArray], axis: int = -1) -> Complex:
        """Weighted sum of the answers of all nodes. axis: that of the frequencies, from the end."""
        behind = tuple(range(axis + 1, 0))
        each = zip(self.weights, answers, strict=True)
        return np.asarray(sum(np.expand_dims(w, behind) * own for w, own in each))


LOSSLESS_FOAM = AirNodes(np.ones(1), np.ones((1, 1), dtype=np.complex128), 1.0)


def air_factor(frequency: ArrayLike, loss: Loss) -> Complex:
    """Factor p = j omega / s on the capacitance in air. frequency: Hz."""
    omega = 2 * np.pi * np.asarray(frequency, dtype=np.float64)
    return (1j * omega / laplace_variable(frequency, loss)).astype(np.complex128)


class Nodes(NamedTuple):
    """Places x = (p - mean) / (p + mean) of real factors p, shape (node,), and their reach."""

    places: Real
    mean: float
    reach: float

    @property
    def factors(self) -> Real:
        """The factors p."""
        return self.mean * (1 + self.places) / (1 - self.places)


def air_nodes(frequency: Real, loss: Loss, rtol: float) -> AirNodes:
    """Nodes that interpolate Rs and Cp within rtol at frequencies in Hz, see `nodes_of`."""
    if loss == LOSSLESS:
        return LOSSLESS_FOAM
    p = air_factor(frequency, loss)
    nodes = nodes_of(p, rtol)
    weights = _weights(nodes.places, (p - nodes.mean) / (p + nodes.mean))
    precision = min(nodes.reach, 1.0) / float(np.abs(weights).sum(axis=0).max())
    return AirNodes(nodes.factors, weights, precision)


def nodes_of(p: Complex, rtol: float) -> Nodes:
    """Fewest nodes that interpolate Rs and Cp within rtol, or ROUGHEST, at all factors p.

    With x = (p - m) / (p + m), m a mean of |p|, an admittance is analytic for |x| < 1. That bounds
    the error of a polynomial in x. Rs may be all loss, so errors count over |x|. Raises
    ToleranceError if MAX_NODES do not suffice, because the foam conducts too much.
    """
    mean = float(np.sqrt(np.abs(p).min() * np.abs(p).max()))
    x = (p - mean) / (p + mean)
    farthest = float(np.abs(x).max())
    reach = max(min(SPREAD * farthest, farthest**0.5), MIN_REACH)
    for count in range(2, MAX_NODES + 1):
        nodes = reach * np.cos(np.pi * (np.arange(count) + 0.5) / count)
        left = np.abs(x[:, None] - nodes).prod(axis=1).max() / np.abs(NEAR - nodes).prod()
        if left <= min(rtol, ROUGHEST) * farthest + ROUNDING:
            return Nodes(nodes, mean, reach)
    raise ToleranceError(
        "the foam conducts too much for a reduced model with [surroundings], whose air does not: "
        "give a smaller loss, or a phase_exponent nearer to 1"
    )


def _weights(nodes: Real, x: Complex) -> Complex:
    """Lagrange's polynomials of the nodes at x, shape (node, frequency)."""
    others = [np.delete(nodes, k) for k in range(len(nodes))]
    return np.stack(
        [
            ((x[:, None] - other) / (node - other)).prod(axis=1)
            for node, other in zip(nodes, others, strict=True)
        ]
    )
