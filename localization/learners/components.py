"""Principal components of features, in the proportions that the features have."""

from __future__ import annotations

import numpy as np
from sklearn.base import BaseEstimator, ClassNamePrefixFeaturesOutMixin, TransformerMixin
from sklearn.decomposition import PCA
from sklearn.utils.validation import check_is_fitted, validate_data


class Components(ClassNamePrefixFeaturesOutMixin, TransformerMixin, BaseEstimator):
    """The leading principal components, all divided by one number: their variances sum to 1.

    Features of equal errors, such as ln |Z| and phase, keep equal errors in all components; scaling
    each feature on its own would raise the noise of those that a press hardly changes.

    Parameters
    ----------
    count: maximum number of components.

    Attributes
    ----------
    pca_: the fitted components. scale_: their divisor.
    """

    def __init__(self, count=8):
        self.count = count

    def fit(self, X, y=None):
        """Find the components. X: shape (n, feature). Returns self."""
        X = np.asarray(validate_data(self, X, ensure_min_samples=2, dtype=np.float64))
        self.pca_ = PCA(min(self.count, *X.shape), svd_solver="auto").fit(X)
        self.scale_ = float(np.sqrt(self.pca_.explained_variance_.sum())) or 1.0
        self._n_features_out = self.pca_.n_components_
        return self

    def transform(self, X):
        """Components, shape (n, component)."""
        check_is_fitted(self)
        return self.pca_.transform(validate_data(self, X, reset=False)) / self.scale_
