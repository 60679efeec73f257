"""Elements of the static solve: half axes of variable order, sheets' potentials, and charges on the
planes between layers, exact across each layer.

A skin is symmetric about its middle, so that its fields are sums of even and odd ones, and one half
of each axis is enough. Elements shrink geometrically towards the sheet's edge, where charges are
singular, and grow geometrically into the air beyond it, where the order is that of far elements.

In a layer whose permittivity does not vary across it, potentials are sums of modes phi(x, y) with
K phi = lambda M phi, K and M weighted by the permittivity, times hyperbolic functions of
sqrt(lambda) z. The charge on a plane is M Phi g(lambda) Phi' M u, g the mode's admittance. In
uniform layers the modes are products of those along x and along y.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.linalg import eigh

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


@dataclass(frozen=True)
class Axis:
    """Functions along one whole axis. cells: lines from 0 to the length, symmetric about its
    middle, m; order: of the polynomials."""

    cells: Array
    order: int

    @property
    def nodes(self) -> Array:
        """m, shape (node,)."""
        reference = (lobatto(self.order) + 1) / 2
        inner = self.cells[:-1, None] + np.diff(self.cells)[:, None] * reference[:-1]
        return np.append(inner.ravel(), self.cells[-1])

    @property
    def half(self) -> Array:
        """Lines from the middle to the edge, m from the middle."""
        middle = self.cells[-1] / 2
        beyond = self.cells[self.cells > middle * (1 + 1e-9)] - middle
        return np.append(0.0, beyond)

    def at(self, x: Array) -> tuple[Array, Array]:
        """Values and slopes of all functions at places x, shapes (place, node)."""
        cell = np.clip(np.searchsorted(self.cells, x, "right") - 1, 0, len(self.cells) - 2)
        size = np.diff(self.cells)[cell]
        own = lagrange(lobatto(self.order), 2 * (x - self.cells[cell]) / size - 1)
        filled = np.zeros((2, len(x), len(self.cells[1:]) * self.order + 1))
        at = np.arange(len(x))[:, None], cell[:, None] * self.order + np.arange(self.order + 1)
        filled[0][at], filled[1][at] = own[0], own[1] * 2 / size[:, None]
        return filled[0], filled[1]

    def parity(self, parity: int) -> Array:
        """The coefficients' part of a parity: u_i + parity u_mirrored, shape (pair, node).

        The middle node belongs to the even part alone.
        """
        size = len(self.cells[1:]) * self.order + 1
        one = np.eye(size)
        folded = (one + parity * one[::-1])[: (size + 1) // 2]
        if size % 2:
            folded[-1] /= 2
            folded = folded if parity == EVEN else folded[:-1]
        return folded

    def halved(self, parity: int, nodes: Array) -> Array:
        """The parts of a parity of the first half of the functions at nodes from the middle.

        Shape (node, pair); those of the mirrored functions are the same or the negative.
        """
        middle = self.cells[-1] / 2
        right, left = self.at(middle + nodes)[0], self.at(middle - nodes)[0]
        folded = (right + parity * left) / 2
        return folded[:, : len(self.parity(parity))]

    def quadrature(self, low: float, high: float, more: int = 2) -> tuple[Array, Array]:
        """Gauss points and weights on low..high, within each cell by themselves."""
        between = self.cells[(self.cells > low) & (self.cells < high)]
        lines = np.concatenate([[low], between, [high]])
        at, weights = legendre.leggauss(self.order + more)
        half = np.diff(lines)[:, None] / 2
        return (lines[:-1, None] + half * (at + 1)).ravel(), (half * weights).ravel()


@dataclass(frozen=True)
class Places:
    """Places of the sheet with weights, for integrals over a part of it or along a line of it.

    x, y: m, shape (place,). values, along_x, along_y: of all functions there and their slopes,
    shape (place, node); weights in m² or m.
    """

    x: Array
    y: Array
    values: Array
    along_x: Array
    along_y: Array
    weights: Array

    def mass(self, factor: Array | float = 1.0) -> Array:
        """Integral of factor times u v, shape (node, node)."""
        return self.values.T @ ((self.weights * factor)[:, None] * self.values)

    def stiffness(self, factor: Array | float = 1.0) -> Array:
        """Integral of factor times grad u . grad v."""
        by = (self.weights * factor)[:, None]
        return self.along_x.T @ (by * self.along_x) + self.along_y.T @ (by * self.along_y)


@dataclass(frozen=True)
class Sheet:
    """Both axes of a sheet; its functions are products, y running fastest."""

    x: Axis
    y: Axis

    @property
    def size(self) -> int:
        """Number of functions."""
        return len(self.x.nodes) * len(self.y.nodes)

    def points(self, x: Array, y: Array, weights: Array) -> Places:
        """Places (x, y) with weights, all of shape (place,)."""
        (X, dX), (Y, dY) = self.x.at(x), self.y.at(y)

        def product(first: Array, second: Array) -> Array:
            return (first[:, :, None] * second[:, None]).reshape(len(x), self.size)

        return Places(x, y, product(X, Y), product(dX, Y), product(X, dY), weights)

    def rectangle(self, left: float, right: float, bottom: float, top: float) -> Places:
        """Exact for products of the functions."""
        (x, by_x), (y, by_y) = self.x.quadrature(left, right), self.y.quadrature(bottom, top)
        at = (each.ravel() for each in np.meshgrid(x, y, indexing="ij"))
        return self.points(*at, np.outer(by_x, by_y).ravel())

    def whole(self) -> Places:
        """The whole sheet."""
        return self.rectangle(0.0, self.x.cells[-1], 0.0, self.y.cells[-1])


EPS0 = 8.8541878128e-12
"""Permittivity of vacuum, F/m (CODATA 2018)."""

SHIFT = 1e-4
"""1/m², of all lambda while modes are sought: a constant, whose lambda is 0, may be one of them."""

Admittance = Callable[[Array], Array]
"""Of modes by lambda: charge for a potential of 1, over the permittivity."""


@dataclass(frozen=True)
class Outside:
    """What lies on one side of the skin: uniform slabs without end, then air or an earthed plane.

    slabs: thickness in m and relative permittivity of each, the nearest first. earthed: whether the
    last slab ends at an earthed plane; otherwise air follows.
    """

    slabs: tuple[tuple[float, float], ...] = ()
    earthed: bool = False

    def admittance(self, values: Array, air: float) -> Array:
        """Of modes, F/m² times m²; air: relative permittivity beyond the slabs."""
        root = np.sqrt(values)
        seen = np.full_like(root, np.inf) if self.earthed else EPS0 * air * root
        for thickness, permittivity in reversed(self.slabs):
            seen = _through(root, thickness, EPS0 * permittivity, seen)
        return seen


def body(distance: float, permittivity: float = 1.0) -> Outside:
    """An earthed plane at a distance, m."""
    return Outside(((distance, permittivity),), earthed=True)


def _through(root: Array, thickness: float, permittivity: float, beyond: Array) -> Array:
    """The admittance that is seen through a slab, as along a transmission line."""
    own, tanh = permittivity * root, np.tanh(root * thickness)
    with np.errstate(divide="ignore", invalid="ignore"):
        short = np.where(root * thickness > 1e-6, own / tanh, permittivity / thickness)
        matched = own * (beyond + own * tanh) / (own + beyond * tanh)
    open_or_load = np.where(root > 0, matched, 0.0)
    return np.where(np.isinf(beyond), short, open_or_load)


def across(values: Array, thickness: float) -> tuple[Array, Array]:
    """Own and mutual admittance of the two faces of a layer, 1/m."""
    by = np.sqrt(values) * thickness
    small = by < 1e-6
    safe = np.where(small, 1.0, np.minimum(by, 700.0))
    own = np.where(small, 1.0, safe / np.tanh(safe)) / thickness
    own = np.where(by > 700, np.sqrt(values), own)
    return own, -np.where(small, 1.0, safe / np.sinh(safe)) / thickness


def uniform(x: Line, y: Line, admittance: Admittance) -> Array:
    """Charges by potentials of all nodes of a plane, shape (node, node), y running fastest."""
    (along_x, X), (along_y, Y) = _modes(x), _modes(y)
    g = admittance(along_x[:, None] + along_y)
    pairs_y = np.einsum("ij,bj,dj->ibd", g, Y, Y, optimize=True)
    pairs_x = (X[:, None] * X).reshape(-1, len(along_x))
    size, other = len(X), len(Y)
    D = (pairs_x @ pairs_y.reshape(len(along_x), -1)).reshape(size, size, other, other)
    return np.ascontiguousarray(D.transpose(0, 2, 1, 3)).reshape(size * other, size * other)


def _modes(line: Line) -> tuple[Array, Array]:
    """lambda, shape (mode,), and M times the modes, shape (node, mode)."""
    return modes_of(line.K, line.M)


def modes_of(K: Array, M: Array) -> tuple[Array, Array]:
    """lambda of K phi = lambda M phi, shape (mode,), and M phi of modes of mass 1.

    Elements range over six decades in size. The pencil is inverted so that rounding spares the slow
    modes, on which everything depends, and not the fastest.
    """
    inverse, modes = eigh(M, K + SHIFT * M, driver="gvd", check_finite=False)
    inverse = np.maximum(inverse, np.finfo(float).eps * inverse[-1])
    return np.maximum(1 / inverse - SHIFT, 0.0), M @ (modes / np.sqrt(inverse))


@dataclass(frozen=True)
class Foam:
    """The modes of a layer with a block of foam within the sheet's bounds and air around it."""

    values: Array
    loaded: Array

    def charges(self, thickness: float) -> tuple[Array, Array]:
        """Own and mutual charges of both faces by the potentials there, shape (node, node)."""
        own, mutual = (
            self.loaded @ (each[:, None] * self.loaded.T) for each in across(self.values, thickness)
        )
        return own, mutual


def foam_modes(x: Line, y: Line, permittivity: float, air: float, middle: float = 1.0) -> Foam:
    """permittivity, air: relative, of the block and around it. middle: a factor on the permittivity
    in the middle cell of the sheet."""
    K = EPS0 * air * (np.kron(x.K, y.M) + np.kron(x.M, y.K))
    M = EPS0 * air * np.kron(x.M, y.M)
    more = EPS0 * (permittivity - air)
    K += more * (np.kron(x.K_inside, y.M_inside) + np.kron(x.M_inside, y.K_inside))
    M += more * np.kron(x.M_inside, y.M_inside)
    rise = EPS0 * permittivity * (middle - 1)
    K += rise * (np.kron(x.K_middle, y.M_middle) + np.kron(x.M_middle, y.K_middle))
    M += rise * np.kron(x.M_middle, y.M_middle)
    return Foam(*modes_of(K, M))
