"""Fisher information of independent readings, and what it leaves of some unknowns among others.

With J the derivatives of what a meter reads over its noise, one reading adds J'J; a prior adds
1/deviation². The deviation of one unknown with all others unknown too is the root of its diagonal
element of the inverse (Cramér and Rao's bound); a Schur complement does the same to several.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

RIDGE = 1e-12
"""Added to the information, scaled to a unit diagonal: what is less than this is none."""


def summed(slopes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Information of each frequency, shape (case, frequency, p, p).

    slopes: over the meter's noise, shape (case, interface, frequency, 2, p).
    """
    return np.einsum("cifqa,cifqb->cfab", slopes, slopes, optimize=True)


def covariances(information: NDArray[np.float64], wanted: int) -> NDArray[np.float64]:
    """Bound on the covariance of the first `wanted` unknowns, shape (..., wanted, wanted).

    information: with priors, shape (..., p, p). The variance of an unknown of which there is none
    at all is infinite.
    """
    diagonal = np.diagonal(information, axis1=-2, axis2=-1)
    none = diagonal <= 0
    scale = np.where(none, 1.0, np.sqrt(np.maximum(diagonal, 0.0)))
    scales = scale[..., :, None] * scale[..., None, :]
    ridge = RIDGE + np.where(none, 1.0, 0.0)
    inverse = np.linalg.inv(information / scales + _on_diagonal(ridge))
    found = (inverse / scales)[..., :wanted, :wanted]
    return found + _on_diagonal(np.where(none, np.inf, 0.0)[..., :wanted])


def variances(information: NDArray[np.float64], wanted: int) -> NDArray[np.float64]:
    """The diagonals of `covariances`, shape (..., wanted)."""
    return np.diagonal(covariances(information, wanted), axis1=-2, axis2=-1)


def _on_diagonal(values: NDArray[np.float64]) -> NDArray[np.float64]:
    found = np.zeros((*values.shape, values.shape[-1]))
    along = np.arange(values.shape[-1])
    found[..., along, along] = values
    return found
