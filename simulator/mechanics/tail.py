"""How much of a deflection only the highest order of its elements holds: where to refine."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from skfem import ElementTriP3

from simulator.mechanics.membrane import ELEMENT, Membrane

LOWER = ElementTriP3()


def tails(membrane: Membrane, w: NDArray[np.float64]) -> NDArray[np.float64]:
    """Largest distance in m of w from what one order less makes of it, shape (triangle,)."""
    return np.abs(_TAIL @ w[membrane.nodes]).max(axis=0)


def _tail() -> NDArray[np.float64]:
    """Values at the element's nodes less those of the lower element through its own."""
    shapes = range(len(ELEMENT.doflocs)), range(len(LOWER.doflocs))
    at_lower = np.array([ELEMENT.lbasis(LOWER.doflocs.T, k)[0] for k in shapes[0]]).T
    back = np.array([LOWER.lbasis(ELEMENT.doflocs.T, k)[0] for k in shapes[1]]).T
    return np.eye(len(ELEMENT.doflocs)) - back @ at_lower


_TAIL = _tail()
