"""Error-correcting output codes: binary models joined into one of K classes.

A coding matrix M (class, learner) holds +1, -1 or 0: learner j is trained to tell the classes of +1
from those of -1 and never sees those of 0. A new sample goes to the class whose row of M agrees
best with the learners' scores. MATLAB's `fitcecoc` with SVM learners decodes by the same rule.

Sources: E. L. Allwein, R. E. Schapire, Y. Singer, "Reducing multiclass to binary", J. Mach. Learn.
Res. 1 (2000) 113-141; S. Escalera, O. Pujol, P. Radeva, "On the decoding process in ternary
error-correcting output codes", IEEE Trans. Pattern Anal. Mach. Intell. 32 (2010) 120-134.
"""

from copy import copy
from itertools import combinations
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, ClassifierMixin, MetaEstimatorMixin, clone
from sklearn.svm import SVC
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import check_is_fitted, validate_data


def one_versus_one(classes: int) -> NDArray[np.int64]:
    """Every pair of classes has a learner; shape (K, K(K-1)/2)."""
    pairs = list(combinations(range(classes), 2))
    codes = np.zeros((classes, len(pairs)), dtype=np.int64)
    for learner, (first, second) in enumerate(pairs):
        codes[first, learner], codes[second, learner] = 1, -1
    return codes


def one_versus_all(classes: int) -> NDArray[np.int64]:
    """Every class has a learner that tells it from the others; shape (K, K), for K = 2 (2, 1).

    Of two classes each is all the other is not: a second learner would mirror the first.
    """
    codes = 2 * np.eye(classes, dtype=np.int64) - 1
    return codes[:, :1] if classes == 2 else codes


def ordinal(classes: int) -> NDArray[np.int64]:
    """Learner j tells the classes after the j-th (+1) from the rest (-1); shape (K, K-1)."""
    return 1 - 2 * np.triu(np.ones((classes, classes - 1), dtype=np.int64))


CODINGS = {
    "one-versus-one": one_versus_one,
    "one-versus-all": one_versus_all,
    "ordinal": ordinal,
}


def average_loss(codes: ArrayLike, scores: ArrayLike) -> NDArray[np.float64]:
    """How badly the learners' scores agree with the code of each class, weighted by loss.

    loss(i, k) = sum_j |m_kj| g(m_kj, s_ij) / sum_j |m_kj|, with the hinge loss
    g(m, s) = max(0, 1 - m s) / 2.

    codes: M of +1, -1, 0, shape (K, L), every class known to some learner. scores: shape (n, L).
    Returns shape (n, K), each >= 0. Source: Escalera et al. (2010), loss-weighted decoding.
    """
    codes, scores = np.asarray(codes), np.asarray(scores)
    hinge = np.maximum(0, 1 - scores) @ (codes == 1).T + np.maximum(0, 1 + scores) @ (codes == -1).T
    return hinge / (2 * np.abs(codes).sum(axis=1))


class ECOCClassifier(MetaEstimatorMixin, ClassifierMixin, BaseEstimator):
    """Classifier of K classes made of L binary learners and a ternary coding matrix.

    Parameters
    ----------
    estimator: binary classifier with a `decision_function`; None is `SVC()`, of RBF kernel.
    coding: a name in CODINGS: "one-versus-one", "one-versus-all" or "ordinal" (classes that follow
        one another in the order of `classes_`).

    Attributes
    ----------
    classes_: labels in ascending order, shape (K,).
    coding_matrix_: shape (K, L).
    estimators_: the L fitted learners, in the order of the columns of `coding_matrix_`; or one
        `SVC` that holds them all, where it is the same one by one (see `holds_all_pairs`).
    """

    def __init__(self, estimator=None, coding="one-versus-one"):
        self.estimator = estimator
        self.coding = coding

    def fit(self, X, y):
        """Train every learner on the classes it is to tell apart.

        X: shape (n, feature). y: labels, shape (n,). Returns self.
        Raises ValueError for an unknown coding, or y of a single class.
        """
        if self.coding not in CODINGS:
            raise ValueError(f"`coding` must be one of {', '.join(CODINGS)}, got {self.coding!r}")
        X, y = validate_data(self, X, y)
        check_classification_targets(y)
        self.classes_, index = np.unique(y, return_inverse=True)
        if self.classes_.size < 2:
            raise ValueError(f"need samples of at least 2 classes, got 1 class: {self.classes_[0]}")
        self.coding_matrix_ = CODINGS[self.coding](self.classes_.size)
        fresh = clone(SVC() if self.estimator is None else self.estimator)
        pairs = self.coding == "one-versus-one" and self.classes_.size > 2
        self.estimators_ = (
            [_all_pairs(fresh, X, index)]
            if pairs and holds_all_pairs(fresh)
            else [_fitted(copy(fresh), X, code[index]) for code in self.coding_matrix_.T]
        )
        return self

    def decision_function(self, X):
        """Minus the average loss of each class, shape (n, K).

        Of two classes, the advantage of the second over the first, shape (n,): positive where the
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
        """Of each learner, shape (n, L)."""
        if len(self.estimators_) < self.coding_matrix_.shape[1]:
            return _scores_of_pairs(self.estimators_[0], X)
        return np.column_stack([learner.decision_function(X) for learner in self.estimators_])


def holds_all_pairs(learner: Any) -> bool:
    """Whether one fit to all classes holds, bit for bit, a fit of this learner to each pair.

    libsvm solves the pairs of many classes one by one, each by its own samples alone. Of what is
    set here only a width that follows the spread of the samples, weights and probabilities ask for
    all of them. Source: C.-C. Chang, C.-J. Lin, "LIBSVM", ACM Trans. Intell. Syst. Technol. 2
    (2011) 27, section 4.
    """
    return (
        type(learner) is SVC
        and isinstance(learner.gamma, Real)
        and isinstance(learner.kernel, str)
        and learner.kernel != "precomputed"
        and learner.class_weight is None
        and learner.probability is not True
        and not learner.break_ties
    )


def _all_pairs(learner: Any, X: Any, index: NDArray[np.intp]) -> Any:
    """Learners of all pairs. Classes are numbered backwards: of each pair, libsvm then takes the
    same for its first as it does of the sides -1 and +1."""
    return learner.set_params(decision_function_shape="ovo").fit(X, -index)


def _scores_of_pairs(learner: Any, X: Any) -> NDArray[np.float64]:
    """Of all pairs in the order of `one_versus_one`, shape (n, L)."""
    backwards = learner.decision_function(X)
    K = learner.classes_.size
    place = {pair: k for k, pair in enumerate(combinations(range(K), 2))}
    order = [place[K - 1 - second, K - 1 - first] for first, second in combinations(range(K), 2)]
    return -backwards[:, order]


def _fitted(learner: Any, X: Any, sides: NDArray[np.int64]) -> Any:
    """A binary learner, of the samples that are on a side."""
    seen = sides != 0
    return learner.fit(X[seen], sides[seen])
