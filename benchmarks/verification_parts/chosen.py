"""Solutions chosen first, and the sources that make them true: nothing in them is constant.

div(grad u_i / R_i) = s c (u_i - u_j) - f_i on the unit square, with one field or with two. One edge
of each field is a foil at a constant potential; a given current enters through the other three.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Potential:
    """u = offset + size sin(a x + p) cos(b y + q), in V."""

    offset: float
    size: complex
    a: float
    b: float
    p: float = 0.0
    q: float = 0.0

    def value(self, x: NDArray) -> NDArray:
        """u; x: shape (2, ...)."""
        wave = np.sin(self.a * x[0] + self.p) * np.cos(self.b * x[1] + self.q)
        return self.offset + self.size * wave

    def gradient(self, x: NDArray) -> NDArray:
        """du/dx and du/dy, shape (2, ...)."""
        along, across = self.a * x[0] + self.p, self.b * x[1] + self.q
        slopes = self.a * np.cos(along) * np.cos(across), -self.b * np.sin(along) * np.sin(across)
        return self.size * np.stack(slopes)

    def laplacian(self, x: NDArray) -> NDArray:
        """d²u/dx² + d²u/dy²."""
        return -(self.a**2 + self.b**2) * (self.value(x) - self.offset)


@dataclass(frozen=True)
class Resistance:
    """R = middle exp(growth . x), in ohm/sq."""

    middle: float
    growth: tuple[float, float]

    def conductance(self, x: NDArray) -> NDArray:
        """1/R in S."""
        return np.exp(-np.tensordot(self.growth, x, 1)) / self.middle

    def divergence(self, u: Potential, x: NDArray) -> NDArray:
        """div(grad u / R) = (laplacian u - growth . grad u) / R."""
        slanted = np.tensordot(self.growth, u.gradient(x), 1)
        return self.conductance(x) * (u.laplacian(x) - slanted)


def capacitance(x: NDArray) -> NDArray:
    """c in F/m²: 1 in the middle, from half to one and a half."""
    return 1.0 + 0.5 * np.sin(3.0 * x[0] + 2.0 * x[1])


@dataclass(frozen=True)
class Problem:
    """What is chosen. foils: the axis, of x = 0 or y = 0, that each field's foil lies across.

    coupling: how s c enters between fields. s: rad/s.
    """

    potentials: tuple[Potential, ...]
    sheets: tuple[Resistance, ...]
    foils: tuple[int, ...]
    coupling: NDArray[np.float64]
    s: complex

    def source(self, field: int, x: NDArray) -> NDArray:
        """f = -div(grad u / R) + s c (u of this field less that of the other)."""
        across = sum(
            weight * u.value(x)
            for weight, u in zip(self.coupling[field], self.potentials, strict=True)
        )
        out = self.sheets[field].divergence(self.potentials[field], x)
        return self.s * capacitance(x) * across - out

    def normal_current(self, field: int, x: NDArray, normal: NDArray) -> NDArray:
        """What enters an edge, A/m: n . grad u / R."""
        slope = (normal * self.potentials[field].gradient(x)).sum(axis=0)
        return self.sheets[field].conductance(x) * slope

    def foil_current(self) -> complex:
        """What enters through the first field's foil, in A."""
        nodes, weights = np.polynomial.legendre.leggauss(40)
        x = np.zeros((2, len(nodes)))
        x[1 - self.foils[0]] = (nodes + 1) / 2
        normal = -np.eye(2)[:, [self.foils[0]]]
        return complex(self.normal_current(0, x, normal) @ weights / 2)


TOP = Potential(1.0, 0.6 + 0.4j, 4.2, 3.4, q=0.3)
BOTTOM = Potential(0.0, -0.5 + 0.7j, 3.1, 4.4, p=0.4, q=-np.pi / 2)
UPPER, LOWER = Resistance(0.8, (0.9, -0.6)), Resistance(1.7, (-0.5, 0.8))
PROBLEMS = {
    "one field": Problem((TOP,), (UPPER,), (0,), np.ones((1, 1)), 0.5 + 8j),
    "two fields": Problem(
        (TOP, BOTTOM), (UPPER, LOWER), (0, 1), np.array([[1.0, -1.0], [-1.0, 1.0]]), 0.5 + 8j
    ),
}
