"""Differences of two impedances in Rs and Cp, and the error estimates that follow from them."""

from __future__ import annotations

import numpy as np

from ..arrays import Complex, Real
from .safety_factors import UNIFORM

ROUNDING = 1e-12
LOST_SUSCEPTANCE = 1e-9
ROUNDINGS = 1000
WINDOW = 2**0.5
KRYLOV_SHARE = 1e-2
"""Share of the tolerance that the real solves of a sweep may use."""
Swept = tuple[Complex, Real]
"""Forms Q in S of the excitations, shape (excitation, frequency), and the relative errors of the
interfaces that the solves leave, shape (interface, frequency)."""


def relative_difference(Z: Complex, truth: Complex) -> Real:
    """|Rs / Rs_true - 1| and |Cp / Cp_true - 1|, shape (2, ...). Z, truth: ohm.

    The difference of Cp is a fraction of `reference_susceptance`.
    """
    Y, Y_true = 1 / Z, 1 / truth
    B = reference_susceptance(Y_true)
    return np.stack([np.abs(Z.real / truth.real - 1), np.abs((Y.imag - Y_true.imag) / B)])


def reference_susceptance(Y: Complex) -> Real:
    """Reference of relative errors of Cp, in S: |B|, but at least LOST_SUSCEPTANCE of |Y|.

    Less than that is rounding: between foils of one sheet Cp may be zero. Y: S.
    """
    return np.maximum(np.abs(Y.imag), LOST_SUSCEPTANCE * np.abs(Y))


def certified(Y: Complex, power: Real) -> Real:
    """Bound on the relative errors of Rs and Cp, shape (2, s); inf where it bounds nothing.

    |Y - Y_r| <= sqrt(2) power, with power = r*(K + omega M)^-1 r of the residual r; all in S, shape
    (s,).
    """
    size, error = np.abs(Y), np.sqrt(2) * power
    Z_error = np.divide(
        error, size * (size - error), out=np.full(size.shape, np.inf), where=size > error
    )
    return np.stack([Z_error / (1 / Y).real, error / reference_susceptance(Y)])


def lost_digits(Y: Complex, at_once: Complex) -> Real:
    """Upper estimate of the relative rounding error of Rs and Cp for Y = at_once - delayed, all in
    S.

    Far above cut-off both terms are much larger than Y: every cell charges at once, but distant
    cells lag. ROUNDINGS: a few for each step of Lanczos' method; some hundred were observed. inf
    where no digits of Rs or Cp are left.
    """
    return rounded(Y, np.abs(at_once - Y))


def rounded(Y: Complex, delayed: Real) -> Real:
    """Rounding error as in `lost_digits`, given the total size of the delayed parts in S."""
    rounding = ROUNDINGS * np.finfo(float).eps * delayed
    known = np.minimum(np.abs(Y.real), reference_susceptance(Y))
    return np.divide(rounding, known, out=np.full(known.shape, np.inf), where=known > 0)


def frequencies_around(frequency: Real) -> Real:
    """The frequencies, then all of them divided by WINDOW, then multiplied by it; Hz, shape (3 *
    f,)."""
    return np.concatenate([frequency, frequency / WINDOW, frequency * WINDOW])


def estimated_error(difference: Real) -> Real:
    """Relative error of the coarser of two results, at the first third of `frequencies_around`.

    difference: between the two, shape (..., 3 * f). Returns shape (..., f). Where error and
    difference change sign they vanish at slightly different frequencies; the geometric mean with
    the largest difference nearby covers that. UNIFORM covers the error of the finer result.
    """
    at_three = difference.reshape(*difference.shape[:-1], 3, -1)
    return UNIFORM * np.sqrt(at_three[..., 0, :] * at_three.max(axis=-2))


def both(off: Real) -> Real:
    """Errors of Rs and Cp, shape (2, ...), each at least its geometric mean with the larger one.

    Parts of the error may cancel in one of them alone.
    """
    return np.sqrt(off * off.max(axis=0))
