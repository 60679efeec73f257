"""The electrode skins as a membrane on foam: matrices, the tail beyond, and its surface."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix, diags_array
from scipy.spatial import KDTree
from skfem import (
    Basis,
    BilinearForm,
    ElementH1,
    ElementTriP1,
    ElementTriP3,
    ElementTriP4,
    LinearForm,
    MeshTri,
)
from skfem.models.poisson import laplace

from ...scene.foam_mechanics import Elastic

ELEMENT = ElementTriP4()
EXACT = 8
"""Order up to which polynomials are integrated exactly: squares of the element's."""


class Membrane:
    """Deflection w [m] of both skins under the tension T [N/m] of the two, on foam of thickness d.

    The energy is the integral of T |grad w|² / 2 + d W(w/d), W that of the foam per volume; its
    derivative div(T grad w) = p(w/d) [Pa] holds where nothing touches, and free edges are free.
    """

    def __init__(self, mesh: MeshTri, tension: float, thickness: float, elastic: Elastic) -> None:
        self.thickness, self.elastic = thickness, elastic
        self.basis = Basis(mesh, ELEMENT, intorder=EXACT)
        self.stretch = (tension * laplace.assemble(self.basis)).tocsr()

    @property
    def nodes(self) -> NDArray[np.int64]:
        """(node of the element, triangle): their numbers."""
        return np.asarray(self.basis.element_dofs)

    @property
    def places(self) -> NDArray[np.float64]:
        """(2, node) in m."""
        return np.asarray(self.basis.doflocs)

    def residual(self, w: NDArray[np.float64]) -> NDArray[np.float64]:
        """What holds each node in place, N, shape (node,)."""
        pressure = self.elastic.stress(self._strain(w))
        return self.stretch @ w + _load.assemble(self.basis, pressure=pressure)

    def tangent(self, w: NDArray[np.float64]) -> csr_matrix:
        """d residual / d w, N/m, shape (node, node)."""
        stiffness = self.elastic.stiffness(self._strain(w)) / self.thickness
        return (self.stretch + _foundation.assemble(self.basis, stiffness=stiffness)).tocsr()

    def energy(self, w: NDArray[np.float64]) -> float:
        """J."""
        compressed = np.sum(self.elastic.energy(self._strain(w)) * self.basis.dx)
        return float(w @ (self.stretch @ w) / 2 + self.thickness * compressed)

    def _strain(self, w: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(self.basis.interpolate(w)) / self.thickness


class Net:
    """The same in first order between all nodes of a membrane, foam and skins lumped at them.

    Its matrices make a discrete maximum principle, so that nodes leave and meet applicators by the
    signs of what holds them.
    """

    def __init__(self, membrane: Membrane, tension: float) -> None:
        self.thickness, self.elastic = membrane.thickness, membrane.elastic
        basis = Basis(MeshTri(membrane.places, _split(membrane.nodes)), ElementTriP1())
        self.stretch = (tension * laplace.assemble(basis)).tocsr()
        self.area = _load.assemble(basis, pressure=np.ones_like(basis.dx))

    def residual(self, w: NDArray[np.float64]) -> NDArray[np.float64]:
        """As of the membrane."""
        return self.stretch @ w + self.area * self.elastic.stress(w / self.thickness)

    def tangent(self, w: NDArray[np.float64]) -> csr_matrix:
        """As of the membrane."""
        stiffness = self.elastic.stiffness(w / self.thickness) / self.thickness
        return (self.stretch + diags_array(self.area * stiffness)).tocsr()

    def energy(self, w: NDArray[np.float64]) -> float:
        """As of the membrane."""
        compressed = self.area @ self.elastic.energy(w / self.thickness)
        return float(w @ (self.stretch @ w) / 2 + self.thickness * compressed)


def _split(nodes: NDArray[np.int64]) -> NDArray[np.int64]:
    """Triangles (3, part) between all nodes of triangles, which lie on a lattice."""
    order = 4
    lattice = np.rint(order * ELEMENT.doflocs).astype(int)
    number = {(i, j): node for node, (i, j) in enumerate(lattice)}
    corners = [(i, j) for i in range(order) for j in range(order - i)]
    upright = [((i, j), (i + 1, j), (i, j + 1)) for i, j in corners]
    turned = [((i + 1, j), (i + 1, j + 1), (i, j + 1)) for i, j in corners if i + j < order - 1]
    parts = [[nodes[number[corner]] for corner in part] for part in upright + turned]
    return np.concatenate(parts, axis=1)


@LinearForm
def _load(v, w):
    return w.pressure * v


@BilinearForm
def _foundation(u, v, w):
    return w.stiffness * u * v


LOWER = ElementTriP3()


def tails(membrane: Membrane, w: NDArray[np.float64]) -> NDArray[np.float64]:
    """Largest distance in m of w from what one order less makes of it, shape (triangle,)."""
    return np.abs(_TAIL @ w[membrane.nodes]).max(axis=0)


def _tail() -> NDArray[np.float64]:
    """Values at the element's nodes less those of the lower element through its own."""
    shapes = range(len(ELEMENT.doflocs)), range(len(LOWER.doflocs))
    at_lower = np.array([ELEMENT.lbasis(LOWER.doflocs.T, k)[0] for k in shapes[0]]).T
    back = np.array([LOWER.lbasis(ELEMENT.doflocs.T, k)[0] for k in shapes[1]]).T
    return np.eye(len(ELEMENT.doflocs)) - back @ at_lower


_TAIL = _tail()

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
