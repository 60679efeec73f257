"""The potential of one sheet: products of Lagrange polynomials along x and along y."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from .lines import EVEN, Array, lagrange, lobatto


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
