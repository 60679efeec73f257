"""Corrections of a trained localizer by a few sweeps, as one more part at the end of its chain."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Real
from ..parts.parts import AffineMap, Scaling

PRIOR = 5.0
"""Weight of the prior of no correction, as a number of sweeps."""


def class_offsets(decisions: Real, index: NDArray[np.intp], sharpness: float) -> Scaling:
    """One offset per class, of least penalised log loss.

    This is vector scaling (C. Guo et al., Proc. 34th Int. Conf. Machine Learning (2017), section
    4.2) without the scales, which a few sweeps do not determine. The prior of offsets is normal
    about zero. decisions: shape (n, K). index: true classes, (n,). sharpness: factor of decisions
    before the softmax.
    """
    from scipy.optimize import minimize
    from scipy.special import log_softmax

    count = decisions.shape[1]
    met = np.eye(count)[index]
    scale = float(decisions.std()) or 1.0

    def loss(p):
        steepness, moved = sharpness * np.exp(p[0]), decisions + scale * p[1:]
        logarithm = log_softmax(steepness * moved, axis=1)
        off = np.exp(logarithm) - met
        slope = steepness * np.append((off * moved).sum(), scale * off.sum(axis=0))
        penalty = PRIOR * p @ p / 2
        return penalty - logarithm[met == 1].sum(), slope + PRIOR * p

    found = minimize(loss, np.zeros(1 + count), jac=True, method="L-BFGS-B")
    return Scaling(-scale * found.x[1:], np.ones(count))


def affine_correction(places: Real, truth: Real) -> AffineMap:
    """Places plus b + A (place - c), by ridge regression; c: mean of the places.

    Source: A. E. Hoerl, R. W. Kennard, Technometrics 12 (1970) 55-67. places, truth: predicted and
    true x, y [mm] and strength of touches, shape (n, 3).
    """
    centre = places.mean(axis=0)
    scale = np.maximum(places.std(axis=0), 1e-6)
    G = np.column_stack([np.ones(len(places)), (places - centre) / scale])
    shift, *turn = np.linalg.solve(G.T @ G + PRIOR * np.eye(4), G.T @ (truth - places))
    return AffineMap(centre, np.eye(3) + np.array(turn) / scale[:, None], centre + shift)
