"""From frequencies to the complex variable s of the model's equations."""

import numpy as np
from numpy.typing import ArrayLike, NDArray


def laplace_variable(frequency: ArrayLike, loss_tangent: float = 0.0) -> NDArray[np.complex128]:
    """s = j omega (1 - j tan d), rad/s. frequency: Hz."""
    omega = 2 * np.pi * np.asarray(frequency, dtype=np.float64)
    return (omega * (loss_tangent + 1j)).astype(np.complex128)


def penetration_depth(frequency: float, sheet_resistance: float, c: float) -> float:
    """delta = sqrt(2 / (omega R c)) in m: how far from a contact the field reaches.

    frequency: Hz. sheet_resistance: ohm/sq, of both sheets in series. c: F/m².
    """
    return float(np.sqrt(2 / (2 * np.pi * frequency * sheet_resistance * c)))
