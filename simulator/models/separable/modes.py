"""Cosines of each side, and those of their products that a meter sees most of."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...fem.lanczos import Pencil, respond

BISECTIONS = 80


class Side(NamedTuple):
    """The first eigenfunctions of one side.

    wavenumber: k_i in 1/m, phase: d_i, amplitude: A_i in m^-1/2, total: their integrals over the
    side in m^1/2; all of shape (mode,). inverse: 1 / (k_i² - k_j²) in m², shape (mode, mode), zero
    on the diagonal. length: m.
    """

    wavenumber: NDArray[np.float64]
    phase: NDArray[np.float64]
    amplitude: NDArray[np.float64]
    total: NDArray[np.float64]
    inverse: NDArray[np.float64]
    length: float

    @property
    def eigenvalues(self) -> NDArray[np.float64]:
        """k_i² in 1/m²."""
        return self.wavenumber**2


def wavenumbers(length: float, at_start: float, at_end: float, count: int) -> NDArray[np.float64]:
    """k_i in 1/m of the first `count` modes, by bisection; arguments as of `side`."""
    number = np.arange(count, dtype=np.float64)
    low, high = number * (np.pi / length), (number + 1) * (np.pi / length)
    if at_start == 0 and at_end == 0:
        return low
    for _ in range(BISECTIONS):
        k = (low + high) / 2
        below = k * length < number * np.pi + np.arctan2(at_start, k) + np.arctan2(at_end, k)
        low, high = np.where(below, k, low), np.where(below, high, k)
    return (low + high) / 2


def side(length: float, at_start: float, at_end: float, count: int) -> Side:
    """The first `count` eigenfunctions. at_start, at_end: h_0 and h_1 in 1/m."""
    k = wavenumbers(length, at_start, at_end, count)
    phase = np.arctan2(at_start, k)
    ends = k * np.array([[0.0], [length]]) - phase
    swing = np.divide(
        np.sin(2 * ends[1]) - np.sin(2 * ends[0]),
        4 * k,
        out=np.full(count, length / 2),
        where=k > 0,
    )
    amplitude = 1 / np.sqrt(length / 2 + swing)
    apart = np.subtract.outer(k**2, k**2)
    np.fill_diagonal(apart, np.inf)
    unfinished = Side(k, phase, amplitude, np.zeros(count), 1 / apart, length)
    return unfinished._replace(total=interval(unfinished, 0.0, length)[1])


def interval(
    side: Side, start: float, stop: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Integrals over an interval: of phi_i phi_j, shape (mode, mode), of phi_i in m^1/2, (mode,).

    From (phi_i phi_j' - phi_i' phi_j)' = (k_i² - k_j²) phi_i phi_j.
    """
    angle = side.wavenumber * np.array([[start], [stop]]) - side.phase
    value = side.amplitude * np.cos(angle)
    slope = -side.amplitude * side.wavenumber * np.sin(angle)
    squares = side.eigenvalues
    product, linear = np.zeros_like(side.inverse), np.zeros_like(squares)
    own = side.amplitude**2 * (stop - start) / 2
    for v, d, sign in ((value[1], slope[1], 1.0), (value[0], slope[0], -1.0)):
        product += sign * (np.multiply.outer(v, d) - np.multiply.outer(d, v)) * side.inverse
        moving = squares > 0
        own[moving] -= sign * (v * d)[moving] / (2 * squares[moving])
        linear[moving] -= sign * d[moving] / squares[moving]
    constant = squares == 0
    own[constant] = (side.amplitude**2 * (stop - start))[constant]
    linear[constant] = (side.amplitude * (stop - start))[constant]
    np.fill_diagonal(product, own)
    return product, linear


class Products(NamedTuple):
    """The products phi_i(x) psi_j(y) that are kept: of every i the first counts[i], m^-1.

    heights: how many i each j has. starts: where those of each i begin, shape (i + 1,).
    conductance: K of each product, S, shape (product,). capacitance: c at rest, F/m².
    """

    x: Side
    y: Side
    counts: NDArray[np.int64]
    heights: NDArray[np.int64]
    starts: NDArray[np.int64]
    conductance: NDArray[np.float64]
    capacitance: float


def swept_readable(
    products: Products,
    boxes: NDArray[np.float64],
    rises: NDArray[np.float64],
    starts: NDArray[np.int64],
    s: NDArray[np.complex128],
    rtol: float,
) -> NDArray[np.complex128]:
    """What `swept` does, with matrices written out."""
    parts = [slice(*ends) for ends in zip(starts[:-1], starts[1:], strict=True)]
    pencils = [dense_pencil(products, boxes[part], rises[part]) for part in parts]
    return np.stack([respond(pencil, s, rtol)[0] for pencil in pencils])


def dense_pencil(
    products: Products, boxes: NDArray[np.float64], rises: NDArray[np.float64]
) -> Pencil:
    """K + s M of a press."""
    mass, start, area = touched_mass(products, boxes, rises)
    conductance = products.conductance
    capacitance = products.capacitance * area
    return Pencil(start, mass.dot, lambda y: y / conductance, 0.0, capacitance, 0.0)


def touched_mass(
    products: Products, boxes: NDArray[np.float64], rises: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """M in F, M of 1 V all over in C, and the area in m², counted by its c over that at rest."""
    x, y, c = products.x, products.y, products.capacitance
    i = np.repeat(np.arange(len(products.counts)), products.counts)
    j = np.concatenate([np.arange(count) for count in products.counts])
    mass, start = c * np.eye(len(i)), c * x.total[i] * y.total[j]
    area = x.length * y.length
    for (left, right, bottom, top), rise in zip(boxes.tolist(), rises.tolist(), strict=True):
        (along, in_x), (across, in_y) = interval(x, left, right), interval(y, bottom, top)
        mass += rise * c * along[np.ix_(i, i)] * across[np.ix_(j, j)]
        start += rise * c * in_x[i] * in_y[j]
        area += rise * (right - left) * (top - bottom)
    return mass, start, area
