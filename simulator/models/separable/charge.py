"""M of rectangles on products of two sides' modes, applied without being written out.

A rectangle adds a Kronecker product of two small matrices to M: two products of matrices, which are
done for all rectangles of a press at once.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ...fem.lanczos import MOST_STEPS
from .modes import Products, Side

LANES = 4
"""Numbers of a vector register: rows of matrices are filled up with zeros to a multiple of it."""


class Workspace(NamedTuple):
    """Arrays for one press after the other.

    along, across: of all rectangles beside each other, shape (mode, rectangle * filled), where
    filled is the number of modes, to a multiple of LANES. ends: shape (4, mode). linear: shape (2,
    mode). half: shape (mode along y, rectangle * filled), turned: shape (mode along x, rectangle *
    filled). vectors: Lanczos' residual first, shape (4, product). coefficients: its two, shape (2,
    MOST_STEPS).
    """

    along: NDArray[np.float64]
    across: NDArray[np.float64]
    ends: NDArray[np.float64]
    linear: NDArray[np.float64]
    half: NDArray[np.float64]
    turned: NDArray[np.float64]
    vectors: NDArray[np.float64]
    coefficients: NDArray[np.float64]


@njit(cache=True)
def workspace(products: Products, rectangles: int) -> Workspace:  # pragma: no cover
    columns, rows = len(products.counts), len(products.heights)
    most, wide, high = max(columns, rows), _filled(columns), _filled(rows)
    return Workspace(
        np.zeros((columns, rectangles * wide)),
        np.zeros((rows, rectangles * high)),
        np.empty((4, most)),
        np.empty((2, most)),
        np.zeros((rows, rectangles * wide)),
        np.zeros((columns, rectangles * high)),
        np.empty((4, len(products.conductance))),
        np.empty((2, MOST_STEPS)),
    )


@njit(cache=True)
def _filled(count: int) -> int:  # pragma: no cover
    return LANES * ((count + LANES - 1) // LANES)


@njit(cache=True)
def touched(
    products: Products, boxes: NDArray, rises: NDArray, work: Workspace
) -> float:  # pragma: no cover
    """What rectangles add to M, the first residual, and the whole capacitance in F."""
    x, y, c = products.x, products.y, products.capacitance
    linear, start = work.linear, work.vectors[0]
    wide, high = _filled(len(products.counts)), _filled(len(products.heights))
    _outer(products, x.total, y.total, c, start, True)
    area = x.length * y.length
    for k in range(len(boxes)):
        left, right, bottom, top = boxes[k, 0], boxes[k, 1], boxes[k, 2], boxes[k, 3]
        _interval(x, left, right, work.ends, work.along, k * wide, linear[0], rises[k] * c)
        _interval(y, bottom, top, work.ends, work.across, k * high, linear[1], 1.0)
        _outer(products, linear[0], linear[1], rises[k] * c, start, False)
        area += rises[k] * (right - left) * (top - bottom)
    return area * c


@njit(cache=True, fastmath={"reassoc", "contract"})
def _interval(
    side: Side,
    start: float,
    stop: float,
    ends: NDArray,
    product: NDArray,
    first: int,
    linear: NDArray,
    scale: float,
) -> None:  # pragma: no cover
    """`scale` times the matrix of `interval`, from column `first` on, and its integrals."""
    count, length = len(product), stop - start
    for i in range(count):
        k, A = side.wavenumber[i], side.amplitude[i]
        at_start, at_stop = k * start - side.phase[i], k * stop - side.phase[i]
        ends[0, i], ends[1, i] = A * np.cos(at_start), -A * k * np.sin(at_start)
        ends[2, i], ends[3, i] = A * np.cos(at_stop), -A * k * np.sin(at_stop)
    for i in range(count):
        v, d, w, e = scale * ends[0, i], scale * ends[1, i], scale * ends[2, i], scale * ends[3, i]
        for j in range(count):
            turned = w * ends[3, j] - e * ends[2, j] - v * ends[1, j] + d * ends[0, j]
            product[i, first + j] = turned * side.inverse[i, j]
        k, A = side.wavenumber[i], side.amplitude[i]
        if k > 0.0:
            swing = ends[2, i] * ends[3, i] - ends[0, i] * ends[1, i]
            product[i, first + i] = scale * (A * A * length / 2.0 - swing / (2.0 * k * k))
            linear[i] = (ends[1, i] - ends[3, i]) / (k * k)
        else:
            product[i, first + i] = scale * A * A * length
            linear[i] = A * length


@njit(cache=True)
def _outer(
    products: Products, u: NDArray, v: NDArray, scale: float, out: NDArray, afresh: bool
) -> None:  # pragma: no cover
    """out (+)= scale u_i v_j."""
    for i in range(len(products.counts)):
        first, part = products.starts[i], scale * u[i]
        for j in range(products.counts[i]):
            out[first + j] = part * v[j] + (0.0 if afresh else out[first + j])


@njit(cache=True, fastmath={"reassoc", "contract"})
def charge_of(
    products: Products, rectangles: int, work: Workspace, v: NDArray, charge: NDArray
) -> None:  # pragma: no cover
    """charge = M v in C: at rest, and along (x) across of each rectangle."""
    for k in range(len(v)):
        charge[k] = products.capacitance * v[k]
    if rectangles > 0:
        _along(products, rectangles, work, v)
        _turn(products, rectangles, work)
        _across(products, rectangles, work, charge)


@njit(cache=True, fastmath={"reassoc", "contract"})
def _along(
    products: Products, rectangles: int, work: Workspace, v: NDArray
) -> None:  # pragma: no cover
    """half[j] = sum over m of v[m, j] along[m], of all rectangles at once."""
    starts, heights, parts = products.starts, products.heights, work.along
    width = rectangles * _filled(len(products.counts))
    for j in range(len(heights)):
        into, height = work.half[j], heights[j]
        for i in range(width):
            into[i] = 0.0
        for m in range(0, height - 3, 4):
            a, b = v[starts[m] + j], v[starts[m + 1] + j]
            c, d = v[starts[m + 2] + j], v[starts[m + 3] + j]
            for i in range(width):
                into[i] += (
                    a * parts[m, i]
                    + b * parts[m + 1, i]
                    + c * parts[m + 2, i]
                    + d * parts[m + 3, i]
                )
        for m in range(height - height % 4, height):
            a = v[starts[m] + j]
            for i in range(width):
                into[i] += a * parts[m, i]


@njit(cache=True)
def _turn(products: Products, rectangles: int, work: Workspace) -> None:  # pragma: no cover
    """turned[i, j] = half[j, i] of each rectangle."""
    columns, rows = len(products.counts), len(products.heights)
    wide, high = _filled(columns), _filled(rows)
    for touch in range(rectangles):
        for i in range(columns):
            for j in range(rows):
                work.turned[i, touch * high + j] = work.half[j, touch * wide + i]


@njit(cache=True, fastmath={"reassoc", "contract"})
def _across(
    products: Products, rectangles: int, work: Workspace, charge: NDArray
) -> None:  # pragma: no cover
    """charge[i, j] += turned[i] across[j], summed over the modes of all rectangles."""
    starts, parts = products.starts, work.across
    width = rectangles * _filled(len(products.heights))
    for i in range(len(products.counts)):
        row, count = work.turned[i], starts[i + 1] - starts[i]
        for j in range(0, count - 3, 4):
            a, b, c, d = 0.0, 0.0, 0.0, 0.0
            for m in range(width):
                a += row[m] * parts[j, m]
                b += row[m] * parts[j + 1, m]
                c += row[m] * parts[j + 2, m]
                d += row[m] * parts[j + 3, m]
            k = starts[i] + j
            charge[k] += a
            charge[k + 1] += b
            charge[k + 2] += c
            charge[k + 3] += d
        for j in range(count - count % 4, count):
            a = 0.0
            for m in range(width):
                a += row[m] * parts[j, m]
            charge[starts[i] + j] += a
