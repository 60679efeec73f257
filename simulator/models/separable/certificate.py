"""A bound on what products of modes leave out of Rs and Cp: from the residual, of second order.

With r = (K + s M) u of the reduced potentials u at 1 V, |Y - Y_r| <= sqrt(2) r*(K + omega M)^-1 r,
and there K + omega c, with c the least anywhere, instead of K + omega M is an upper bound. In modes
both are diagonal. Of the modes beyond those that r is measured in, only what r has there in all is
needed: the square integral of s c u less the modes' share of it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...fem.estimate import certified
from ...press.touch import Box
from .modes import Products, interval, touched_mass


class Cells(NamedTuple):
    """A press as a sum of rectangles: what each adds to c over that at rest, and to its square."""

    rises: list[tuple[Box, float]]
    squares: list[tuple[Box, float]]


def certificate(
    kept: Products,
    wider: Products,
    cells: Cells,
    least: float,
    s: NDArray[np.complex128],
    Y: NDArray[np.complex128],
) -> NDArray[np.float64]:
    """Bound on the relative errors of Rs and Cp of Y in S, shape (2, s); inf where it says nothing.

    wider: all products of more modes, with one mode more along each side. least: a bound from below
    of c over that at rest. s: rad/s.
    """
    x, reduced = _potentials(kept, cells, s)
    grid = _on_grid(kept, x)
    charge = _charge(wider, cells.rises, grid)
    residual = s[:, None, None] * charge
    residual[:, : grid.shape[1], : grid.shape[2]] += _on_grid(kept, kept.conductance * x)
    beyond = np.abs(s) ** 2 * (
        _square(wider, cells.squares, grid) - (np.abs(charge) ** 2).sum(axis=(1, 2))
    )
    share = s.imag * least * wider.capacitance
    conductance = wider.conductance.reshape(charge.shape[1:])
    power = (np.abs(residual) ** 2 / (conductance + share[:, None, None])).sum(axis=(1, 2))
    power += np.maximum(beyond, 0.0) / (_next_conductance(wider) + share)
    return certified(Y, power, np.abs(reduced - Y))


def _potentials(
    kept: Products, cells: Cells, s: NDArray[np.complex128]
) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Deviations from 1 V in the products kept, shape (s, product), and Y in S, shape (s,)."""
    boxes = np.array([box for box, _ in cells.rises]).reshape(-1, 4)
    mass, start, area = touched_mass(kept, boxes, np.array([rise for _, rise in cells.rises]))
    root = 1 / np.sqrt(kept.conductance)
    mu, Q = np.linalg.eigh(root[:, None] * mass * root)
    slow = (Q.T @ (root * start)) / (1 + np.multiply.outer(s, mu))
    x = -s[:, None] * (slow @ Q.T) * root
    return x, s * kept.capacitance * area + s * (x @ start)


def _on_grid(kept: Products, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Of each product its place in a rectangle, shape (s, mode along x, mode along y)."""
    grid = np.zeros((len(values), len(kept.counts), int(kept.counts[0])), complex)
    grid[:, np.arange(grid.shape[2]) < kept.counts[:, None]] = values
    return grid


def _charge(
    wider: Products, rises: list[tuple[Box, float]], x: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    """M (1 V + x) in C in all modes of `wider`, shape (s, mode along x, mode along y)."""
    columns, rows = len(wider.counts), int(wider.counts[0])
    charge = np.zeros((len(x), columns, rows), complex)
    charge += np.multiply.outer(wider.x.total[:columns], wider.y.total[:rows])
    charge[:, : x.shape[1], : x.shape[2]] += x
    for (left, right, bottom, top), rise in rises:
        (along, in_x), (across, in_y) = (
            interval(wider.x, left, right),
            interval(wider.y, bottom, top),
        )
        part = along[:columns, : x.shape[1]] @ x @ across[: x.shape[2], :rows]
        charge += rise * (part + np.multiply.outer(in_x[:columns], in_y[:rows]))
    charge *= wider.capacitance
    return charge


def _square(
    wider: Products, squares: list[tuple[Box, float]], x: NDArray[np.complex128]
) -> NDArray[np.float64]:
    """Integral of |c (1 V + x)|² over the skin, C²/m², shape (s,)."""
    whole = Box(0.0, wider.x.length, 0.0, wider.y.length)
    total = np.zeros(len(x))
    for (left, right, bottom, top), rise in [(whole, 1.0), *squares]:
        (along, in_x), (across, in_y) = (
            interval(wider.x, left, right),
            interval(wider.y, bottom, top),
        )
        along, across = along[: x.shape[1], : x.shape[1]], across[: x.shape[2], : x.shape[2]]
        linear = 2 * (np.einsum("i,sij,j->s", in_x[: x.shape[1]], x, in_y[: x.shape[2]])).real
        quadratic = (x.conj() * (along @ x @ across)).sum(axis=(1, 2)).real
        total += rise * ((right - left) * (top - bottom) + linear + quadratic)
    return wider.capacitance**2 * total


def _next_conductance(wider: Products) -> float:
    """K of the first product left out, S."""
    x, y = wider.x.eigenvalues, wider.y.eigenvalues
    per_square = wider.conductance[0] / (x[0] + y[0])
    return float(per_square * min(x[-1] + y[0], x[0] + y[-1]))
