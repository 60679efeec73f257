"""Impedance and its names: Z = Rs + jX is the object; Cp, Cs and the phase are views of it."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InputError

NOISE = 0.05
"""What noise of Rs and of Cp may add to 2 omega Cp Rs, which is 1 at -45 degrees."""
UNRELATED = 0.05
"""Share of |1/Z| / omega that no noise and no rounding to two digits puts between Cp and the one
that follows from Rs and X: another unit, a slip of the pen, a cell that was cut off."""


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


def contradicting(
    Rs: ArrayLike, X: ArrayLike, Cp: ArrayLike, frequency: ArrayLike, tolerance: ArrayLike
) -> NDArray[np.bool_]:
    """Where Cp is off Im(1/Z) / omega by more than a share of |1/Z| / omega.

    Rs, X: ohm, Cp: F, shapes (..., frequency). frequency: Hz. tolerance: the share, as a number or
    of the shape of the frequency. False where Z = 0 or a value is NaN.
    """
    Rs, X, Cp = (np.asarray(each, dtype=float) for each in (Rs, X, Cp))
    size = np.hypot(Rs, X)
    with np.errstate(over="ignore", invalid="ignore"):
        off = np.abs(2 * np.pi * np.asarray(frequency) * Cp * size**2 + X)
        return off > np.asarray(tolerance) * size


def contradiction_text(Cp: float, found: float) -> str:
    """What is to be said of a Cp [F] that contradicts that found from Rs and X."""
    return (
        f"does not follow from Rs and X: it is {Cp:.6g} F where they give {found:.6g} F; "
        "mend its unit or value, or leave the column out"
    )


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
