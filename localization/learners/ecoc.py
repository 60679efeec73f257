"""Error-correcting output codes: SVMs of all pairs of classes form one classifier.

A coding matrix M (class, learner) holds +1, -1 or 0: learner j is trained to separate the class of
+1 from that of -1, without the classes of 0. A new sample goes to the class whose row of M agrees
best with the learners' scores. MATLAB's `fitcecoc` with SVM learners decodes by the same rule.

Sources: E. L. Allwein, R. E. Schapire, Y. Singer, "Reducing multiclass to binary", J. Mach. Learn.
Res. 1 (2000) 113-141; S. Escalera, O. Pujol, P. Radeva, "On the decoding process in ternary
error-correcting output codes", IEEE Trans. Pattern Anal. Mach. Intell. 32 (2010) 120-134.
"""

from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator, ClassifierMixin, MetaEstimatorMixin, clone
from sklearn.svm import SVC
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import check_is_fitted, validate_data

from ...simulator.arrays import Integer, Real


def one_versus_one(classes: int) -> Integer:
    """Coding matrix with a learner for every pair of classes; shape (K, K(K-1)/2)."""
    pairs = list(combinations(range(classes), 2))
    codes = np.zeros((classes, len(pairs)), dtype=np.int64)
    for learner, (first, second) in enumerate(pairs):
        codes[first, learner], codes[second, learner] = 1, -1
    return codes


def average_loss(codes: ArrayLike, scores: ArrayLike) -> Real:
    """Weighted mean loss of the learners' scores against the code of each class.

    loss(i, k) = sum_j |m_kj| g(m_kj, s_ij) / sum_j |m_kj|, with the hinge loss
    g(m, s) = max(0, 1 - m s) / 2.

    codes: M of +1, -1, 0, shape (K, L), every class known to some learner. scores: shape (n, L).
    Returns shape (n, K), each >= 0. Source: Escalera et al. (2010), loss-weighted decoding.
    """
    codes, scores = np.asarray(codes), np.asarray(scores)
    hinge = np.maximum(0, 1 - scores) @ (codes == 1).T + np.maximum(0, 1 + scores) @ (codes == -1).T
    return hinge / (2 * np.abs(codes).sum(axis=1))


class ECOCClassifier(MetaEstimatorMixin, ClassifierMixin, BaseEstimator):
    """Classifier of K classes by SVMs of all L pairs of them and a ternary coding matrix.

    Parameters
    ----------
    estimator: an `SVC`; None is `SVC()`, of RBF kernel.

    Attributes
    ----------
    classes_: labels in ascending order, shape (K,).
    coding_matrix_: shape (K, L).
    estimators_: one `SVC` that holds the learners of all pairs; in models of earlier versions, one
        learner for each column of `coding_matrix_`, in order.
    """

    def __init__(self, estimator=None):
        self.estimator = estimator

    def fit(self, X, y):
        """Train the learners of all pairs by one fit to all classes.

        libsvm solves the pairs of many classes one by one, each by its own samples alone. Classes
        are numbered backwards: of each pair, libsvm then takes the same for its first as it does
        of the sides -1 and +1. Source: C.-C. Chang, C.-J. Lin, "LIBSVM", ACM Trans. Intell. Syst.
        Technol. 2 (2011) 27, section 4.

        X: shape (n, feature). y: labels, shape (n,). Returns self.
        Raises ValueError for y of a single class.
        """
        X, y = validate_data(self, X, y)
        check_classification_targets(y)
        self.classes_, index = np.unique(y, return_inverse=True)
        if self.classes_.size < 2:
            raise ValueError(f"need samples of at least 2 classes, got 1 class: {self.classes_[0]}")
        self.coding_matrix_ = one_versus_one(self.classes_.size)
        fresh: Any = clone(SVC() if self.estimator is None else self.estimator)
        self.estimators_ = [fresh.set_params(decision_function_shape="ovo").fit(X, -index)]
        return self

    def decision_function(self, X):
        """Minus the average loss of each class, shape (n, K).

        For two classes, the advantage of the second over the first, shape (n,): positive where the
        second is predicted. X: shape (n, feature).
        """
        check_is_fitted(self)
        X = validate_data(self, X, reset=False)
        closeness = -average_loss(self.coding_matrix_, self._scores(X))
        return closeness[:, 1] - closeness[:, 0] if self.classes_.size == 2 else closeness

    def predict(self, X):
        """Labels of least average loss, ties to the lowest class, shape (n,). X: (n, feature)."""
        decision = self.decision_function(X)
        best = decision > 0 if decision.ndim == 1 else decision.argmax(axis=1)
        return self.classes_[best.astype(np.intp)]

    def _scores(self, X):
        """Score of each learner, shape (n, L)."""
        if len(self.estimators_) < self.coding_matrix_.shape[1]:
            return self._scores_of_pairs(X)
        return np.column_stack([learner.decision_function(X) for learner in self.estimators_])

    def _scores_of_pairs(self, X):
        """Scores of all pairs in the order of `one_versus_one`, shape (n, L)."""
        count = self.classes_.size
        first, second = np.triu_indices(count, 1)
        lower, upper = count - 1 - second, count - 1 - first
        # libsvm's classes run backwards; pair (a, b) of K has a (2K - a - 1) / 2 pairs of less a
        order = lower * (2 * count - lower - 1) // 2 + upper - lower - 1
        return -self.estimators_[0].decision_function(X)[:, order]
