"""Probabilities from decisions, by one number found on sweeps that were held out.

Source: C. Guo, G. Pleiss, Y. Sun, K. Q. Weinberger, "On calibration of modern neural networks",
Proc. 34th Int. Conf. Machine Learning (2017), section 4.2. scikit-learn's
`CalibratedClassifierCV(method="temperature")` finds the same probabilities to 1e-7, but keeps the
decisions of held-out sweeps to itself, of which thresholds are found too: it would train all twice.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize_scalar
from scipy.special import log_softmax, softmax

SHARPEST = 1e4
"""Decisions are multiplied by at most this much, and at least by its inverse."""
BINS = 10
"""Of answers, by how sure they are."""


def sharpness_of(decisions: NDArray[np.float64], index: NDArray[np.intp]) -> float:
    """The factor of decisions of which the softmax tells the classes with least log loss.

    decisions: of sweeps that were not trained on, shape (n, K). index: their classes, shape (n,).
    """
    rows = np.arange(index.size)

    def log_loss(logarithm: float) -> float:
        return -float(log_softmax(np.exp(logarithm) * decisions, axis=1)[rows, index].mean())

    widest = np.log(SHARPEST)
    found = minimize_scalar(log_loss, bounds=(-widest, widest), method="bounded")
    return float(np.exp(found.x))


def probabilities(decisions: NDArray[np.float64], sharpness: float) -> NDArray[np.float64]:
    """The softmax of decisions times sharpness, shape (n, K): rows sum to 1, order is kept."""
    return np.asarray(softmax(sharpness * decisions, axis=1))


def calibration_error(probability: ArrayLike, right: ArrayLike) -> float:
    """Expected calibration error: how far answers are from being right as often as they say.

    sum_b |mean right - mean probability| n_b / n over BINS of like numbers of answers (Guo et al.,
    section 2, with bins of like widths). Both arrays: shape (n,).
    """
    probability, right = np.asarray(probability, dtype=float), np.asarray(right, dtype=float)
    order = np.argsort(probability, kind="stable")
    parts = np.array_split(order, BINS)
    gaps = [abs(float((right[part] - probability[part]).sum())) for part in parts]
    return sum(gaps) / probability.size
