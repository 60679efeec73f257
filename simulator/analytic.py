"""The paper's analytic model of the strip, Eqs 1-6, and the finite open line it stands in for."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

HALF_POWER = 1 / np.sqrt(2)
PAPER_CONSTANT = 0.0382


def propagation_constant(frequency: ArrayLike, R: float, C: float) -> NDArray[np.complex128]:
    """gamma = alpha + j beta = sqrt(j omega R C), 1/m (paper Eq 3).

    frequency: Hz. R: ohm/m. C: F/m.
    """
    return np.sqrt(2j * np.pi * np.asarray(frequency, dtype=float) * R * C)


def attenuation(frequency: ArrayLike, x: float, R: float, C: float) -> NDArray[np.float64]:
    """Amplitude exp(-Re(gamma) x) of the wave on an infinite line (paper Eqs 4, 5).

    frequency: Hz. x: m from the interface. R: ohm/m. C: F/m. The paper prints the exponent as
    sqrt(pi R C) f; the root covers f as well.
    """
    return np.exp(-propagation_constant(frequency, R, C).real * x)


def interrogation_frequency(
    x: ArrayLike, R: float, C: float, constant: float = PAPER_CONSTANT
) -> NDArray[np.float64]:
    """f_i in Hz where the amplitude at x_i has fallen to half power (paper Eq 6).

    x: m. R: ohm/m. C: F/m. constant: (ln sqrt 2)² / pi = 0.03823, which the paper rounds to 0.0382.
    """
    return constant / (R * C * np.asarray(x, dtype=float) ** 2)


def open_line_amplitude(
    frequency: ArrayLike, x: float, length: float, R: float, C: float
) -> NDArray[np.float64]:
    """|V(x) / V(0)| = |cosh(gamma (l - x)) / cosh(gamma l)| on a line of length l, open at its end.

    frequency: Hz. x, length: m. R: ohm/m. C: F/m. Written with decaying exponentials only.
    """
    gamma = propagation_constant(frequency, R, C)
    reflected = np.exp(-2 * gamma * (length - x))
    return np.abs(np.exp(-gamma * x) * (1 + reflected) / (1 + np.exp(-2 * gamma * length)))
