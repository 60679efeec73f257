"""Charges on the planes between layers by the potentials there: exact across each layer.

In a layer whose permittivity does not vary across it, potentials are sums of modes phi(x, y) with
K phi = lambda M phi, K and M weighted by the permittivity, times hyperbolic functions of
sqrt(lambda) z. The charge on a plane is M Phi g(lambda) Phi' M u, g the mode's admittance. In
uniform layers the modes are products of those along x and along y.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from .lines import Array, Line

EPS0 = 8.8541878128e-12
"""Permittivity of vacuum, F/m (CODATA 2018)."""

SHIFT = 1e-4
"""1/m², of all lambda while modes are sought: a constant, whose lambda is 0, may be one of them."""

Admittance = Callable[[Array], Array]
"""Of modes by lambda: charge for a potential of 1, over the permittivity."""


@dataclass(frozen=True)
class Outside:
    """What lies on one side of the skin: uniform slabs without end, then air or an earthed plane.

    slabs: thickness in m and relative permittivity of each, the nearest first. earthed: whether the
    last slab ends at an earthed plane; otherwise air follows.
    """

    slabs: tuple[tuple[float, float], ...] = ()
    earthed: bool = False

    def admittance(self, values: Array, air: float) -> Array:
        """Of modes, F/m² times m²; air: relative permittivity beyond the slabs."""
        root = np.sqrt(values)
        seen = np.full_like(root, np.inf) if self.earthed else EPS0 * air * root
        for thickness, permittivity in reversed(self.slabs):
            seen = _through(root, thickness, EPS0 * permittivity, seen)
        return seen


def body(distance: float, permittivity: float = 1.0) -> Outside:
    """An earthed plane at a distance, m."""
    return Outside(((distance, permittivity),), earthed=True)


def _through(root: Array, thickness: float, permittivity: float, beyond: Array) -> Array:
    """The admittance that is seen through a slab, as along a transmission line."""
    own, tanh = permittivity * root, np.tanh(root * thickness)
    with np.errstate(divide="ignore", invalid="ignore"):
        short = np.where(root * thickness > 1e-6, own / tanh, permittivity / thickness)
        matched = own * (beyond + own * tanh) / (own + beyond * tanh)
    open_or_load = np.where(root > 0, matched, 0.0)
    return np.where(np.isinf(beyond), short, open_or_load)


def across(values: Array, thickness: float) -> tuple[Array, Array]:
    """Own and mutual admittance of the two faces of a layer, 1/m."""
    by = np.sqrt(values) * thickness
    small = by < 1e-6
    safe = np.where(small, 1.0, np.minimum(by, 700.0))
    own = np.where(small, 1.0, safe / np.tanh(safe)) / thickness
    own = np.where(by > 700, np.sqrt(values), own)
    return own, -np.where(small, 1.0, safe / np.sinh(safe)) / thickness


def uniform(x: Line, y: Line, admittance: Admittance) -> Array:
    """Charges by potentials of all nodes of a plane, shape (node, node), y running fastest."""
    (along_x, X), (along_y, Y) = _modes(x), _modes(y)
    g = admittance(along_x[:, None] + along_y)
    pairs_y = np.einsum("ij,bj,dj->ibd", g, Y, Y, optimize=True)
    pairs_x = (X[:, None] * X).reshape(-1, len(along_x))
    size, other = len(X), len(Y)
    D = (pairs_x @ pairs_y.reshape(len(along_x), -1)).reshape(size, size, other, other)
    return np.ascontiguousarray(D.transpose(0, 2, 1, 3)).reshape(size * other, size * other)


def _modes(line: Line) -> tuple[Array, Array]:
    """lambda, shape (mode,), and M times the modes, shape (node, mode)."""
    return modes_of(line.K, line.M)


def modes_of(K: Array, M: Array) -> tuple[Array, Array]:
    """lambda of K phi = lambda M phi, shape (mode,), and M phi of modes of mass 1.

    Elements range over six decades in size. The pencil is inverted so that rounding spares the slow
    modes, on which everything depends, and not the fastest.
    """
    inverse, modes = eigh(M, K + SHIFT * M, driver="gvd", check_finite=False)
    inverse = np.maximum(inverse, np.finfo(float).eps * inverse[-1])
    return np.maximum(1 / inverse - SHIFT, 0.0), M @ (modes / np.sqrt(inverse))


@dataclass(frozen=True)
class Foam:
    """The modes of a layer with a block of foam within the sheet's bounds and air around it."""

    values: Array
    loaded: Array

    def charges(self, thickness: float) -> tuple[Array, Array]:
        """Own and mutual charges of both faces by the potentials there, shape (node, node)."""
        own, mutual = (
            self.loaded @ (each[:, None] * self.loaded.T) for each in across(self.values, thickness)
        )
        return own, mutual


def foam_modes(x: Line, y: Line, permittivity: float, air: float, middle: float = 1.0) -> Foam:
    """permittivity, air: relative, of the block and around it. middle: a factor on the permittivity
    in the middle cell of the sheet."""
    K = EPS0 * air * (np.kron(x.K, y.M) + np.kron(x.M, y.K))
    M = EPS0 * air * np.kron(x.M, y.M)
    more = EPS0 * (permittivity - air)
    K += more * (np.kron(x.K_inside, y.M_inside) + np.kron(x.M_inside, y.K_inside))
    M += more * np.kron(x.M_inside, y.M_inside)
    rise = EPS0 * permittivity * (middle - 1)
    K += rise * (np.kron(x.K_middle, y.M_middle) + np.kron(x.M_middle, y.K_middle))
    M += rise * np.kron(x.M_middle, y.M_middle)
    return Foam(*modes_of(K, M))
