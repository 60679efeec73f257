"""Parts of a trained localizer: one equation each, whatever trained it.

x is a row of the input, y the output. F: size of x, V: number of vectors, K: number of classes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import expit

from ...simulator.arrays import Real
from .plain import Plain, Sizes, require, require_orthonormal

AT_ONCE = 2**24
"""Approximate number of kernel values in memory at once."""


class Part(Plain):
    """One step of a localizer."""

    @property
    def sizes(self) -> tuple[int | None, int | None]:
        """Sizes of input and output; None for any, and for the same as the input."""
        raise NotImplementedError

    def __call__(self, x: Real) -> Real:
        """The output of each row. x: shape (n, F). Returns shape (n, out)."""
        raise NotImplementedError


@dataclass(frozen=True, eq=False)
class Scaling(Part):
    """y = (x - centre) / scale."""

    centre: Annotated[Real, "F"]
    scale: Annotated[Real, "F >0"]

    @property
    def sizes(self) -> tuple[int | None, int | None]:
        return self.centre.size, self.centre.size

    def __call__(self, x: Real) -> Real:
        return (x - self.centre) / self.scale

    @property
    def back(self) -> Scaling:
        """The inverse: x = scale y + centre."""
        return Scaling(-self.centre / self.scale, 1 / self.scale)


@dataclass(frozen=True, eq=False)
class Components(Part):
    """y = (x - mean) D' / scale. directions: D, orthonormal, shape (component, F)."""

    mean: Annotated[Real, "F"]
    directions: Annotated[Real, "out F"]
    scale: Annotated[float, ">0"]

    def _check(self, sizes: Sizes) -> None:
        require_orthonormal(self.directions, "directions")

    @property
    def sizes(self) -> tuple[int | None, int | None]:
        return self.mean.size, len(self.directions)

    def __call__(self, x: Real) -> Real:
        return (x @ self.directions.T - self.mean[None] @ self.directions.T) / self.scale


@dataclass(frozen=True, eq=False)
class AffineMap(Part):
    """y = (x - centre) M + offset. matrix: M, shape (F, out)."""

    centre: Annotated[Real, "F"]
    matrix: Annotated[Real, "F out"]
    offset: Annotated[Real, "out"]

    @property
    def sizes(self) -> tuple[int | None, int | None]:
        return self.centre.size, self.offset.size

    def __call__(self, x: Real) -> Real:
        return (x - self.centre) @ self.matrix + self.offset


@dataclass(frozen=True, eq=False)
class KernelSum(Part):
    """y = sum over vectors v of k(x, v) w_v + offset, with k = exp(-gamma |x - v|²).

    vectors: shape (V, F). weights: w, shape (V, out).
    """

    vectors: Annotated[Real, "V F"]
    gamma: Annotated[float, ">0"]
    weights: Annotated[Real, "V out"]
    offset: Annotated[Real, "out"]

    @property
    def sizes(self) -> tuple[int | None, int | None]:
        return self.vectors.shape[1], self.offset.size

    def __call__(self, x: Real) -> Real:
        found = np.empty((len(x), self.offset.size))
        for rows in _in_turn(len(x), len(self.vectors)):
            found[rows] = kernel(x[rows], self.vectors, self.gamma) @ self.weights + self.offset
        return found


Decoding = Literal["hinge loss", "votes", "sum"]


@dataclass(frozen=True, eq=False)
class PairwiseSVMs(Part):
    """Decisions of the SVMs of all pairs of classes.

    The score of class i against class j is S_ij = P_ij - P_ji + offset_ij, where P_ij is the sum of
    k(x, v) c_vj over the vectors v of class i, with k as in KernelSum. The decision of class i is

    - by hinge loss: minus the sum over j of max(0, 1 - S_ij), divided by 2 (K - 1): S. Escalera,
      O. Pujol, P. Radeva, IEEE Trans. Pattern Anal. Mach. Intell. 32 (2010) 120-134, loss-weighted
      decoding, by which MATLAB's `fitcecoc` decodes SVMs of pairs;
    - by votes: the number of j with S_ij > 0, plus s / (3 |s| + 3) with s the sum of S_ij over j;
    - by sum: s / 2.

    vectors: shape (V, F), class by class. counts: number of vectors of each class, shape (K,).
    coefficients: c, shape (V, K), 0 against the own class. offset: shape (K, K), antisymmetric.
    """

    vectors: Annotated[Real, "V F"]
    gamma: Annotated[float, ">0"]
    counts: Annotated[NDArray[np.intp], "K int"]
    coefficients: Annotated[Real, "V K"]
    offset: Annotated[Real, "K K"]
    decoding: Decoding

    def _check(self, sizes: Sizes) -> None:
        counts = self.counts
        require((counts >= 0).all() and counts.sum() == sizes["V"], "counts", "must count vectors")
        own = self.coefficients[np.arange(sizes["V"]), np.repeat(np.arange(sizes["K"]), counts)]
        require(not own.any(), "coefficients", "must be 0 against the own class")
        require(sizes["K"] > 1, "counts", "must be of two classes or more")
        require(np.array_equal(self.offset, -self.offset.T), "offset", "must be antisymmetric")

    @property
    def sizes(self) -> tuple[int | None, int | None]:
        return self.vectors.shape[1], self.counts.size

    def __call__(self, x: Real) -> Real:
        found = np.empty((len(x), self.counts.size))
        for rows in _in_turn(len(x), max(len(self.vectors), self.offset.size)):
            found[rows] = self._decoded(self.scores(x[rows]))
        return found

    def scores(self, x: Real) -> Real:
        """S of each row, shape (n, K, K)."""
        values = kernel(x, self.vectors, self.gamma)
        ends = np.cumsum([0, *self.counts])
        P = np.stack(
            [
                values[:, a:b] @ self.coefficients[a:b]
                for a, b in zip(ends[:-1], ends[1:], strict=True)
            ],
            axis=1,
        )
        return P - P.swapaxes(1, 2) + self.offset

    def _decoded(self, S: Real) -> Real:
        K = self.counts.size
        total = S.sum(axis=2)
        if self.decoding == "sum":
            return total / 2
        if self.decoding == "votes":
            return (S > 0).sum(axis=2) + total / (3 * np.abs(total) + 3)
        others = ~np.eye(K, dtype=bool)
        losses = (np.maximum(0, 1 - S) * others).sum(axis=2) / (2 * (K - 1))
        return -losses if K > 2 else centred(-losses)


