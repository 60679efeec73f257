"""Smooth interpolation of the meter's response to a touch at any place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import NdBSpline, RegularGridInterpolator, make_interp_spline

from ...simulator.arrays import Real

DEGREE = 3
SLOPES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


@dataclass(frozen=True, eq=False)
class ResponseSurface:
    """Numbers in units of noise over x [mm], y [mm] and strength.

    knots: knots of each axis. coefficients: shape (x, y, strength, number). nodes: x and y of the
    skin's table, mm. skin: effect of the unknowns of the skin, per rise of strength above 1, shape
    (x, y, number, unknown). bounds: lowest and highest x, y and strength, shape (3, 2).
    """

    knots: tuple[NDArray, NDArray, NDArray]
    coefficients: Real
    nodes: tuple[NDArray, NDArray]
    skin: Real
    bounds: Real

    def values(self, theta: Real) -> Real:
        """Values at theta, shape (place, 3), as an array of shape (place, number)."""
        return self._at(theta, (0, 0, 0))

    def slopes(self, theta: Real) -> Real:
        """Exact derivatives, shape (place, number, 3)."""
        return np.stack([self._at(theta, nu) for nu in SLOPES], axis=-1)

    def skin_effects(self, theta: Real) -> Real:
        """Effects of the unknowns of the skin, shape (place, number, unknown)."""
        between = RegularGridInterpolator(self.nodes, self.skin)
        return between(theta[:, :2]) * (theta[:, 2] - 1)[:, None, None]

    def _at(self, theta: Real, nu: tuple[int, ...]) -> Real:
        return NdBSpline(self.knots, self.coefficients, DEGREE)(theta, nu=nu)


def response_surface(tables: Mapping[str, NDArray], noise: Real) -> ResponseSurface:
    """Interpolate the tables of `simulator.inversion` for positions."""
    x, y, strength = 1e3 * tables["x"], 1e3 * tables["y"], tables["strength_nodes"]
    coefficients, knots = tables["values"] / noise, []
    for axis, nodes in enumerate((x, y, strength)):
        spline = make_interp_spline(nodes, coefficients, DEGREE, axis=axis)
        knots.append(spline.t)
        coefficients = np.moveaxis(spline.c, 0, axis)
    middle = strength[len(strength) // 2]
    return ResponseSurface(
        knots=(knots[0], knots[1], knots[2]),
        coefficients=np.ascontiguousarray(coefficients),
        nodes=(x, y),
        skin=tables["skin"] / noise[:, None] / (middle - 1),
        bounds=np.array([nodes[[0, -1]] for nodes in (x, y, strength)]),
    )
