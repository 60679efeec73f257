"""Compiled kernels of the elements; each has a readable twin next to its callers.

`lazy_kernel` and other kernels import this module; it loads numba.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from .assembly import DROPPED
from .error_estimate import LOST_SUSCEPTANCE


@compiled()
def compressed(
    rows: NDArray, columns: NDArray, size: int
) -> tuple[NDArray, NDArray, NDArray]:  # pragma: no cover
    """Indices and column pointers of the distinct pairs, and the slot of each pair.

    Two stable counting sorts: by row, then by column.
    """
    by_row = _counted(rows, np.arange(len(rows)), columns, size)
    order = _counted(columns, by_row, rows, size)
    indices, indptr = np.empty(len(order), np.int32), np.zeros(size + 1, np.int32)
    slots = np.full(len(rows), DROPPED, np.int64)
    count = 0
    for k in range(len(order)):
        pair = order[k]
        new = k == 0
        if not new:
            before = order[k - 1]
            new = rows[pair] != rows[before] or columns[pair] != columns[before]
        if new:
            indices[count] = rows[pair]
            indptr[columns[pair] + 1] += 1
            count += 1
        slots[pair] = count - 1
    for column in range(size):
        indptr[column + 1] += indptr[column]
    return indices[:count].copy(), indptr, slots


@compiled()
def _counted(
    keys: NDArray, pairs: NDArray, others: NDArray, size: int
) -> NDArray:  # pragma: no cover
    """Pairs sorted by key, stable; pairs that are left out do not appear."""
    start = np.zeros(size + 1, np.int64)
    for pair in pairs:
        if keys[pair] >= 0 and others[pair] >= 0:
            start[keys[pair] + 1] += 1
    for key in range(size):
        start[key + 1] += start[key]
    order = np.empty(start[size], np.int64)
    for pair in pairs:
        if keys[pair] >= 0 and others[pair] >= 0:
            order[start[keys[pair]]] = pair
            start[keys[pair]] += 1
    return order


@compiled()
def block(
    indices: NDArray, indptr: NDArray, kept: NDArray, number: NDArray
) -> tuple[NDArray, NDArray, NDArray]:  # pragma: no cover
    """Indices, column pointers and positions in the whole of the block of kept rows and columns.

    number: of each row in the block, negative where it is not kept.
    """
    new_indices, entries = np.empty(len(indices), np.int32), np.empty(len(indices), np.int64)
    new_indptr = np.zeros(len(kept) + 1, np.int32)
    count = 0
    for column in range(len(kept)):
        for entry in range(indptr[kept[column]], indptr[kept[column] + 1]):
            row = number[indices[entry]]
            if row >= 0:
                new_indices[count] = row
                entries[count] = entry
                count += 1
        new_indptr[column + 1] = count
    return new_indices[:count].copy(), new_indptr, entries[:count].copy()


@compiled()
def continued_fraction(
    t: complex, diagonal: NDArray, squared: NDArray, steps: int
) -> complex:  # pragma: no cover
    """1 / (1 + t a_1 - t² b_1² / (1 + t a_2 - ...)) after that many steps.

    diagonal: a_1, a_2, ... squared: b_0², b_1², ...
    """
    value = 1.0 / (1.0 + t * diagonal[steps - 1])
    for step in range(steps - 2, -1, -1):
        value = 1.0 / (1.0 + t * diagonal[step] - t * t * squared[step + 1] * value)
    return value


@compiled(error_model="numpy")
def continued_fractions(
    t: NDArray, diagonal: NDArray, squared: NDArray, steps: int, value: NDArray
) -> None:  # pragma: no cover
    """`continued_fraction` of every t, equal up to rounding, written into `value`.

    t: real and imaginary parts of t, then of t², shape (4, n). value: both parts, shape (2, n).
    """
    re, im, square_re, square_im = t
    real, imag = value
    for k in range(t.shape[1]):
        real[k], imag[k] = 1.0 + re[k] * diagonal[steps - 1], im[k] * diagonal[steps - 1]
    for step in range(steps - 2, -1, -1):
        a, b = diagonal[step], squared[step + 1]
        for k in range(t.shape[1]):
            share = b / (real[k] * real[k] + imag[k] * imag[k])
            x, y = real[k] * share, -imag[k] * share
            real[k] = 1.0 + re[k] * a - (square_re[k] * x - square_im[k] * y)
            imag[k] = im[k] * a - (square_re[k] * y + square_im[k] * x)
    for k in range(t.shape[1]):
        share = 1.0 / (real[k] * real[k] + imag[k] * imag[k])
        real[k], imag[k] = real[k] * share, -imag[k] * share


Convergent = tuple[complex, complex, complex, complex]


@compiled()
def next_convergent(
    convergent: Convergent, t: complex, a: float, b_squared: float, step: int
) -> Convergent:  # pragma: no cover
    """Numerator and denominator of `continued_fraction` after one more step, and those before.

    They are scaled so that the denominator is of modulus 1. step: number of steps so far, from the
    convergent (0, 1, 0, 0) on; a and b_squared: coefficients of the new step.
    """
    P, Q, P_before, Q_before = convergent
    if step == 0:
        P, Q, P_before, Q_before = 1.0 + 0.0j, 1.0 + t * a, P, Q
    else:
        P, P_before = (1.0 + t * a) * P - t * t * b_squared * P_before, P
        Q, Q_before = (1.0 + t * a) * Q - t * t * b_squared * Q_before, Q
    scale = 1.0 / np.sqrt(Q.real * Q.real + Q.imag * Q.imag)
    return P * scale, Q * scale, P_before * scale, Q_before * scale


@compiled()
def last_change(
    s: NDArray, shift: float, at_once: NDArray, diagonal: NDArray, squared: NDArray, steps: int
) -> tuple[NDArray, NDArray]:  # pragma: no cover
    """Y(s) in S after that many steps, and the relative change of Rs or Cp by the last one.

    at_once: Y(sigma) + t g'Mg in S. A susceptance below LOST_SUSCEPTANCE of |Y| counts as that.
    """
    Y, change = np.empty_like(s), np.empty(len(s))
    for k in range(len(s)):
        t = s[k] - shift
        scale = t * t * squared[0]
        before, now = at_once[k], at_once[k]
        now -= scale * continued_fraction(t, diagonal, squared, steps)
        if steps > 1:
            before -= scale * continued_fraction(t, diagonal, squared, steps - 1)
        B = max(abs(now.imag), LOST_SUSCEPTANCE * abs(now))
        Rs = abs((1.0 / before).real / (1.0 / now).real - 1.0)
        Y[k], change[k] = now, max(Rs, abs(before.imag - now.imag) / B)
    return Y, change


@compiled()
def fill(
    values: NDArray, slots: NDArray, weights: NDArray, reference: NDArray
) -> None:  # pragma: no cover
    """values[slots[e, k]] += sum_m weights[e, m] reference[m, k], without dropped slots."""
    total = np.empty(slots.shape[1])
    for element in range(slots.shape[0]):
        total[:] = 0.0
        for m in range(weights.shape[1]):
            weight = weights[element, m]
            for k in range(slots.shape[1]):
                total[k] += weight * reference[m, k]
        for k in range(slots.shape[1]):
            if slots[element, k] != DROPPED:
                values[slots[element, k]] += total[k]


Columns = tuple[NDArray, NDArray, NDArray]
"""indptr, indices and data of a sparse matrix by columns, rows ascending in each."""


@compiled(fastmath={"contract"})
def substitute(lower: Columns, upper: Columns, x: NDArray) -> None:  # pragma: no cover
    """Replace x by U^-1 L^-1 x. lower: L, of unit diagonal. x: shape (unknown, right side)."""
    unknowns, count = x.shape
    starts, rows, values = lower
    for column in range(unknowns):
        for place in range(starts[column] + 1, starts[column + 1]):
            row, value = rows[place], values[place]
            for k in range(count):
                x[row, k] -= value * x[column, k]
    starts, rows, values = upper
    for column in range(unknowns - 1, -1, -1):
        last = starts[column + 1] - 1
        share = 1.0 / values[last]
        for k in range(count):
            x[column, k] *= share
        for place in range(starts[column], last):
            row, value = rows[place], values[place]
            for k in range(count):
                x[row, k] -= value * x[column, k]
