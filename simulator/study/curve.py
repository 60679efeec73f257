"""Z of one pixel against the strength of its press: a few solves, then Chebyshev interpolation.

ln Z is smooth in ln(factor), so a polynomial through a few factors converges by an order of
magnitude with each. The polynomials are nested: the solves that a finer one adds measure the error
of the coarser one, which bounds its own.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from numpy.typing import ArrayLike, NDArray

from ..fem.estimate import relative_difference

NODES = (3, 5, 9, 17, 33)


@dataclass(frozen=True)
class Curve:
    """ln Z at some factors, shape (node, interface, frequency), and whether to go between them."""

    factors: NDArray[np.float64]
    logarithm: NDArray[np.complex128]
    interpolated: bool

    def impedance(self, factors: ArrayLike) -> NDArray[np.complex128]:
        """Z in ohm, shape (factor, interface, frequency)."""
        return np.exp(np.einsum("fn,nik->fik", self._weights(np.asarray(factors)), self.logarithm))

    def at(self, frequencies: NDArray[np.int64], scale: float) -> Curve:
        """The same at some of the frequencies, by index, with Z times a scale."""
        return replace(self, logarithm=self.logarithm[:, :, frequencies] + np.log(scale))

    def _weights(self, factors: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of each node in each factor, shape (factor, node)."""
        if not self.interpolated:
            return (factors[:, np.newaxis] == self.factors).astype(float)
        return self._polynomials(factors) @ self._of_nodes

    @cached_property
    def _of_nodes(self) -> NDArray[np.float64]:
        """Coefficients of each node's own polynomial, shape (polynomial, node)."""
        return np.linalg.inv(self._polynomials(self.factors)).astype(np.float64)

    def _polynomials(self, factors: NDArray[np.float64]) -> NDArray[np.float64]:
        """Chebyshev's, up to one for each node, shape (factor, polynomial)."""
        found = chebvander(self._between_ends(factors), len(self.factors) - 1)
        return found.astype(np.float64)

    def _between_ends(self, factors: NDArray[np.float64]) -> NDArray[np.float64]:
        """ln(factor) mapped to -1 at the first node and 1 at the last."""
        low, high = np.log(self.factors[[0, -1]])
        return (2 * np.log(factors) - low - high) / (high - low)


def trace(
    solve: Callable[[float], NDArray[np.complex128]],
    factors: ArrayLike,
    rtol: float,
) -> Curve:
    """The curve that gives Z at these factors with an error of Rs and Cp of at most `rtol`.

    solve: Z in ohm of a factor, shape (interface, frequency). factors: > 0. Factors
    are solved one by one where there are fewer of them than a polynomial would need.
    """
    wanted = np.unique(factors)
    known: dict[float, NDArray[np.complex128]] = {}
    for coarse, fine in itertools.pairwise(NODES):
        if fine >= wanted.size:
            break
        nodes = _nodes(float(wanted[0]), float(wanted[-1]), fine)
        known |= {node: solve(node) for node in nodes if node not in known}
        curve = _through(known, nodes)
        coarser = _through(known, nodes[:: (fine - 1) // (coarse - 1)])
        Z, expected = curve.impedance(curve.factors), coarser.impedance(curve.factors)
        if (relative_difference(expected, Z) <= rtol).all():
            return curve
    known |= {factor: solve(factor) for factor in wanted.tolist() if factor not in known}
    return replace(_through(known, wanted.tolist()), interpolated=False)


def _through(known: dict[float, NDArray[np.complex128]], factors: list[float]) -> Curve:
    ln_Z = np.log(np.stack([known[factor] for factor in factors]))
    return Curve(np.array(factors), ln_Z, interpolated=True)


def _nodes(low: float, high: float, count: int) -> list[float]:
    """Extrema of a Chebyshev polynomial in ln(factor), ascending; those of fewer are among them."""
    most = NODES[-1] - 1
    x = -np.cos(np.pi * np.arange(0, most + 1, most // (count - 1)) / most)
    inner = np.exp((np.log(low) + np.log(high) + x * (np.log(high) - np.log(low))) / 2)
    return [low, *inner[1:-1].tolist(), high]
