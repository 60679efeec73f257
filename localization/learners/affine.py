"""Correction of a trained regressor of places by a few touches: a small affine map."""

from __future__ import annotations

from typing import Any

import numpy as np
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.utils.validation import check_is_fitted


class Affine(RegressorMixin, BaseEstimator):
    """Places y of a fitted regressor plus b + A (y - c), by ridge regression.

    c: mean of the places predicted for the touches fitted to. Source: A. E. Hoerl, R. W. Kennard,
    Technometrics 12 (1970) 55-67.

    Parameters
    ----------
    estimator: a FrozenEstimator that predicts x, y [mm] and strength. prior: weight of the prior of
    no correction, as a number of touches.

    Attributes
    ----------
    centre_, scale_: mean and standard deviation of its predictions for the touches, (3,).
    correction_: b, then A times the scale, (4, 3).
    """

    def __init__(self, estimator=None, prior=5.0):
        self.estimator = estimator
        self.prior = prior

    def fit(self, X, y):
        """X: shape (n, feature). y: x, y [mm] and strength of the touches, shape (n, 3)."""
        estimator: Any = self.estimator
        places = np.asarray(estimator.predict(X))
        self.centre_ = places.mean(axis=0)
        self.scale_ = np.maximum(places.std(axis=0), 1e-6)
        G = self._terms(places)
        left = G.T @ G + self.prior * np.eye(4)
        self.correction_ = np.linalg.solve(left, G.T @ (np.asarray(y) - places))
        return self

    def predict(self, X, return_std=False):
        """Corrected prediction of the estimator; deviations are not corrected."""
        check_is_fitted(self)
        estimator: Any = self.estimator
        if not return_std:
            places = np.asarray(estimator.predict(X))
            return places + self._terms(places) @ self.correction_
        places, deviation = estimator.predict(X, return_std=True)
        return places + self._terms(places) @ self.correction_, deviation

    def _terms(self, places):
        return np.column_stack([np.ones(len(places)), (places - self.centre_) / self.scale_])
