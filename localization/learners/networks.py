"""Neural networks for the many sweeps of a simulator, trained with decreasing step size.

With more and more sweeps, the output of a network tends to the posterior under the distributions
that skins, presses and readings are drawn from. The unknowns then need no formula.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import expit
from sklearn.base import BaseEstimator, ClassifierMixin, RegressorMixin
from sklearn.neural_network import MLPClassifier, MLPRegressor
from sklearn.utils.validation import check_is_fitted, validate_data

HIDDEN = (128, 128)
STAGES = ((2e-3, 6000), (5e-4, 3000), (1e-4, 1500))
"""Step size and number of steps of each stage, in order."""
SHORT_STAGES = ((2e-3, 240), (5e-4, 120), (1e-4, 60))
"""Stages for few noisy sweeps, which STAGES would overfit."""
BATCH = 500
"""Number of sweeps of one step."""
BATCHES_AT_ONCE = 10
"""Number of batches of one `partial_fit`, which encodes the classes of these sweeps only."""
COMPONENTS = 26
"""Number of principal components of the features that a network takes."""


INTERRUPTED = "Training interrupted by user"
"""Start of scikit-learn's warning when it takes Ctrl-C for the end of a fit."""


@contextmanager
def _interruptible() -> Iterator[None]:
    """Raise KeyboardInterrupt on Ctrl-C. scikit-learn's warning of it must be an error here."""
    try:
        yield
    except UserWarning as warning:
        if not str(warning).startswith(INTERRUPTED):
            raise
        raise KeyboardInterrupt from None


class _Network(BaseEstimator):
    """Base of both networks: training in stages, and validation of features.

    Parameters
    ----------
    hidden: number of neurons of each layer. stages: as STAGES; each stage uses every sweep at least
    once. seed: seed of the initial weights and of the order of sweeps.

    Attributes
    ----------
    network_: the fitted network of scikit-learn, in single precision.
    """

    kind: Any

    def __init__(self, hidden=HIDDEN, stages=STAGES, seed=0):
        self.hidden = hidden
        self.stages = stages
        self.seed = seed

    def fit(self, X, y):
        """X: shape (n, feature). y: classes, or numbers, shape (n,) or (n, output)."""
        X, y = validate_data(self, X, y, dtype=np.float32, multi_output=True)
        batch, random = min(BATCH, len(X)), np.random.default_rng(self.seed)
        self.network_ = self.kind(
            hidden_layer_sizes=self.hidden,
            batch_size=batch,
            random_state=self.seed,
            shuffle=False,
        )
        known = self._known(y)
        with warnings.catch_warnings(), _interruptible():
            warnings.filterwarnings("error", INTERRUPTED)
            for step, count in self.stages:
                self.network_.set_params(learning_rate_init=step)
                for rows in _drawn(random, len(X), batch, count):
                    self.network_.partial_fit(X[rows], y[rows], **known)
                    known = {}
                del self.network_._optimizer
        return self

    def _known(self, y) -> dict[str, Any]:
        """Keyword arguments of the first `partial_fit`."""
        return {}

    def predict(self, X):
        """The most probable class, or the numbers, of each row."""
        X = self._validated(X)
        return self.network_.predict(X)

    def _validated(self, X):
        check_is_fitted(self)
        return validate_data(self, X, reset=False, dtype=np.float32)


def _drawn(
    random: np.random.Generator, size: int, batch: int, steps: int
) -> Iterator[NDArray[np.intp]]:
    """Rows for `steps` steps, BATCHES_AT_ONCE batches at a time.

    They are all rows in random order, repeatedly. There are more steps if some row would be in none
    otherwise.
    """
    left = max(steps, -(-size // batch)) * batch
    waiting = np.zeros(0, dtype=np.intp)
    while left:
        now = min(BATCHES_AT_ONCE * batch, left)
        while len(waiting) < now:
            waiting = np.concatenate([waiting, random.permutation(size)])
        yield waiting[:now]
        waiting, left = waiting[now:], left - now


class NetworkClassifier(ClassifierMixin, _Network):
    """Network that predicts classes and their probabilities."""

    kind = MLPClassifier

    def _known(self, y):
        return {"classes": np.unique(y)}

    @property
    def classes_(self):
        """Classes in ascending order, shape (K,)."""
        check_is_fitted(self)
        return self.network_.classes_

    def predict_proba(self, X):
        """Probability of each class, shape (n, K)."""
        X = self._validated(X)
        if self.classes_.size > 2:
            return self.network_.predict_proba(X)
        odds = self._log_odds(X)
        return expit(np.hstack([-odds, odds]))

    def _log_odds(self, X):
        """ln of the odds of the second of two classes, shape (n, 1).

        1 - p in single precision would round the smaller probability to a multiple of 6e-8.
        """
        *hidden, (W, b) = zip(self.network_.coefs_, self.network_.intercepts_, strict=True)
        for inner, offset in hidden:
            X = np.maximum(X @ inner + offset, 0)
        return X @ W + b


class NetworkRegressor(RegressorMixin, _Network):
    """Network that predicts numbers, fitted by least squares."""

    kind = MLPRegressor
