"""Impedance Z = Rs + jX and the quantities derived from it: Cp, Cs, and X from Rs and Cp."""

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Mask, Real
from .errors import InputError

NOISE = 0.05
"""Largest contribution of noise to 2 omega Cp Rs, which is 1 at -45 degrees."""
UNRELATED = 0.05
"""Deviation of Cp from Im(1/Z) / omega, over |1/Z| / omega, that neither noise nor rounding to two
digits explains: a wrong unit, a typing error, a truncated cell."""


def parallel_capacitance(Z: ArrayLike, frequency: ArrayLike) -> Real:
    """Cp = Im(1/Z) / omega, in F.

    Z: ohm, shape (..., frequency). frequency: Hz, shape (frequency,).
    """
    Z, omega = np.asarray(Z, dtype=np.complex128), 2 * np.pi * np.asarray(frequency)
    magnitude = np.abs(Z)
    return -(Z.imag / magnitude) / magnitude / omega


def series_capacitance(Z: ArrayLike, frequency: ArrayLike) -> Real:
    """Cs = -1 / (omega X), in F.

    Z: ohm, shape (..., frequency). frequency: Hz, shape (frequency,).
    """
    X = np.asarray(Z, dtype=np.complex128).imag
    return -1 / (2 * np.pi * np.asarray(frequency) * X)


def contradicting(
    Rs: ArrayLike, X: ArrayLike, Cp: ArrayLike, frequency: ArrayLike, tolerance: ArrayLike
) -> Mask:
    """True where Cp deviates from Im(1/Z) / omega by more than a fraction of |1/Z| / omega.

    Rs, X: ohm, Cp: F, shapes (..., frequency). frequency: Hz. tolerance: the fraction, a number
    or of the shape of the frequency. False where Z = 0 or a value is NaN.
    """
    Rs, X, Cp = (np.asarray(each, dtype=float) for each in (Rs, X, Cp))
    size = np.hypot(Rs, X)
    with np.errstate(over="ignore", invalid="ignore"):
        off = np.abs(2 * np.pi * np.asarray(frequency) * Cp * size**2 + X)
        return off > np.asarray(tolerance) * size


def contradiction_text(Cp: float, found: float) -> str:
    """Message for a Cp [F] that contradicts the value `found` from Rs and X."""
    return (
        f"does not follow from Rs and X: it is {Cp:.6g} F where they give {found:.6g} F; "
        "correct its unit or value, or leave the column out"
    )


def branch_reactance(Rs: ArrayLike, Cp: ArrayLike, frequency: ArrayLike) -> Real:
    """X from (Rs, Cp) alone, on the branch with a phase between -90 and -45 degrees.

    Cp = -X / (omega (Rs² + X²)) has two roots with X1 X2 = Rs². This returns the one with |X| >=
    Rs; lines and sheets pass -45 degrees, where `branch.choose_branch` follows them to the other.

    Rs: ohm, Cp: F, shapes (..., frequency). frequency: Hz. Returns X in ohm.
    Raises InputError if Cp <= 0, or if no reactance gives the pair: 2 omega Cp Rs exceeds 1 by more
    than NOISE.
    """
    Rs = np.asarray(Rs, dtype=float)
    susceptance = 2 * np.pi * np.asarray(frequency) * np.asarray(Cp, dtype=float)
    product = 2 * susceptance * Rs
    if np.any(susceptance <= 0) or np.any(product > 1 + NOISE):
        raise InputError(
            "no capacitive reactance has these Rs and Cp: need Cp > 0, 2 omega Cp Rs <= 1"
        )
    return -(1 + np.sqrt(np.maximum(1 - product**2, 0))) / (2 * susceptance)