@dataclass(frozen=True, eq=False)
class Layer(Plain):
    """x W + b. weights: W, shape (inputs, outputs). offset: b, shape (outputs,)."""

    weights: Annotated[Real, "F out"]
    offset: Annotated[Real, "out"]


@dataclass(frozen=True, eq=False)
class DenseLayers(Part):
    """Layers y = max(0, x W + b), the last one without the maximum, in single precision."""

    layers: tuple[Layer, ...]

    def _check(self, sizes: Sizes) -> None:
        require(self.layers, "layers", "must be one or more")
        for k, (one, other) in enumerate(zip(self.layers, self.layers[1:], strict=False)):
            fits = one.offset.size == len(other.weights)
            require(fits, f"layers.{k + 1}", "does not fit the layer before it")

    @property
    def sizes(self) -> tuple[int | None, int | None]:
        return len(self.layers[0].weights), self.layers[-1].offset.size

    def __call__(self, x: Real) -> Real:
        y = np.asarray(x, np.float32)
        *hidden, last = self.layers
        for layer in hidden:
            y = np.maximum(y @ layer.weights + layer.offset, 0)
        return y @ last.weights + last.offset


@dataclass(frozen=True)
class LogProbabilities(Part):
    """y = ln max(p, smallest), with p the softmax of x.

    A single number x is the ln of the odds of the second of two classes.
    """

    smallest: Annotated[float, ">0"]

    @property
    def sizes(self) -> tuple[int | None, int | None]:
        return None, None

    def __call__(self, x: Real) -> Real:
        """1 - p in single precision would round the smaller probability of two to 6e-8."""
        if x.shape[1] == 1:
            p = expit(np.hstack([-x, x]))
        else:
            p = np.exp(x - x.max(axis=1, keepdims=True))
            p /= p.sum(axis=1, keepdims=True)
        return np.log(np.maximum(p, self.smallest))


@dataclass(frozen=True, eq=False)
class NearestErrors(Plain):
    """Variances of positions: the mean of the squared errors at the nearest of known places.

    places: scaled, shape (n, 3). squares: squared errors there, shape (n, 3).
    """

    scaling: Scaling
    places: Annotated[Real, "n 3"]
    squares: Annotated[Real, "n 3 >=0"]
    neighbours: Annotated[int, ">0"]

    def _check(self, sizes: Sizes) -> None:
        require(self.scaling.centre.size == 3, "scaling", "must be of 3 numbers")
        require(self.neighbours <= sizes["n"], "neighbours", f"must be at most {sizes['n']}")

    def __call__(self, positions: Real) -> Real:
        """Variances of positions, both of shape (n, 3)."""
        found = np.empty(positions.shape)
        for rows in _in_turn(len(positions), len(self.places)):
            away = squared_distances(self.scaling(positions[rows]), self.places)
            nearest = np.argpartition(away, self.neighbours - 1, axis=1)[:, : self.neighbours]
            found[rows] = self.squares[nearest].mean(axis=1)
        return found


def centred(decisions: Real) -> Real:
    """Decisions for two classes, of sum 0; shape (n, 2)."""
    half = (decisions[:, 1] - decisions[:, 0]) / 2
    return np.column_stack([-half, half])


def kernel(x: Real, vectors: Real, gamma: float) -> Real:
    """exp(-gamma |x - v|²) of each row and vector, shape (n, V)."""
    return np.exp(-gamma * squared_distances(x, vectors))


def squared_distances(x: Real, vectors: Real) -> Real:
    """|x - v|² of each row and vector, from their differences, shape (n, V)."""
    from scipy.spatial.distance import cdist

    return np.asarray(cdist(x, vectors, "sqeuclidean"), np.float64)


def _in_turn(rows: int, vectors: int) -> list[slice]:
    """Slices of rows, each of about AT_ONCE kernel values."""
    step = max(1, AT_ONCE // max(vectors, 1))
    return [slice(k, k + step) for k in range(0, rows, step)]
