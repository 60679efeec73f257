"""Probabilities from decisions, by one factor that is fitted to held-out sweeps.

Source: C. Guo, G. Pleiss, Y. Sun, K. Q. Weinberger, "On calibration of modern neural networks",
Proc. 34th Int. Conf. Machine Learning (2017), section 4.2. scikit-learn's
`CalibratedClassifierCV(method="temperature")` gives the same probabilities to 1e-7, but does not
return the decisions of held-out sweeps. Thresholds need these too, so all would be trained twice.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize_scalar
from scipy.special import log_softmax, softmax

from ...simulator.arrays import Real

SHARPEST = 1e4
"""Maximum factor of decisions; the minimum is its inverse."""
BINS = 10
"""Number of bins of answers, by their probability."""


def sharpness_of(decisions: Real, index: NDArray[np.intp]) -> float:
    """Factor of the decisions whose softmax has the least log loss.

    decisions: those of sweeps that were not trained on, shape (n, K). index: true classes, (n,).
    """
    rows = np.arange(index.size)

    def log_loss(logarithm: float) -> float:
        return -float(log_softmax(np.exp(logarithm) * decisions, axis=1)[rows, index].mean())

    widest = np.log(SHARPEST)
    found: Any = minimize_scalar(log_loss, bounds=(-widest, widest), method="bounded")
    return float(np.exp(found.x))


def probabilities(decisions: Real, sharpness: float) -> Real:
    """Softmax of decisions times sharpness, shape (n, K): rows sum to 1, the order is kept."""
    return np.asarray(softmax(sharpness * decisions, axis=1))


def calibration_error(probability: ArrayLike, right: ArrayLike) -> float:
    """Expected calibration error: mean difference of the rate of right answers from probability.

    sum_b |mean right - mean probability| n_b / n over BINS with equal numbers of answers (Guo et
    al., section 2, take bins of equal width). Both arrays: shape (n,).
    """
    probability, right = np.asarray(probability, dtype=float), np.asarray(right, dtype=float)
    order = np.argsort(probability, kind="stable")
    parts = np.array_split(order, BINS)
    gaps = [abs(float((right[part] - probability[part]).sum())) for part in parts]
    return sum(gaps) / probability.size
