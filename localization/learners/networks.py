"""Networks of neurons, for the many sweeps that a simulator makes: learned in ever smaller steps.

With sweeps without end, what a network tells tends to the posterior under all that was drawn for
them: skin, hand and meter. A simulator has them; what is unknown needs no formula then.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator, ClassifierMixin, RegressorMixin
from sklearn.neural_network import MLPClassifier, MLPRegressor
from sklearn.utils.validation import check_is_fitted, validate_data

HIDDEN = (128, 128)
STAGES = ((2e-3, 6000), (5e-4, 3000), (1e-4, 1500))
"""Size of steps and how many, one stage after the other."""
SHORT = ((2e-3, 240), (5e-4, 120), (1e-4, 60))
"""The same of few noisy sweeps, which by all of STAGES are learned by heart."""
BATCH = 500
"""Sweeps that one step looks at."""
TOGETHER = 10
"""Batches that are handed over at a time: of these alone every class has a number of its own."""
COMPONENTS = 26
"""Of features, that a network looks at."""


INTERRUPTED = "Training interrupted by user"
"""What scikit-learn warns of where it takes Ctrl-C for the end of a fit."""


@contextmanager
def _interruptible() -> Iterator[None]:
    """Ctrl-C ends more than the fit, where scikit-learn's warning of it is an error."""
    try:
        yield
    except UserWarning as warning:
        if not str(warning).startswith(INTERRUPTED):
            raise
        raise KeyboardInterrupt from None


class _Network(BaseEstimator):
    """What both kinds share: how they learn, and the form in which they take features.

    Parameters
    ----------
    hidden: neurons of each layer. stages: as STAGES; every sweep is seen once at least in each.
    seed: of the first weights and of the order.

    Attributes
    ----------
    network_: the fitted one of scikit-learn, in single precision.
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
        """The likeliest class, or the numbers, of each row."""
        X = self._validated(X)
        return self.network_.predict(X)

    def _validated(self, X):
        check_is_fitted(self)
        return validate_data(self, X, reset=False, dtype=np.float32)


def _drawn(
    random: np.random.Generator, size: int, batch: int, steps: int
) -> Iterator[NDArray[np.intp]]:
    """Rows of TOGETHER batches each, for so many steps: all of them in one order, then in another.

    For more steps where else some row is in none.
    """
    left = max(steps, -(-size // batch)) * batch
    waiting = np.zeros(0, dtype=np.intp)
    while left:
        now = min(TOGETHER * batch, left)
        while len(waiting) < now:
            waiting = np.concatenate([waiting, random.permutation(size)])
        yield waiting[:now]
        waiting, left = waiting[now:], left - now


class NetworkClassifier(ClassifierMixin, _Network):
    """Tells classes and their probabilities."""

    kind = MLPClassifier

    def _known(self, y):
        return {"classes": np.unique(y)}

    @property
    def classes_(self):
        """In ascending order, shape (K,)."""
        check_is_fitted(self)
        return self.network_.classes_

    def predict_proba(self, X):
        """Probability of each class, shape (n, K)."""
        X = self._validated(X)
        return self.network_.predict_proba(X)


class NetworkRegressor(RegressorMixin, _Network):
    """Tells numbers, by least squares."""

    kind = MLPRegressor
