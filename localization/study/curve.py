"""Z of one pixel against the strength of its press: a few solves, then interpolation.

ln Z is smooth in ln(factor), see `chebyshev`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...simulator.chebyshev import barycentric, refined
from ...simulator.fem.estimate import relative_difference

NODES = (3, 5, 9, 17, 33)


@dataclass(frozen=True)
class Curve:
    """ln Z at some factors, shape (node, interface, frequency).

    Factors are Chebyshev's in ln(factor), or all that are asked for.
    """

    factors: NDArray[np.float64]
    logarithm: NDArray[np.complex128]

    def impedance(self, factors: ArrayLike) -> NDArray[np.complex128]:
        """Z in ohm, shape (factor, interface, frequency)."""
        weights = barycentric(np.log(self.factors), np.log(factors))
        return np.exp(np.tensordot(weights, self.logarithm, 1))

    def at(self, frequencies: NDArray[np.int64], scale: float) -> Curve:
        """The same at some of the frequencies, by index, with Z times a scale."""
        return replace(self, logarithm=self.logarithm[:, :, frequencies] + np.log(scale))


def trace(
    solve: Callable[[float], NDArray[np.complex128]],
    factors: ArrayLike,
    rtol: float,
) -> Curve:
    """The curve that gives Z at these factors with an error of Rs and Cp of at most `rtol`.

    solve: Z in ohm of a factor, shape (interface, frequency). factors: > 0. Factors
    are solved one by one where there are fewer of them than a polynomial would need.
    """

    def solved(factors: NDArray[np.float64]) -> NDArray[np.complex128]:
        return np.log(np.stack([solve(factor) for factor in factors.tolist()]))

    def close(found: NDArray[np.complex128], truth: NDArray[np.complex128]) -> bool:
        return bool((relative_difference(np.exp(found), np.exp(truth)) <= rtol).all())

    wanted = np.unique(factors)
    most = max((count for count in NODES if count < wanted.size), default=0)
    ends = float(np.log(wanted[0])), float(np.log(wanted[-1]))
    if most >= NODES[1]:
        found = refined(lambda x: solved(np.exp(x)), ends, (NODES[0], most), close)
        if found is not None:
            return Curve(np.exp(found.nodes), found.values)
    return Curve(wanted, solved(wanted))
