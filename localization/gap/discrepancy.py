"""Distance between two samples of features: maximum mean discrepancy and energy distance.

Sources: A. Gretton, K. M. Borgwardt, M. J. Rasch, B. Schölkopf, A. Smola, "A kernel two-sample
test", J. Mach. Learn. Res. 13 (2012) 723-773; G. J. Székely, M. L. Rizzo, "Energy statistics", J.
Stat. Plan. Inference 143 (2013) 1249-1272.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import cdist

from ...simulator.arrays import Mask, Real

PERMUTATIONS = 499
MIN_SAMPLE = 2
MAX_SAMPLE = 500
"""Maximum number of sweeps of a sample; larger samples are subsampled."""


@dataclass(frozen=True)
class Discrepancy:
    """Distances between two samples of sizes `first` and `second`.

    mmd2: squared maximum mean discrepancy, unbiased, so it may be negative; of features of unit
    spread. p: probability of a value as large if both samples have one distribution. energy: energy
    distance. coefficient: energy distance divided by the mean distance between the samples, 0 to 1.
    """

    first: int
    second: int
    mmd2: float
    p: float
    energy: float
    coefficient: float


def discrepancy(X: Real, Y: Real, random: np.random.Generator) -> Discrepancy | None:
    """Discrepancy of samples of the same features, shapes (n, feature) and (m, feature).

    None if either has fewer than MIN_SAMPLE. random: draws permutations, and subsamples to
    MAX_SAMPLE sweeps.
    """
    if min(len(X), len(Y)) < MIN_SAMPLE:
        return None
    X, Y = _subsampled(X, random), _subsampled(Y, random)
    both = np.concatenate([X, Y])
    distances = cdist(both, both).astype(np.float64)
    K = kernel(distances)
    energy, coefficient = energy_distance(distances, len(X))
    return Discrepancy(
        first=len(X),
        second=len(Y),
        mmd2=unbiased_mmd2(K, len(X)),
        p=permutation_p(K, len(X), random),
        energy=energy,
        coefficient=coefficient,
    )


def kernel(distances: Real) -> Real:
    """exp(-d²/(2 w²)), w the median of all distances between different sweeps; shape as given."""
    between = distances[np.triu_indices(len(distances), 1)]
    width = float(np.median(between)) or float(between.max()) or 1.0
    return np.exp(-((distances / width) ** 2) / 2)


def unbiased_mmd2(K: Real, n: int) -> float:
    """Gretton et al. (2012), Eq. 3, of a kernel matrix whose first n rows are the first sample."""
    first = np.arange(len(K)) < n
    return float(_mmd2(K, first[:, None])[0])


def permutation_p(K: Real, n: int, random: np.random.Generator) -> float:
    """Share of PERMUTATIONS, and of the actual samples, with an MMD² at least as large."""
    first = np.arange(len(K)) < n
    shuffled = random.permuted(np.tile(first[:, None], (1, PERMUTATIONS)), axis=0)
    rounding = 1e-12
    as_large = _mmd2(K, shuffled) >= unbiased_mmd2(K, n) - rounding
    return float((1 + as_large.sum()) / (1 + PERMUTATIONS))


def energy_distance(distances: Real, n: int) -> tuple[float, float]:
    """2 E|X - Y| - E|X - X'| - E|Y - Y'|, and that over 2 E|X - Y|; the first n rows are X."""
    between = 2 * distances[:n, n:].mean()
    within = distances[:n, :n].mean() + distances[n:, n:].mean()
    energy = max(0.0, float(between - within))
    return energy, energy / float(between) if between > 0 else 0.0


def _mmd2(K: Real, first: Mask) -> Real:
    """Unbiased MMD² for each column of `first`, which marks the rows of K in the first sample."""
    one, two = first.astype(float), (~first).astype(float)
    off_diagonal = K - np.diag(np.diag(K))
    n, m = one.sum(axis=0), two.sum(axis=0)
    from_one, from_two = off_diagonal @ one, off_diagonal @ two
    within = (one * from_one).sum(axis=0) / (n * (n - 1))
    beyond = (two * from_two).sum(axis=0) / (m * (m - 1))
    return within + beyond - 2 * (one * from_two).sum(axis=0) / (n * m)


def _subsampled(X: Real, random: np.random.Generator) -> Real:
    return X if len(X) <= MAX_SAMPLE else X[random.choice(len(X), MAX_SAMPLE, replace=False)]
