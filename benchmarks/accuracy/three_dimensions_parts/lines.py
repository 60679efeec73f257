"""Elements of variable order along one axis: half of it, from the middle of the skin outwards.

A skin is symmetric about its middle, so that its fields are sums of even and odd ones, and one half
of each axis is enough. Elements shrink geometrically towards the sheet's edge, where charges are
singular, and grow geometrically into the air beyond it, where the order is that of far elements.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

Array = NDArray[np.float64]

EVEN, ODD = 1, -1
ORDERS_AT_THE_EDGE = 2
"""Of the smallest element; the order rises by one from each element to the next, larger one."""

CLEAR = 0.6
"""Of a length that is divided geometrically, up to where lines are drawn: the last element is no
sliver."""


@dataclass(frozen=True)
class Grid:
    """Resolution of the static solve.

    finest: smallest element at the sheet's edge over the foam's thickness. ratio: of the lengths of
    neighbouring elements. order: of the largest elements. far: from the sheet's edge to the walls
    of the box, which are at earth's potential, over the sheet's longer side.
    """

    finest: float = 0.05
    ratio: float = 0.2
    order: int = 4
    far: float = 25.0

    def coarser(self) -> Grid:
        """Larger elements of one order less in a nearer box: what these move bounds the error."""
        return replace(self, finest=3 * self.finest, order=self.order - 1, far=self.far / 3)

    def finer(self) -> Grid:
        """Smaller elements at the edge in a wider box."""
        return replace(self, finest=self.finest / 3, far=3 * self.far)


@dataclass(frozen=True)
class Line:
    """Stiffness K and mass M along half an axis: of all, inside the sheet, and in its middle cell.

    nodes: m from the middle, shape (node,), those inside the sheet first. inside: their number.
    """

    nodes: Array
    inside: int
    K: Array
    M: Array
    K_inside: Array
    M_inside: Array
    K_middle: Array
    M_middle: Array

    def of_parity(self, parity: int, bounded: bool) -> Line:
        """Fields of a parity: odd ones are 0 in the middle, and all are 0 at the far bound."""
        first = int(parity == ODD)
        kept = np.s_[first : -1 if bounded else None]
        names = "K", "M", "K_inside", "M_inside", "K_middle", "M_middle"
        matrices = (getattr(self, name)[kept, kept] for name in names)
        return Line(self.nodes[kept], self.inside - first, *matrices)


def uniform_line() -> Line:
    """The axis along which nothing varies: for cross-sections, for each metre of it."""
    one, zero = np.ones((1, 1)), np.zeros((1, 1))
    return Line(np.zeros(1), 1, zero, one, zero, one, zero, one)


def half_line(
    cells: Array, thickness: float, grid: Grid, far: float | None, shift: float = 0.0
) -> Line:
    """Elements along half an axis.

    cells: lines between the sheet's own elements from 0 in the middle to the edge, m. far: to where
    there is air beyond the edge, m; None for an insulated edge. shift [m]: by which the edge is
    moved inwards.
    """
    orders = [grid.order] * (len(cells) - 1)
    if far is None:
        return _assembled(cells, orders, len(orders))
    edge, last, first = cells[-1] - shift, cells[-2], grid.finest * thickness
    small = graded(first, grid.ratio, edge - last)
    inner = np.concatenate([cells[:-1], edge - small[::-1], [edge]])
    outer = np.append(edge + graded(first, grid.ratio, far), edge + far)
    rising = (_rising(count, grid.order) for count in (len(small) + 1, len(outer)))
    orders = [*orders[1:], *next(rising)[::-1], *next(rising)]
    return _assembled(np.concatenate([inner, outer]), orders, len(inner) - 1)


def graded(first: float, ratio: float, length: float) -> Array:
    """Distances from an edge that grow by 1 / ratio from `first` on and stay clear of `length`."""
    count = int(np.floor(np.log(CLEAR * length / first) / -np.log(ratio))) + 1
    return first * ratio ** -np.arange(max(count, 0) + 0.0)


def _rising(count: int, order: int) -> list[int]:
    return [min(ORDERS_AT_THE_EDGE + index, order) for index in range(count)]


def _assembled(breaks: Array, orders: list[int], cells_inside: int) -> Line:
    size = sum(orders) + 1
    whole, nodes, start, marked = np.zeros((2, size, size)), np.zeros(size), 0, []
    for index, (low, high, order) in enumerate(zip(breaks[:-1], breaks[1:], orders, strict=True)):
        here = np.s_[start : start + order + 1]
        reference, stiffness, mass = element(order)
        nodes[here] = low + (high - low) * (reference + 1) / 2
        whole[0][here, here] += stiffness * 2 / (high - low)
        whole[1][here, here] += mass * (high - low) / 2
        start += order
        if index in (0, cells_inside - 1):
            marked.append((start + 1, whole.copy()))
    (_, middle), (last, inside) = marked[0], marked[-1]
    return Line(nodes, last, *whole, *inside, *middle)


def element(order: int) -> tuple[Array, Array, Array]:
    """Nodes, stiffness and mass of an element of Gauss-Lobatto nodes on -1..1."""
    nodes = lobatto(order)
    at, weights = legendre.leggauss(order + 1)
    values, slopes = lagrange(nodes, at)
    return nodes, slopes.T @ (weights[:, None] * slopes), values.T @ (weights[:, None] * values)


@cache
def lobatto(order: int) -> Array:
    """Gauss-Lobatto nodes on -1..1, shape (order + 1,)."""
    inner = legendre.legroots(legendre.legder([0] * order + [1]))
    nodes = np.concatenate([[-1.0], np.sort(inner), [1.0]])
    nodes.flags.writeable = False
    return nodes


def lagrange(nodes: Array, at: Array) -> tuple[Array, Array]:
    """Values and slopes of the Lagrange polynomials of nodes, shapes (at, node)."""
    degree = len(nodes) - 1
    to_legendre = np.linalg.inv(legendre.legvander(nodes, degree))
    slopes = legendre.legval(at, legendre.legder(np.eye(degree + 1))).T
    return legendre.legvander(at, degree) @ to_legendre, slopes @ to_legendre
