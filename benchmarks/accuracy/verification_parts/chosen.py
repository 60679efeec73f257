"""Solutions chosen first, and the sources that make them true: nothing in them is constant.

div(S_i grad u_i) = s c (u_i - u_j) - f_i on the unit square, with one field or with two, S a number
or a tensor. One edge of each field is a foil at a constant potential; a given current enters
through the other three.
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

    def second_slopes(self, x: NDArray) -> NDArray:
        """d²u/dx², d²u/dy² and d²u/dxdy, shape (3, ...)."""
        wave = self.value(x) - self.offset
        mixed = np.cos(self.a * x[0] + self.p) * np.sin(self.b * x[1] + self.q)
        return np.stack(
            [-(self.a**2) * wave, -(self.b**2) * wave, -self.size * self.a * self.b * mixed]
        )


@dataclass(frozen=True)
class Resistance:
    """R = middle exp(growth . x), in ohm/sq."""

    middle: float
    growth: tuple[float, float]

    def conductance(self, x: NDArray) -> NDArray:
        """1/R in S."""
        return np.exp(-np.tensordot(self.growth, x, 1)) / self.middle

    def current(self, u: Potential, x: NDArray) -> NDArray:
        """grad u / R, shape (2, ...)."""
        return self.conductance(x) * u.gradient(x)

    def divergence(self, u: Potential, x: NDArray) -> NDArray:
        """div(grad u / R) = (laplacian u - growth . grad u) / R."""
        slanted = np.tensordot(self.growth, u.gradient(x), 1)
        return self.conductance(x) * (u.laplacian(x) - slanted)


@dataclass(frozen=True)
class Directed:
    """S = (cosh h + sinh h D(t)) / R of a resistance R, D(t) = [[cos t, sin t], [sin t, -cos t]].

    It conducts exp(2 h) times as well along the direction t/2 as across. That turns as t = turn
    sin(pi x) sin(pi y) does: along the edges nothing is askew, for where that is so at the ends of
    a foil its current meets a singularity.
    """

    resistance: Resistance
    half: float
    turn: float

    def conductance(self, x: NDArray) -> NDArray:
        """S by its xx, yy and xy, in S, shape (3, ...)."""
        even = np.cosh(self.half) * np.array([1.0, 1.0, 0.0]).reshape(3, *[1] * (np.ndim(x) - 1))
        return self.resistance.conductance(x) * (even + np.sinh(self.half) * self._direction(x))

    def current(self, u: Potential, x: NDArray) -> NDArray:
        """S grad u, shape (2, ...)."""
        return _times(self.conductance(x), u.gradient(x))

    def divergence(self, u: Potential, x: NDArray) -> NDArray:
        """div(S grad u) = S : grad grad u + (div S) . grad u."""
        S, slope, (xx, yy, xy) = self.conductance(x), u.gradient(x), u.second_slopes(x)
        bending = S[0] * xx + S[1] * yy + 2 * S[2] * xy
        fading = -np.tensordot(self.resistance.growth, _times(S, slope), 1)
        turning = (self._turning(x) * _times(self._turned(x), slope)).sum(axis=0)
        return bending + fading + turning

    def _angle(self, x: NDArray) -> NDArray:
        return self.turn * np.sin(np.pi * x[0]) * np.sin(np.pi * x[1])

    def _turning(self, x: NDArray) -> NDArray:
        """dt/dx and dt/dy."""
        a, b = np.pi * x
        return self.turn * np.pi * np.stack([np.cos(a) * np.sin(b), np.sin(a) * np.cos(b)])

    def _direction(self, x: NDArray) -> NDArray:
        t = self._angle(x)
        return np.stack([np.cos(t), -np.cos(t), np.sin(t)])

    def _turned(self, x: NDArray) -> NDArray:
        """dS/dt."""
        t = self._angle(x)
        turned = np.stack([-np.sin(t), np.sin(t), np.cos(t)])
        return self.resistance.conductance(x) * np.sinh(self.half) * turned


def _times(S: NDArray, v: NDArray) -> NDArray:
    """S v of a symmetric tensor by its xx, yy and xy."""
    return np.stack([S[0] * v[0] + S[2] * v[1], S[2] * v[0] + S[1] * v[1]])


def capacitance(x: NDArray) -> NDArray:
    """c in F/m²: 1 in the middle, from half to one and a half."""
    return 1.0 + 0.5 * np.sin(3.0 * x[0] + 2.0 * x[1])


@dataclass(frozen=True)
class Problem:
    """What is chosen. foils: the axis, of x = 0 or y = 0, that each field's foil lies across.

    coupling: how s c enters between fields. s: rad/s.
    """

    potentials: tuple[Potential, ...]
    sheets: tuple[Resistance | Directed, ...]
    foils: tuple[int, ...]
    coupling: NDArray[np.float64]
    s: complex

    def source(self, field: int, x: NDArray) -> NDArray:
        """f = -div(S grad u) + s c (u of this field less that of the other)."""
        across = sum(
            weight * u.value(x)
            for weight, u in zip(self.coupling[field], self.potentials, strict=True)
        )
        out = self.sheets[field].divergence(self.potentials[field], x)
        return self.s * capacitance(x) * across - out

    def normal_current(self, field: int, x: NDArray, normal: NDArray) -> NDArray:
        """What enters an edge, A/m: n . S grad u."""
        return (normal * self.sheets[field].current(self.potentials[field], x)).sum(axis=0)

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
ALONG, ASKEW = Directed(UPPER, 0.8, 2.0), Directed(LOWER, -0.5, -1.5)
BOTH = np.array([[1.0, -1.0], [-1.0, 1.0]])
PROBLEMS = {
    "one field": Problem((TOP,), (UPPER,), (0,), np.ones((1, 1)), 0.5 + 8j),
    "two fields": Problem((TOP, BOTTOM), (UPPER, LOWER), (0, 1), BOTH, 0.5 + 8j),
    "one field, tensor": Problem((TOP,), (ALONG,), (0,), np.ones((1, 1)), 0.5 + 8j),
    "two fields, tensors": Problem((TOP, BOTTOM), (ALONG, ASKEW), (0, 1), BOTH, 0.5 + 8j),
}
