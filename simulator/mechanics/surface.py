"""A deflection of the skin that can be asked for anywhere."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree
from skfem import ElementH1

FIRST_LOOK, LAST_LOOK = 4, 256
INSIDE = -1e-9


class Surface:
    """w [m] between the nodes of an element's triangles.

    p: (2, point) m; nodes: (node of the element, triangle), its corners first.
    """

    def __init__(
        self,
        element: ElementH1,
        p: NDArray[np.float64],
        nodes: NDArray[np.int64],
        w: NDArray[np.float64],
    ) -> None:
        self.element, self.nodes, self.w = element, nodes, w
        corners = p[:, nodes[:3]]
        self.origin = corners[:, 0]
        sides = np.moveaxis(corners[:, 1:] - self.origin[:, None], 2, 0)
        self.inverse = np.linalg.inv(sides)
        self.tree = KDTree(corners.mean(axis=1).T)

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """At flat positions x (2, ...) in m; beside the skin as at its nearest triangle."""
        flat = np.reshape(x, (2, -1))
        triangle, at = self._located(flat)
        found = np.zeros(len(triangle))
        for k, node in enumerate(self.nodes):
            found += self.element.lbasis(at, k)[0] * self.w[node[triangle]]
        return np.reshape(found, x.shape[1:])

    def in_triangles(
        self, values: NDArray[np.float64]
    ) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
        """What is even in each triangle, shape (triangle,), at positions as of w."""

        def at(x: NDArray[np.float64]) -> NDArray[np.float64]:
            triangle, _ = self._located(np.reshape(x, (2, -1)))
            return np.reshape(values[triangle], x.shape[1:])

        return at

    def _located(self, x: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """The triangle (point,) that each point lies in, and where in it (2, point)."""
        triangle = np.zeros(x.shape[1], np.int64)
        missing, look = np.arange(x.shape[1]), FIRST_LOOK
        while missing.size:
            near = self.tree.query(x[:, missing].T, k=min(look, len(self.origin.T)))[1]
            near = near.reshape(len(missing), -1).T
            least = self._barycentric(x[:, None, missing], near).min(axis=0)
            best = least.argmax(axis=0), np.arange(len(missing))
            triangle[missing] = near[best]
            settled = (least[best] >= INSIDE) | (look >= LAST_LOOK)
            missing, look = missing[~settled], 4 * look
        inside = np.clip(self._barycentric(x, triangle), 0, 1)
        return triangle, (inside / inside.sum(axis=0))[1:]

    def _barycentric(
        self, x: NDArray[np.float64], triangle: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        away = x - self.origin[:, triangle]
        along = np.einsum("...ij,j...->i...", self.inverse[triangle], away)
        return np.stack([1 - along.sum(axis=0), *along])
