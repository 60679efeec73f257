"""Whole sweeps of touches anywhere, fused: Lanczos' method on products of two sides' modes.

It is `lanczos.respond` in coordinates in which K is diagonal and M of the skin at rest is c times
1.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ...fem.lanczos import FEWEST_STEPS, MOST_STEPS, continued_fraction
from .charge import Workspace, charge_of, touched, workspace
from .modes import Products

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
    work = workspace(products, rectangles)
    for press in range(len(starts) - 1):
        its = slice(starts[press], starts[press + 1])
        capacitance = touched(products, boxes[its], rises[its], work)
        _respond(products, starts[press + 1] - starts[press], capacitance, work, s, rtol, Y[press])
    return Y


@njit(cache=True)
def _respond(
    products: Products,
    rectangles: int,
    capacitance: float,
    work: Workspace,
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
        charge_of(products, rectangles, work, solution, product)
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
