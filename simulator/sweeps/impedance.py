"""Impedance and its names: Z = Rs + jX is the object; Cp, Cs and the phase are views of it."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InputError

NOISE = 0.05
"""What noise of Rs and of Cp may add to 2 omega Cp Rs, which is 1 at -45 degrees."""


def parallel_capacitance(Z: ArrayLike, frequency: ArrayLike) -> NDArray[np.float64]:
    """Cp = Im(1/Z) / omega, in F.

    Z: ohm, shape (..., frequency). frequency: Hz, shape (frequency,).
    """
    Z, omega = np.asarray(Z, dtype=np.complex128), 2 * np.pi * np.asarray(frequency)
    magnitude = np.abs(Z)
    return -(Z.imag / magnitude) / magnitude / omega


def series_capacitance(Z: ArrayLike, frequency: ArrayLike) -> NDArray[np.float64]:
    """Cs = -1 / (omega X), in F.

    Z: ohm, shape (..., frequency). frequency: Hz, shape (frequency,).
    """
    X = np.asarray(Z, dtype=np.complex128).imag
    return -1 / (2 * np.pi * np.asarray(frequency) * X)


def branch_reactance(Rs: ArrayLike, Cp: ArrayLike, frequency: ArrayLike) -> NDArray[np.float64]:
    """X from (Rs, Cp) alone, on the branch whose phase lies between -90 and -45 degrees.

    Cp = -X / (omega (Rs² + X²)) has two roots with X1 X2 = Rs². The one with |X| >= Rs is given;
    lines and sheets pass -45 degrees, and `branch.chosen` follows them to the other.

    Rs: ohm, Cp: F, shapes (..., frequency). frequency: Hz. Returns X in ohm.
    Raises InputError where Cp <= 0, or no reactance gives the pair: 2 omega Cp Rs > 1, beyond what
    noise may do at -45 degrees.
    """
    Rs = np.asarray(Rs, dtype=float)
    susceptance = 2 * np.pi * np.asarray(frequency) * np.asarray(Cp, dtype=float)
    product = 2 * susceptance * Rs
    if np.any(susceptance <= 0) or np.any(product > 1 + NOISE):
        raise InputError(
            "no capacitive reactance has these Rs and Cp: need Cp > 0, 2 omega Cp Rs <= 1"
        )
    return -(1 + np.sqrt(np.maximum(1 - product**2, 0))) / (2 * susceptance)
