"""The cells of a mesh divided into small flat parts, and potentials at their corners."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...arrays import Integer, Real
from ...fem.quadrature import interpolated, rule_at
from ...scene.parts import Skin
from .discretised import Discretised
from .materials import position

FEW_CELLS = 12_000
MAX_SAMPLING_PARTS = 8
INWARD = 0.01
"""Relative shift towards the middle of a cell for gradients. Where a circle touches a line, a cell
has no width at its corner, and no gradient there."""
CORNERS = ((0, 0), (0, 1), (1, 1), (1, 0))


class Sampler:
    """The cells of a discretised press, divided into about the same number of parts on any mesh.

    surface: geometry at the corners of parts, of shapes (..., cell, corner); corners on edges
    appear once for each adjacent cell. parts: numbers of corners, counted over all cells, shape (3
    or 4, part).
    """

    def __init__(self, skin: Skin, discretised: Discretised) -> None:
        self._discretised, self._elements = discretised, discretised.fine.elements
        sides = len(np.asarray(self._elements.element.refdom.p).T)
        cut = round((FEW_CELLS / self._elements.cells) ** 0.5)
        corners, parts = lattice(sides, min(max(cut, 1), MAX_SAMPLING_PARTS))
        self._skin = skin
        middle = corners.mean(axis=1, keepdims=True)
        within = corners + INWARD * (middle - corners)
        self._at, self._within = (
            rule_at(self._elements.element, points, np.zeros(points.shape[1]))
            for points in (corners, within)
        )
        self.surface = self._elements.surface_at(self._at, slice(None))
        first = corners.shape[1] * np.arange(self._elements.cells)
        self.parts = (parts[:, None, :] + first[:, None]).reshape(sides, -1)

    @property
    def position(self) -> Real:
        """Positions of the corners in space, m, shape (3, cell, corner)."""
        if self._elements.in_space is None:
            return position(self._skin, self.surface.x)
        origin, along, across = self._elements.in_space
        a, b = self._at.points
        return origin + a * along + b * across

    def along_x_and_y(self, vectors: NDArray) -> NDArray:
        """Components of vectors along x and y, of shape (..., 2, cell, corner).

        On a mesh in space they are given in each cell's own frame.
        """
        if self._elements.in_space is None:
            return vectors
        _, *edges = self._elements.in_space
        own = np.stack([self.surface.along, self.surface.across]).transpose(2, 3, 1, 0)
        projected = np.stack(edges)[:, :2].transpose(2, 3, 1, 0)
        return np.einsum("cpij,...jcp->...icp", projected @ np.linalg.inv(own), vectors)

    def sampled(self, excitation: int, s: complex, air: complex) -> tuple[NDArray, NDArray]:
        """Potential in V, shape (field, cell, corner), and gradient in V/m, (field, 2, cell,
        corner).

        For one excitation. s: rad/s. air: factor on the capacitance in air.
        """
        fields = self._discretised.coefficients_of(self._discretised.fine, excitation, s, air)
        inner = self._elements.surface_at(self._within, slice(None))
        slopes = [interpolated(self._within, inner, u)[1] for u in fields]
        return np.stack([u.T @ self._at.values for u in fields]), np.stack(slopes)


def lattice(sides: int, cut: int) -> tuple[Real, Integer]:
    """A unit triangle or square with each side divided into `cut` parts: corners and parts.

    Corners (a, b) of shape (2, corner), parts of shape (sides, part), counter-clockwise.
    """
    steps = np.arange(cut + 1)
    j, i = (each.ravel() for each in np.meshgrid(steps, steps, indexing="ij"))
    within = i + j <= (cut if sides == 3 else 2 * cut)
    number = np.full((cut + 1, cut + 1), -1)
    number[j[within], i[within]] = np.arange(within.sum())
    a, b, c, d = (number[p : p + cut, q : q + cut].ravel() for p, q in CORNERS)
    if sides == 4:
        parts = [np.stack([a, b, c, d])]
    else:
        halves = np.stack([a, b, d]), np.stack([b, c, d])
        parts = [each[:, (each >= 0).all(axis=0)] for each in halves]
    return np.stack([i[within], j[within]]) / cut, np.concatenate(parts, axis=1)
