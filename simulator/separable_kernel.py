"""Whole sweeps of touches anywhere, fused: Lanczos' method on products of two sides' modes.

It is `lanczos.respond` in coordinates in which K is diagonal and M of the skin at rest is c times
1. A rectangle adds a Kronecker product of two small matrices, applied as two products of matrices.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from simulator.lanczos import FEWEST_STEPS, MOST_STEPS, continued_fraction
from simulator.separable_modes import Side
from simulator.separable_products import Products

SLOWING = 4.0


@njit(cache=True)
def swept(
    products: Products,
    boxes: NDArray,
    rises: NDArray,
    starts: NDArray,
    s: NDArray,
    rtol: float,
) -> NDArray:  # pragma: no cover
    """Y in S of many presses, shape (press, s).

    Press k is boxes[starts[k]:starts[k + 1]] (left, right, bottom, top in m), each adding `rises`
    times c at rest. s: rad/s. rtol: of Rs and Cp, for Lanczos' method to end at.
    """
    Y = np.empty((len(starts) - 1, len(s)), np.complex128)
    rectangles = 0
    for press in range(len(starts) - 1):
        rectangles = max(rectangles, starts[press + 1] - starts[press])
    work = _workspace(products, rectangles)
    for press in range(len(starts) - 1):
        touched = slice(starts[press], starts[press + 1])
        capacitance = _touched(products, boxes[touched], rises[touched], work)
        _respond(products, starts[press + 1] - starts[press], capacitance, work, s, rtol, Y[press])
    return Y


class _Workspace(NamedTuple):
    """Arrays for one press after the other.

    along, across: of each rectangle, shape (rectangle, mode, mode). ends: shape (4, mode). linear:
    shape (2, mode). halves: shape (2, mode, mode). vectors: Lanczos' residual first, shape (4,
    product). coefficients: its two, shape (2, MOST_STEPS).
    """

    along: NDArray[np.float64]
    across: NDArray[np.float64]
    ends: NDArray[np.float64]
    linear: NDArray[np.float64]
    halves: NDArray[np.float64]
    vectors: NDArray[np.float64]
    coefficients: NDArray[np.float64]


@njit(cache=True)
def _workspace(products: Products, rectangles: int) -> _Workspace:  # pragma: no cover
    columns, rows = len(products.counts), len(products.heights)
    most = max(columns, rows)
    return _Workspace(
        np.empty((rectangles, columns, columns)),
        np.empty((rectangles, rows, rows)),
        np.empty((4, most)),
        np.empty((2, most)),
        np.empty((2, most, most)),
        np.empty((4, len(products.conductance))),
        np.empty((2, MOST_STEPS)),
    )


@njit(cache=True)
def _touched(
    products: Products, boxes: NDArray, rises: NDArray, work: _Workspace
) -> float:  # pragma: no cover
    """What rectangles add to M, the first residual, and the whole capacitance in F."""
    x, y, c = products.x, products.y, products.capacitance
    linear, start = work.linear, work.vectors[0]
    _outer(products, x.total, y.total, c, start, True)
    area = x.length * y.length
    for k in range(len(boxes)):
        left, right, bottom, top = boxes[k, 0], boxes[k, 1], boxes[k, 2], boxes[k, 3]
        _interval(x, left, right, work.ends, work.along[k], linear[0], rises[k] * c)
        _interval(y, bottom, top, work.ends, work.across[k], linear[1], 1.0)
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
    linear: NDArray,
    scale: float,
) -> None:  # pragma: no cover
    """`scale` times the matrix of `interval`, and its integrals."""
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
            product[i, j] = turned * side.inverse[i, j]
        k, A = side.wavenumber[i], side.amplitude[i]
        if k > 0.0:
            swing = ends[2, i] * ends[3, i] - ends[0, i] * ends[1, i]
            product[i, i] = scale * (A * A * length / 2.0 - swing / (2.0 * k * k))
            linear[i] = (ends[1, i] - ends[3, i]) / (k * k)
        else:
            product[i, i] = scale * A * A * length
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


@njit(cache=True)
def _respond(
    products: Products,
    rectangles: int,
    capacitance: float,
    work: _Workspace,
    s: NDArray,
    rtol: float,
    Y: NDArray,
) -> None:  # pragma: no cover
    """Lanczos' steps until the next one changes neither Rs nor Cp at the largest |s| by rtol.

    Changes fall faster and faster: over the last one by more than that did over the one before, but
    for a factor SLOWING at most.
    """
    residual, solution, product, w = work.vectors
    diagonal, squared = work.coefficients
    w[:] = 0.0
    farthest = s[np.argmax(np.abs(s))]
    now, change_before, steps = farthest * capacitance, np.inf, 0
    while steps < MOST_STEPS:
        square = _weighed(residual, products.conductance, solution)
        if not square > 0.0:
            break
        beside = np.sqrt(square)
        _scale(1.0 / beside, solution)
        _charge(products, rectangles, work, solution, product)
        squared[steps], diagonal[steps] = square, _dot(solution, product)
        _next(residual, product, w, diagonal[steps], beside)
        steps += 1
        before, now = now, _admittance(capacitance, farthest, diagonal, squared, steps)
        change = _difference(before, now)
        to_come = change * min(change_before, SLOWING * change)
        if steps >= FEWEST_STEPS and to_come <= rtol * change_before:
            break
        change_before = change
    for k in range(len(s)):
        Y[k] = _admittance(capacitance, s[k], diagonal, squared, steps)


@njit(cache=True, fastmath={"reassoc", "contract"})
def _charge(
    products: Products, rectangles: int, work: _Workspace, v: NDArray, charge: NDArray
) -> None:  # pragma: no cover
    """charge = M v in C: at rest, and along (x) across of each rectangle."""
    half, turned = work.halves
    starts, heights = products.starts, products.heights
    columns, rows = len(starts) - 1, starts[1]
    for k in range(len(v)):
        charge[k] = products.capacitance * v[k]
    for touch in range(rectangles):
        parts, across = work.along[touch], work.across[touch]
        for j in range(rows):
            into, height = half[j], heights[j]
            for i in range(columns):
                into[i] = 0.0
            for m in range(0, height - 3, 4):
                a, b = v[starts[m] + j], v[starts[m + 1] + j]
                c, d = v[starts[m + 2] + j], v[starts[m + 3] + j]
                for i in range(columns):
                    into[i] += (
                        a * parts[m, i]
                        + b * parts[m + 1, i]
                        + c * parts[m + 2, i]
                        + d * parts[m + 3, i]
                    )
            for m in range(height - height % 4, height):
                a = v[starts[m] + j]
                for i in range(columns):
                    into[i] += a * parts[m, i]
        for j in range(rows):
            for i in range(columns):
                turned[i, j] = half[j, i]
        for i in range(columns):
            row, count = turned[i], starts[i + 1] - starts[i]
            for j in range(0, count - 3, 4):
                a, b, c, d = 0.0, 0.0, 0.0, 0.0
                for m in range(rows):
                    a += row[m] * across[j, m]
                    b += row[m] * across[j + 1, m]
                    c += row[m] * across[j + 2, m]
                    d += row[m] * across[j + 3, m]
                k = starts[i] + j
                charge[k] += a
                charge[k + 1] += b
                charge[k + 2] += c
                charge[k + 3] += d
            for j in range(count - count % 4, count):
                a = 0.0
                for m in range(rows):
                    a += row[m] * across[j, m]
                charge[starts[i] + j] += a


@njit(cache=True, fastmath={"reassoc", "contract"})
def _weighed(
    residual: NDArray, conductance: NDArray, solution: NDArray
) -> float:  # pragma: no cover
    """solution = K^-1 residual, and their product."""
    total = 0.0
    for k in range(len(residual)):
        solution[k] = residual[k] / conductance[k]
        total += residual[k] * solution[k]
    return total


@njit(cache=True)
def _scale(by: float, v: NDArray) -> None:  # pragma: no cover
    for k in range(len(v)):
        v[k] *= by


@njit(cache=True, fastmath={"reassoc", "contract"})
def _dot(u: NDArray, v: NDArray) -> float:  # pragma: no cover
    total = 0.0
    for k in range(len(u)):
        total += u[k] * v[k]
    return total


@njit(cache=True, fastmath={"contract"})
def _next(
    residual: NDArray, product: NDArray, w: NDArray, diagonal: float, beside: float
) -> None:  # pragma: no cover
    """The next residual of the three-term recurrence; w: this one's direction."""
    inverse = 1.0 / beside
    for k in range(len(residual)):
        before, w[k] = w[k], residual[k] * inverse
        residual[k] = product[k] - diagonal * w[k] - beside * before


@njit(cache=True)
def _admittance(
    capacitance: float, s: complex, diagonal: NDArray, squared: NDArray, steps: int
) -> complex:  # pragma: no cover
    """Y = s g'Mg - s² b_0² e1'(1 + s T)^-1 e1 in S."""
    if steps == 0:
        return s * capacitance
    delayed = s * s * squared[0] * continued_fraction(s, diagonal, squared, steps)
    return s * capacitance - delayed


@njit(cache=True)
def _difference(before: complex, now: complex) -> float:  # pragma: no cover
    """The larger relative change of Rs and Cp."""
    Rs = abs((1.0 / before).real / (1.0 / now).real - 1.0)
    return max(Rs, abs(before.imag / now.imag - 1.0))
