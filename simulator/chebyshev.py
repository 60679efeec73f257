"""Smooth functions of one number, through their values at Chebyshev's extrema.

The polynomials converge by an order of magnitude with each few nodes, and twice as many intervals
keep the nodes there are: what is found at those between measures the error of the coarser one,
which bounds that of the finer.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Interpolant:
    """nodes: ascending, as of `extrema`, shape (node,). values: shape (node, ...)."""

    nodes: Array
    values: NDArray[Any]

    def __call__(self, x: ArrayLike) -> NDArray[Any]:
        """The function between the first node and the last, shape (*x, ...)."""
        return np.tensordot(barycentric(self.nodes, x), self.values, 1)


def extrema(low: float, high: float, count: int) -> Array:
    """Those of a Chebyshev polynomial between two numbers and at both, ascending; every second one
    of 2 n - 1 is one of n, to the bit."""
    x = low + (high - low) * (1 - np.cos(np.pi * np.arange(count) / (count - 1))) / 2
    x[[0, -1]] = low, high
    return x


def barycentric(nodes: Array, x: ArrayLike) -> Array:
    """Weights of Lagrange's polynomials through Chebyshev's extrema, shape (*x, node).

    At a node they are 1 and 0, whatever the others are. Source: J.-P. Berrut and L. N. Trefethen,
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
    values: Callable[[Array], NDArray[Any]],
    bounds: tuple[float, float],
    counts: tuple[int, int],
    close: Callable[[NDArray[Any], NDArray[Any]], bool],
) -> Interpolant | None:
    """An interpolant within bounds of twice as many intervals as are close to values between.

    values: at some numbers, shape (number, ...). counts: of nodes, at first and at most. close:
    whether what is interpolated serves in place of such values. None where not even most nodes do.
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
