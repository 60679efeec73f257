"""Impedances known in closed form, written apart from the solver, and errors against them.

All for a line or a rectangle of total sheet resistances R1, R2 [ohm] and total capacitance C [F].
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.scene.scene import Scene
from scipy.special import bernoulli, factorial

TERMS = 25
FOSTER_TERMS = 100_000


def totals(scene: Scene) -> tuple[float, float, float]:
    """R1 and R2 along x, and C, of a scene at rest."""
    skin = scene.skin
    squares = skin.length / skin.width
    R1, R2 = (sheet.sheet_resistance * squares for sheet in (skin.top, skin.bottom))
    return R1, R2, skin.foam.unpressed_capacitance_per_area * skin.length * skin.width


def worst(Z: NDArray, truth: NDArray) -> tuple[float, float]:
    """Largest relative errors of Rs and Cp."""
    Rs, Cp = relative_difference(Z, truth)
    return float(Rs.max()), float(Cp.max())


def variable(scene: Scene) -> NDArray:
    """s = j omega at the scene's frequencies, rad/s."""
    return 2j * np.pi * scene.frequencies


def uniform(R: float | NDArray, C: float, s: NDArray) -> NDArray:
    """R coth(q)/q, q² = s R C; for |q| < 1 by its series, which keeps the small real part."""
    z = s * R * C
    k = np.arange(TERMS + 1)
    coefficients = bernoulli(2 * TERMS)[::2] * 4.0**k / factorial(2 * k)
    small = abs(z) < 1
    series = np.polyval(coefficients[::-1], np.where(small, z, 0)) / z
    q = np.sqrt(z)
    return R * np.where(small, series, 1 / (q * np.tanh(q)))


def foster(R: float, C: float, s: NDArray) -> NDArray:
    """1/(sC) + sum (2/C)/(s + m² pi²/(RC)); the terms left out as an integral over m."""
    q = np.sqrt(s * R * C)
    poles = (np.pi * np.arange(1, FOSTER_TERMS + 1)) ** 2
    head = np.array([(2 / (each + poles)).sum() for each in s * R * C])
    tail = 2 / (np.pi * q) * np.arctan(q / (np.pi * (FOSTER_TERMS + 0.5)))
    return R * (1 / (s * R * C) + head + tail)


def piecewise(R: float, capacitances: Sequence[float], s: NDArray) -> NDArray:
    """M11/M21 of the chain of [[cosh q, Zc sinh q], [sinh q / Zc, cosh q]], each over e^q / 2.

    R: of each segment. capacitances: of each, from the fed end on.
    """
    ahead, across = np.ones((2, len(s)), dtype=complex)
    across *= 0
    for C in reversed(capacitances):
        q, Zc = np.sqrt(s * R * C), np.sqrt(R / (s * C))
        cosh, sinh = 1 + np.exp(-2 * q), -np.expm1(-2 * q)
        ahead, across = cosh * ahead + Zc * sinh * across, sinh / Zc * ahead + cosh * across
        size = abs(ahead)
        ahead, across = ahead / size, across / size
    return ahead / across


def opposite_ends(R1: float, R2: float, C: float, s: NDArray) -> NDArray:
    """R1 R2/R (1 + 2/(q sinh q)) + (R1² + R2²)/R coth(q)/q, R = R1 + R2, q² = s R C."""
    R = R1 + R2
    q = np.sqrt(s * C * R)
    decaying = 2 * np.exp(-q) / -np.expm1(-2 * q)
    return R1 * R2 / R * (1 + 2 * decaying / q) + (R1**2 + R2**2) / R / (q * np.tanh(q))


def at_low_frequency(R1: float, R2: float, C: float, s: NDArray) -> NDArray:
    """(R1 + R2)/3 + 1/(sC): exact but for terms of the second order in omega R C."""
    return (R1 + R2) / 3 + 1 / (s * C)


def Rs_at_zero(R: float, capacitances: Sequence[float]) -> float:
    """Integral of r (Q(x)/Q(0))² dx for segments of resistance R each, from the fed end on."""
    Q = np.append(np.cumsum(capacitances[::-1])[::-1], 0.0)
    return float(np.sum(R / 3 * (Q[:-1] ** 2 + Q[:-1] * Q[1:] + Q[1:] ** 2)) / Q[0] ** 2)


def response_of_pixel(R: float, C: float, pixel: int, count: int, s: NDArray) -> NDArray:
    """dY / (dC/C) of one of `count` pixels of a uniform line: s C times the mean of (v/V0)² there.

    v/V0 = cosh(q (1 - x)) / cosh(q), whose square integrates to (1 + sinh(2 q y)/(2 q y)) y/2.
    """
    q = np.sqrt(s * R * C)

    def integral(y: float) -> NDArray:
        return (y / 2 + np.sinh(2 * q * y) / (4 * q)) / np.cosh(q) ** 2

    near, far = 1 - (pixel - 1) / count, 1 - pixel / count
    return s * C * (integral(near) - integral(far))
