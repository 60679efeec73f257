"""How far two impedances lie apart in Rs and Cp, and what that says of the error of one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .safety_factors import UNIFORM

ROUNDING = 1e-12
LOST_SUSCEPTANCE = 1e-9
ROUNDINGS = 1000
WINDOW = 2**0.5
KRYLOV_SHARE = 1e-2
"""Of the tolerance: what the real solves of a sweep may leave."""
Swept = tuple[NDArray[np.complex128], NDArray[np.float64]]
"""Forms Q in S of the excitations, shape (excitation, frequency), and what the solves leave of
relative error of the interfaces, shape (interface, frequency)."""


def relative_difference(
    Z: NDArray[np.complex128], truth: NDArray[np.complex128]
) -> NDArray[np.float64]:
    """|Rs / Rs_true - 1| and |Cp / Cp_true - 1|, shape (2, ...). Z, truth: ohm.

    The difference of Cp is told as a fraction of `reference_susceptance`.
    """
    Y, Y_true = 1 / Z, 1 / truth
    B = reference_susceptance(Y_true)
    return np.stack([np.abs(Z.real / truth.real - 1), np.abs((Y.imag - Y_true.imag) / B)])


def reference_susceptance(Y: NDArray[np.complex128]) -> NDArray[np.float64]:
    """What relative errors of Cp are fractions of, in S: |B|, but LOST_SUSCEPTANCE of |Y| at least.

    Less than that is rounding: between foils of one sheet Cp may be nothing at all. Y: S.
    """
    return np.maximum(np.abs(Y.imag), LOST_SUSCEPTANCE * np.abs(Y))


def certified(Y: NDArray[np.complex128], power: NDArray[np.float64]) -> NDArray[np.float64]:
    """Bound on the relative errors of Rs and Cp, shape (2, s); inf where it says nothing.

    |Y - Y_r| <= sqrt(2) power, with power = r*(K + omega M)^-1 r of the residual r; all in S, shape
    (s,).
    """
    size, error = np.abs(Y), np.sqrt(2) * power
    Z_error = np.divide(
        error, size * (size - error), out=np.full(size.shape, np.inf), where=size > error
    )
    return np.stack([Z_error / (1 / Y).real, error / reference_susceptance(Y)])


def lost_digits(Y: NDArray[np.complex128], at_once: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Relative rounding error of Rs and Cp at most, of Y = at_once - delayed, all in S.

    Far above cut-off both are much larger than Y: at once every cell charges, but what is far lags.
    ROUNDINGS: a few for each step of Lanczos' method; some hundred were seen. inf where nothing is
    left of one of them.
    """
    return rounded(Y, np.abs(at_once - Y))


def rounded(Y: NDArray[np.complex128], delayed: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same of Y whose delayed parts are so large in all, S."""
    rounding = ROUNDINGS * np.finfo(float).eps * delayed
    known = np.minimum(np.abs(Y.real), reference_susceptance(Y))
    return np.divide(rounding, known, out=np.full(known.shape, np.inf), where=known > 0)


def frequencies_around(frequency: NDArray[np.float64]) -> NDArray[np.float64]:
    """The frequencies, then all of them a factor WINDOW lower, then higher; Hz, shape (3 * f,)."""
    return np.concatenate([frequency, frequency / WINDOW, frequency * WINDOW])


def estimated_error(difference: NDArray[np.float64]) -> NDArray[np.float64]:
    """Relative error of the coarser of two results, at the first third of `frequencies_around`.

    difference: of the two, shape (..., 3 * f). Returns shape (..., f). Where error and difference
    change sign they vanish at frequencies that are not quite the same; the geometric mean with the
    largest difference nearby covers that. UNIFORM: what the finer one still lacks.
    """
    at_three = difference.reshape(*difference.shape[:-1], 3, -1)
    return UNIFORM * np.sqrt(at_three[..., 0, :] * at_three.max(axis=-2))


def both(off: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of errors of Rs and Cp, shape (2, ...): parts may cancel in one of them alone, which the
    geometric mean with the larger one covers."""
    return np.sqrt(off * off.max(axis=0))
