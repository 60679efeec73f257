"""Detection of sweeps unlike all training sweeps."""

from __future__ import annotations

import numpy as np
from sklearn.base import BaseEstimator
from sklearn.utils.validation import check_is_fitted, validate_data

from ...simulator.arrays import Real


class Guard(BaseEstimator):
    """Base of the guards: a sweep is novel if its distance `away` exceeds `limit_`."""

    limit_: float

    def away(self, X: Real) -> Real:
        """Distance from the nearest training data, shape (n,)."""
        raise NotImplementedError

    def distances(self, X) -> Real:
        """Distance divided by the limit: above 1 is novel. Shape (n,)."""
        check_is_fitted(self)
        X = np.asarray(validate_data(self, X, reset=False, dtype=np.float64))
        return self.away(X) / self.limit_

    def predict(self, X):
        """1 for a sweep like those of the training, -1 for a novel one; shape (n,)."""
        return np.where(self.distances(X) > 1, -1, 1)
