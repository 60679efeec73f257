"""Correction of a trained classifier by a few sweeps: one offset per class."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import minimize
from scipy.special import log_softmax
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.utils.validation import check_is_fitted

from .decisions import decisions


class Offsets(ClassifierMixin, BaseEstimator):
    """Decisions of a fitted classifier plus one offset per class, of least penalised log loss.

    This is vector scaling (C. Guo et al., Proc. 34th Int. Conf. Machine Learning (2017), section
    4.2) without the scales, which a few sweeps do not determine. The prior of offsets is normal
    about zero.

    Parameters
    ----------
    estimator: a FrozenEstimator. sharpness: factor of its decisions before the softmax. prior:
    weight of the prior of zero offsets, as a number of sweeps.

    Attributes
    ----------
    classes_: classes of the estimator. offsets_: shape (class,).
    """

    def __init__(self, estimator=None, sharpness=1.0, prior=5.0):
        self.estimator = estimator
        self.sharpness = sharpness
        self.prior = prior

    def fit(self, X, y):
        """X: shape (n, feature). y: labels, each one of the estimator's classes, shape (n,)."""
        estimator: Any = self.estimator
        self.classes_ = estimator.classes_
        values = decisions(self.estimator, X)
        met = np.eye(self.classes_.size)[np.searchsorted(self.classes_, y)]
        scale = float(values.std()) or 1.0

        def loss(p):
            steepness, moved = self.sharpness * np.exp(p[0]), values + scale * p[1:]
            logarithm = log_softmax(steepness * moved, axis=1)
            off = np.exp(logarithm) - met
            slope = steepness * np.append((off * moved).sum(), scale * off.sum(axis=0))
            penalty = self.prior * p @ p / 2
            return penalty - logarithm[met == 1].sum(), slope + self.prior * p

        found = minimize(loss, np.zeros(1 + self.classes_.size), jac=True, method="L-BFGS-B")
        self.offsets_ = scale * found.x[1:]
        return self

    def decision_function(self, X):
        """Decision for each class, larger if more probable, shape (n, class)."""
        check_is_fitted(self)
        return decisions(self.estimator, X) + self.offsets_

    def predict(self, X):
        """The most probable class of each row."""
        return self.classes_[self.decision_function(X).argmax(axis=1)]
