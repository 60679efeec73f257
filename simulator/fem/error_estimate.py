"""Differences of two impedances in Rs and Cp, and the error estimates that follow from them.

The error of an element solution is estimated as SAFETY * k * D. D is the difference from elements
of one order more, in Rs and in Cp (`discretised.smoothed`), and k is the ratio of the error to D.
k is 1 where the field is smooth; `ErrorHistory` estimates it where it is singular. The safety
factors stand here with their evidence.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Complex, Real

UNIFORM = 4.0
"""SAFETY of uniform skins, where k = 1. On 226 random skins the largest true error was 3.8 D, and
the median was D."""
VARIED = 2.0
"""SAFETY of heterogeneous skins. On 230 meshes of 50 random skins 99 % of the errors were at most
1.2 k D, and the median was k D."""
SINGULAR = 2.0
"""k of a mesh that serves all presses of a uniform skin; it multiplies UNIFORM. It covers the worst
singularities: a foil that ends at an inner corner, and a sheet that conducts far better along one
direction. A single press cannot estimate it."""
FIRST_MESH = 3.0
"""k of a first mesh, which cannot estimate it. The largest observed k was 3.7, and 2.5 at ends of
foils."""
MIN_FACTOR, MAX_FACTOR = 1.3, 4.0
"""Bounds of an estimated k. A smaller estimate may come from refining smooth regions alone. A
larger one is noise of a mesh that is far too coarse. The upper bound is raised at corners where
conductance jumps by a large factor: k is larger there."""
PREDICTED = 1.5
"""Factor on the k that the corners of a mesh predict. On about 60 meshes of 20 skins k was at most
1.6 times the prediction, except at one place where Cp changes sign: 2.2 times."""
MIN_DECREASE = 0.1
"""Relative decrease of the difference from mesh to mesh that is needed to estimate k."""
PARITY = 0.8
"""Largest share of the previous difference that is taken as the error. This covers cells far wider
than a boundary layer: every second order hardly changes the answer there, so the latest two orders
may agree by chance."""
MAX_FACTOR_BY_ORDERS = 5.0
"""Upper bound of k where lower orders give it."""
MAX_ORDER_GAIN = 10.0
"""Largest accepted gain of one order over the previous one. In a cell far wider than a boundary
layer every second order hardly changes the answer: the difference from the next order alone was a
ninth of the error there."""
DEFLECTION = 5.0
"""Error of the factor under a press over the contribution of the highest order alone. It was 4.7 at
the tip of a narrow polygon, and less at right angles and where the deflection is smooth."""
SAMPLED = 4.0
"""Largest error of all presses by depth over the largest error in a sample of them. Deep presses in
a corner next to foils had 2.9 times the largest error of the sample."""


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
