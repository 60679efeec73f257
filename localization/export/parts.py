"""Parts of a trained localizer as plain arrays: one equation each, whatever trained it.

x is a row of the input, y the output. F: size of x, V: number of vectors, K: number of classes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Real


@dataclass(frozen=True, eq=False)
class AffineMap:
    """y = (x - centre) M + offset. matrix: M, shape (F, out), or (F,) of a diagonal M."""

    centre: Real
    matrix: Real
    offset: Real

    @classmethod
    def scaling(cls, centre: Real, scale: Real) -> AffineMap:
        """y = (x - centre) / scale."""
        return cls(centre, 1 / scale, np.zeros_like(centre))


@dataclass(frozen=True, eq=False)
class KernelSum:
    """y = sum over vectors v of k(x, v) w_v + offset, with k = exp(-gamma |x - v|²) - 1.

    The 1 is taken off, and its sum added to the offset, because single precision rounds small terms
    less. vectors: shape (V, F). weights: w, shape (V, out).
    """

    vectors: Real
    gamma: float
    weights: Real
    offset: Real


Decoding = Literal["hinge loss", "votes", "sum"]


@dataclass(frozen=True, eq=False)
class PairwiseSVMs:
    """Decisions of the SVMs of all pairs of classes.

    The score of class i against class j is S_ij = P_ij - P_ji + offset_ij, where P_ij is the sum of
    k(x, v) c_vj over the vectors v of class i, with k as in KernelSum. The decision of class i is

    - by hinge loss: minus the sum over j of max(0, 1 - S_ij), divided by 2 (K - 1);
    - by votes: the number of j with S_ij > 0, plus s / (3 |s| + 3) with s the sum of S_ij over j;
    - by sum: s / 2.

    vectors: shape (V, F), class by class. counts: number of vectors of each class, shape (K,).
    coefficients: c, shape (V, K), 0 against the own class. offset: shape (K, K), antisymmetric.
    """

    vectors: Real
    gamma: float
    counts: NDArray[np.intp]
    coefficients: Real
    offset: Real
    decoding: Decoding


@dataclass(frozen=True, eq=False)
class DenseLayers:
    """Layers y = max(0, x W + b), the last one without the maximum.

    weights: (W, b) of each layer, shapes (inputs, outputs) and (outputs,).
    """

    weights: tuple[tuple[Real, Real], ...]


@dataclass(frozen=True)
class LogProbabilities:
    """y = ln max(softmax(x), smallest)."""

    smallest: float


@dataclass(frozen=True, eq=False)
class BaselineCorrection:
    """Correction of changes by the opening baseline, see `DriftDirections.correction`.

    directions: orthonormal, shape (change, direction). noise: squared length.
    """

    directions: Real
    noise: float


@dataclass(frozen=True, eq=False)
class NormalDensities:
    """ln of the sum of density times share over the parts of each class, see `GaussianClassifier`.

    change, curve, absolute: indices of features. correction: None without `absolute`. turn: axes of
    changes, shape (change, c). known: map from the curve to its components z. pairs: two lists of
    components of z; the terms are 1, z and the products of these pairs. All that follows is
    whitened by the noise of each of P parts: whitening: shape (P, c, c), by_curve: (P, terms, c),
    curvature: (P, first terms, c). strength, constant: shape (P,). first: number of the first part
    of each class, ascending, shape (K,).
    """

    change: NDArray[np.intp]
    curve: NDArray[np.intp]
    absolute: NDArray[np.intp]
    correction: BaselineCorrection | None
    turn: Real
    known: AffineMap
    pairs: tuple[NDArray[np.intp], NDArray[np.intp]]
    whitening: Real
    by_curve: Real
    curvature: Real
    strength: Real
    constant: Real
    first: NDArray[np.intp]


Part = AffineMap | KernelSum | PairwiseSVMs | DenseLayers | LogProbabilities | NormalDensities


@dataclass(frozen=True, eq=False)
class KindDistance:
    """Distance from the nearest kind of press, over its limit: above 1 is novel, see `KindGuard`.

    u is the scaled row of the features in `columns`, p = u Dᵀ its components. The distance is the
    larger of min over k of |(p - mean_k) W_k| / limit and |u - p D| outside / limit.

    directions: D, orthonormal, shape (component, column). means: shape (k, component). whitening:
    W, shape (k, component, component).
    """

    columns: NDArray[np.intp]
    scaling: AffineMap
    directions: Real
    means: Real
    whitening: Real
    outside: float
    limit: float


@dataclass(frozen=True, eq=False)
class SeveralDistance:
    """exp of an SVM's decision for several touches, over its limit: above 1 is novel."""

    columns: NDArray[np.intp]
    scaling: AffineMap
    machine: KernelSum
    limit: float


Distance = KindDistance | SeveralDistance


@dataclass(frozen=True, eq=False)
class NearestErrors:
    """Standard deviations of positions: root of the mean squared errors at the nearest ones.

    places: scaled, shape (n, 3). squares: squared errors there, shape (n, 3). factor: of the root,
    shape (3,).
    """

    scaling: AffineMap
    places: Real
    squares: Real
    neighbours: int
    factor: Real
