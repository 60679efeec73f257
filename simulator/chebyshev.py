"""Interpolation of smooth functions of one variable at the Chebyshev extrema.

The error falls by an order of magnitude with every few nodes. Doubling the number of intervals
keeps all existing nodes. The values at the new nodes measure the error of the coarser interpolant,
which bounds the error of the finer one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arrays import Real


@dataclass(frozen=True)
class Interpolant:
    """Polynomial through values at Chebyshev extrema.

    nodes: ascending, from `extrema`, shape (node,). values: shape (node, ...).
    """

    nodes: Real
    values: NDArray[Any]

    def __call__(self, x: ArrayLike) -> NDArray[Any]:
        """Interpolated values between the first node and the last, shape (*x, ...)."""
        return np.tensordot(barycentric(self.nodes, x), self.values, 1)


def extrema(low: float, high: float, count: int) -> Real:
    """Chebyshev extrema between two numbers, both ends included, ascending.

    Every second of 2 n - 1 extrema equals one of n extrema to the last bit.
    """
    x = low + (high - low) * (1 - np.cos(np.pi * np.arange(count) / (count - 1))) / 2
    x[[0, -1]] = low, high
    return x


def barycentric(nodes: Real, x: ArrayLike) -> Real:
    """Weights of Lagrange's polynomials through Chebyshev's extrema, shape (*x, node).

    At a node one weight is 1 and all others are 0. Source: J.-P. Berrut and L. N. Trefethen,
    SIAM Review 46 (2004) 501, eq. 5.4.
    """
    sign = (-1.0) ** np.arange(len(nodes))
    sign[[0, -1]] /= 2
    away = np.asarray(x)[..., None] - nodes
    met = away == 0
    shares = sign / np.where(met, 1.0, away)
    shares = np.where(met.any(axis=-1, keepdims=True), met, shares)
    return shares / shares.sum(axis=-1, keepdims=True)


def refined(
    values: Callable[[Real], NDArray[Any]],
    bounds: tuple[float, float],
    counts: tuple[int, int],
    close: Callable[[NDArray[Any], NDArray[Any]], bool],
) -> Interpolant | None:
    """Interpolant with as many nodes as are needed, doubled until it is close to the function.

    values: the function at given numbers, shape (number, ...). counts: first and largest number of
    nodes. close: compares interpolated with true values between the nodes; True ends the
    refinement. Returns None if the largest number of nodes does not suffice.
    """
    count, most = counts
    nodes = extrema(*bounds, count)
    found = Interpolant(nodes, values(nodes))
    while 2 * count - 1 <= most:
        finer = extrema(*bounds, 2 * count - 1)
        between = values(finer[1::2])
        enough = close(found(finer[1::2]), between)
        found = Interpolant(finer, np.insert(found.values, np.arange(1, count), between, axis=0))
        if enough:
            return found
        count = len(finer)
    return None
