"""One rule for whether two frequencies are the same."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Mask, Real

SAME_FREQUENCY = 1e-6
"""Relative difference below which two frequencies are always the same."""
DIGITS = (4, 5, 6)
"""Numbers of digits at which a file was rounded; with fewer, frequencies are round numbers."""


def tolerance(frequency: ArrayLike) -> Real:
    """Relative difference at which another frequency may be the same as each of these.

    It is SAME_FREQUENCY, or half of the last digit if they are written with 4 to 6 digits.
    """
    f = np.asarray(frequency, dtype=np.float64)
    for digits in range(1, DIGITS[-1] + 1):
        rounded = np.array([float(f"{each:.{digits - 1}e}") for each in f.ravel()])
        if np.allclose(f.ravel(), rounded, rtol=1e-9, atol=0):
            if digits not in DIGITS:
                break
            last = 10.0 ** (np.floor(np.log10(rounded)) - digits + 1)
            return np.maximum(SAME_FREQUENCY, 0.501 * last / rounded).reshape(f.shape)
    return np.full(f.shape, SAME_FREQUENCY)


def same_frequencies(one: ArrayLike, other: ArrayLike) -> Mask:
    """True where two arrays of frequencies in Hz, of one shape, have the same one."""
    f, g = np.asarray(one, dtype=np.float64), np.asarray(other, dtype=np.float64)
    return np.abs(f - g) <= np.maximum(tolerance(f), tolerance(g)) * np.minimum(f, g)
