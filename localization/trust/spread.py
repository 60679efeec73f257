"""How far a regressor errs, by how far it erred nearby on sweeps that were held out."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator
from sklearn.metrics import pairwise_distances
from sklearn.utils.validation import check_is_fitted

AT_ONCE = 1000


class Spread(BaseEstimator):
    """Standard deviation of answers, from the residuals of the nearest held-out answers.

    Parameters
    ----------
    neighbours: how many residuals are averaged, in squares. most: held-out answers that are kept.

    Attributes
    ----------
    answers_, residuals_: shape (kept, output). scale_: of each output, shape (output,).
    """

    def __init__(self, neighbours=50, most=5000):
        self.neighbours = neighbours
        self.most = most

    def fit(self, answers, residuals):
        """answers, residuals: of sweeps that were not trained on, shape (n, output)."""
        kept = np.unique(np.linspace(0, len(answers) - 1, min(self.most, len(answers))).astype(int))
        self.answers_, self.residuals_ = answers[kept], residuals[kept]
        scale = answers.std(axis=0)
        self.scale_ = np.where(scale > 0, scale, 1.0)
        return self

    def predict(self, answers) -> NDArray[np.float64]:
        """Standard deviation of each output of each answer, shape (n, output)."""
        check_is_fitted(self)
        count = min(self.neighbours, len(self.answers_))
        squares = [
            np.square(self.residuals_[_nearest(part / self.scale_, known, count)]).mean(axis=1)
            for known in [self.answers_ / self.scale_]
            for part in np.array_split(answers, max(1, len(answers) // AT_ONCE))
        ]
        return np.sqrt(np.concatenate(squares))


def _nearest(
    asked: NDArray[np.float64], known: NDArray[np.float64], count: int
) -> NDArray[np.intp]:
    """Indices of the known that are nearest to each asked, shape (asked, count)."""
    distances = pairwise_distances(asked, known)
    return np.argpartition(distances, count - 1, axis=1)[:, :count]
