"""The skin as a membrane on an elastic foundation, in finite elements of high order."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix, diags_array
from skfem import Basis, BilinearForm, ElementTriP1, ElementTriP4, LinearForm, MeshTri
from skfem.models.poisson import laplace

from simulator.elastic_foam import Elastic

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
