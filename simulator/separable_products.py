"""Products of both sides' modes, and the skin's matrices in them, written out."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simulator.lanczos import Pencil, respond
from simulator.separable_modes import Side, interval


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
