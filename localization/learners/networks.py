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

from ...simulator.arrays import Real
from ..inputs.samples import LocalizationProblem
from ..parts.parts import DenseLayers, Layer, LogProbabilities
from ..parts.predictor import MIN_PROBABILITY, Chain
from .classifiers import class_names, leading_components, on_one_scale, standardized
from .drift import with_drift

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
Stages = tuple[tuple[float, int], ...]

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


def network(
    problem: LocalizationProblem, X: Real, y: NDArray, stages: Stages | None = None
) -> Chain:
    """Components of unit variance, then a network of classes or of standardised positions.

    X: shape (n, feature). y: classes, (n,), or positions, (n, 3). stages: as STAGES, the default.
    """
    first, X = on_one_scale(problem, with_drift(problem, X))
    components = leading_components(X, COMPONENTS)
    Z = components(X)
    scaling = standardized(Z)
    Z, chain = np.asarray(scaling(Z), np.float32), (*first, components, scaling)
    stages = STAGES if stages is None else stages
    if problem.continuous:
        target = standardized(y)
        return Chain((*chain, fitted_layers(Z, target(y), stages, HIDDEN), target.back))
    layers, classes = fitted_layers(Z, y, stages, HIDDEN, classify=True), class_names(np.unique(y))
    return Chain((*chain, layers, LogProbabilities(MIN_PROBABILITY)), classes)


def fitted_layers(
    X: NDArray[np.float32],
    y: NDArray,
    stages: Stages,
    hidden: tuple[int, ...],
    *,
    classify: bool = False,
    seed: int = 0,
) -> DenseLayers:
    """Layers fitted in stages; each uses every row at least once.

    X: shape (n, F). y: classes, (n,), or numbers, (n, out), fitted by least squares. hidden: number
    of neurons of each layer. seed: that of the initial weights and of the order of rows.
    """
    from sklearn.neural_network import MLPClassifier, MLPRegressor

    batch, random = min(BATCH, len(X)), np.random.default_rng(seed)
    kind: Any = MLPClassifier if classify else MLPRegressor
    network = kind(hidden_layer_sizes=hidden, batch_size=batch, random_state=seed, shuffle=False)
    known = {"classes": np.unique(y)} if classify else {}
    with warnings.catch_warnings(), _interruptible():
        warnings.filterwarnings("error", INTERRUPTED)
        for step, count in stages:
            network.set_params(learning_rate_init=step)
            for rows in _drawn(random, len(X), batch, count):
                network.partial_fit(X[rows], y[rows], **known)
                known = {}
            del network._optimizer
    pairs = zip(network.coefs_, network.intercepts_, strict=True)
    return DenseLayers(tuple(Layer(W, b) for W, b in pairs))


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
