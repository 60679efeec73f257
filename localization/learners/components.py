"""Principal components of features, in the proportions that the features have, or all alike."""

from __future__ import annotations

import numpy as np
from sklearn.base import BaseEstimator, OneToOneFeatureMixin, TransformerMixin
from sklearn.decomposition import PCA
from sklearn.utils.validation import check_is_fitted, validate_data


class Components(OneToOneFeatureMixin, TransformerMixin, BaseEstimator):
    """The leading principal components, all divided by one number: they vary by 1 in sum.

    Features that err alike, as ln |Z| and phase do, still err alike in all components; scaling each
    feature on its own would raise the noise of those that a press hardly changes.

    Parameters
    ----------
    count: how many components, or all there are if fewer. alike: whether each varies by 1 instead,
        for learners that have sweeps enough to find out what is noise.

    Attributes
    ----------
    pca_: the fitted components. scale_: what they are divided by.
    """

    def __init__(self, count=8, alike=False):
        self.count = count
        self.alike = alike

    def fit(self, X, y=None):
        """Find the components. X: shape (n, feature). Returns self."""
        X = np.asarray(validate_data(self, X, ensure_min_samples=2, dtype=np.float64))
        solver = "covariance_eigh" if self.alike else "full"
        self.pca_ = PCA(min(self.count, *X.shape), svd_solver=solver).fit(X)
        variance = self.pca_.explained_variance_
        least = np.finfo(float).eps * variance.max()
        own = np.sqrt(np.maximum(variance, least)) if self.alike else np.sqrt(variance.sum())
        self.scale_ = np.where(own > 0, own, 1.0)
        return self

    def transform(self, X):
        """Components, shape (n, component)."""
        check_is_fitted(self)
        return self.pca_.transform(validate_data(self, X, reset=False)) / self.scale_
