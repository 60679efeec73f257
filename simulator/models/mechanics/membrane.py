"""The electrode skins as a membrane on foam: matrices, error indicator, and interpolation."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from copy import copy

import numpy as np
from scipy.sparse import csr_matrix, diags_array
from skfem import (
    Basis,
    ElementH1,
    ElementTriP1,
    ElementTriP3,
    ElementTriP4,
    LinearForm,
    MeshTri,
)
from skfem.assembly import Dofs
from skfem.models.poisson import laplace
from skfem.quadrature import get_quadrature

from ...arrays import Integer, Real
from ...fem.assembly import pattern_of_pairs
from ...scene.foam_mechanics import Elastic

ELEMENT = ElementTriP4()
EXACT = 8
"""Order up to which polynomials are integrated exactly: squares of the element's."""


class Membrane:
    """Deflection w [m] of both skins under the tension T [N/m] of the two, on foam of thickness d.

    The energy is the integral of T |grad w|² / 2 + d W(w/d), W that of the foam per volume; its
    derivative div(T grad w) = p(w/d) [Pa] holds where no applicator touches; edges are free.
    """

    def __init__(self, mesh: MeshTri, tension: float, thickness: float, elastic: Elastic) -> None:
        self.thickness, self.elastic = thickness, elastic
        dofs = Dofs(mesh, ELEMENT)
        self.nodes: Integer = np.asarray(dofs.element_dofs, dtype=np.int64)
        corners = mesh.p[:, mesh.t]
        origin, along, across = corners[:, 0], corners[:, 1], corners[:, 2]
        along, across = along - origin, across - origin
        self.places = np.empty((2, int(dofs.N)))
        for node, (a, b) in zip(self.nodes, ELEMENT.doflocs, strict=True):
            self.places[:, node] = origin + a * along + b * across
        points, weights = get_quadrature(ELEMENT, EXACT)
        values, slopes = zip(
            *(ELEMENT.lbasis(points, k) for k in range(len(ELEMENT.doflocs))), strict=True
        )
        area = np.abs(along[0] * across[1] - along[1] * across[0])
        self._values, self._dx = np.array(values), area[:, None] * weights
        self._products = np.einsum("ip,jp->pij", self._values, self._values).reshape(
            len(weights), -1
        )
        self._pattern = _Pattern(self.nodes, int(dofs.N))
        metric = np.stack([across * across, -along * across, along * along]).sum(axis=1) / area
        stretches = np.einsum("iap,jbp,p->abij", *2 * [np.array(slopes)], weights)
        both = stretches[0, 1] + stretches[1, 0]
        terms = np.stack([stretches[0, 0], both, stretches[1, 1]]).reshape(3, -1)
        self._stretch = tension * self._pattern.values(metric.T @ terms)
        self.stretch = self._pattern.matrix(self._stretch)

    def residual(self, w: Real) -> Real:
        """Force that clamps each node, N, shape (node,)."""
        pressed = (self.elastic.stress(self._strain(w)) * self._dx) @ self._values.T
        load = np.bincount(self.nodes.T.ravel(), pressed.ravel(), self.places.shape[1])
        return np.asarray(self.stretch @ w + load, dtype=np.float64)

    def tangent(self, w: Real) -> csr_matrix:
        """Derivative of the residual by w, N/m, shape (node, node)."""
        stiffness = self.elastic.stiffness(self._strain(w)) / self.thickness
        foundation = self._pattern.values((stiffness * self._dx) @ self._products)
        return self._pattern.matrix(self._stretch + foundation)

    def energy(self, w: Real) -> float:
        """Elastic energy, J."""
        compressed = np.sum(self.elastic.energy(self._strain(w)) * self._dx)
        return float(w @ (self.stretch @ w) / 2 + self.thickness * compressed)

    def _strain(self, w: Real) -> Real:
        """Strain at points of the rule, shape (triangle, point)."""
        return w[self.nodes].T @ self._values / self.thickness


class _Pattern:
    """Sparsity pattern of matrices of triangles with common nodes."""

    def __init__(self, nodes: Integer, count: int) -> None:
        """nodes: (node of the element, triangle). count: number of nodes."""
        own, count_of = nodes.T, len(nodes)
        rows, columns = np.repeat(own, count_of, axis=1), np.tile(own, count_of)
        self._pattern, slots = pattern_of_pairs(columns, rows, count)
        self._slot = slots.ravel()

    def values(self, matrices: Real) -> Real:
        """Sum of the matrices of triangles, shape (triangle, node * node), in the pattern."""
        found = np.bincount(self._slot, matrices.ravel(), len(self._pattern.indices))
        return np.asarray(found, dtype=np.float64)

    def matrix(self, values: Real) -> csr_matrix:
        """Sparse matrix with these values, shape (node, node)."""
        size, pattern = self._pattern.size, self._pattern
        return csr_matrix((values, pattern.indices, pattern.indptr), shape=(size, size))


class LumpedMembrane:
    """Membrane of first order between all nodes, with foam and skins lumped at them.

    Its matrices have a discrete maximum principle, so the signs of the clamping forces show which
    nodes lose and gain contact.
    """

    def __init__(self, membrane: Membrane, tension: float) -> None:
        self.thickness, self.elastic = membrane.thickness, membrane.elastic
        basis = Basis(MeshTri(membrane.places, _split(membrane.nodes)), ElementTriP1())
        self.stretch = (tension * laplace.assemble(basis)).tocsr()
        self.area = _load.assemble(basis, pressure=np.ones_like(basis.dx))

    def residual(self, w: Real) -> Real:
        """Force that clamps each node; see `Membrane`."""
        return self.stretch @ w + self.area * self.elastic.stress(w / self.thickness)

    def tangent(self, w: Real) -> csr_matrix:
        """Derivative of the residual; see `Membrane`."""
        stiffness = self.elastic.stiffness(w / self.thickness) / self.thickness
        return (self.stretch + diags_array(self.area * stiffness)).tocsr()

    def energy(self, w: Real) -> float:
        """Elastic energy; see `Membrane`."""
        compressed = self.area @ self.elastic.energy(w / self.thickness)
        return float(w @ (self.stretch @ w) / 2 + self.thickness * compressed)


def _split(nodes: Integer) -> Integer:
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


LOWER = ElementTriP3()


def tails(membrane: Membrane, w: Real) -> Real:
    """Largest difference in m of w from its interpolation of one order less, shape (triangle,)."""
    return np.abs(_TAIL @ w[membrane.nodes]).max(axis=0)


def _tail() -> Real:
    """Identity less interpolation by the lower element, as a matrix between the element's nodes."""
    shapes = range(len(ELEMENT.doflocs)), range(len(LOWER.doflocs))
    at_lower = np.array([ELEMENT.lbasis(LOWER.doflocs.T, k)[0] for k in shapes[0]]).T
    back = np.array([LOWER.lbasis(ELEMENT.doflocs.T, k)[0] for k in shapes[1]]).T
    return np.eye(len(ELEMENT.doflocs)) - back @ at_lower


_TAIL = _tail()

FIRST_LOOK, LAST_LOOK = 4, 256
LOOKED_UP = 6
"""Number of latest sets of positions whose triangles are cached."""
Located = tuple[Integer, Real]
"""Triangle of each point, and position in it."""

INSIDE = -1e-9


def powers(order: int) -> list[tuple[int, int]]:
    """Exponents of a and b in the monomials up to an order."""
    return [(i, total - i) for total in range(order + 1) for i in range(total + 1)]


def _products(at: Real, powers: list[tuple[int, int]]) -> Real:
    """Monomials at places (2, point) of the reference triangle, shape (monomial, point)."""
    most = 1 + max(map(max, powers))
    a, b = (np.stack([np.ones_like(x), *np.cumprod([x] * (most - 1), axis=0)]) for x in at)
    return np.stack([a[i] * b[j] for i, j in powers])


class MembraneSurface:
    """Interpolation of w [m] between the nodes of an element's triangles.

    p: (2, point) m; nodes: (node of the element, triangle), its corners first.
    """

    def __init__(self, element: ElementH1, p: Real, nodes: Integer, w: Real) -> None:
        from scipy.spatial import KDTree

        self.element, self.nodes, self.w = element, nodes, w
        corners = p[:, nodes[:3]]
        self.origin = corners[:, 0]
        sides = np.moveaxis(corners[:, 1:] - self.origin[:, None], 2, 0)
        self.inverse = np.linalg.inv(sides)
        self.tree = KDTree(corners.mean(axis=1).T)
        self._known: deque[tuple[Real, Located]] = deque(maxlen=LOOKED_UP)
        self._powers = powers(element.maxdeg)
        self._monomials = np.linalg.inv(_products(element.doflocs.T, self._powers))

    def of(self, w: Real) -> MembraneSurface:
        """Surface of another deflection of the same nodes; both share the located positions."""
        other = copy(self)
        other.w = w
        return other

    def __call__(self, x: Real) -> Real:
        """w at flat positions x (2, ...) in m; outside the skin as at its nearest triangle."""
        triangle, shares = self.located(x)
        found = np.zeros(len(triangle))
        for share, node in zip(shares, self.nodes, strict=True):
            found += share * self.w[node[triangle]]
        return np.reshape(found, x.shape[1:])

    def located(self, x: Real) -> tuple[Integer, Real]:
        """Triangle (point,) of positions x (2, ...), and the weights of its nodes there.

        Weights are of shape (node of the element, point).
        """
        triangle, at = self._found(x)
        return triangle, self._monomials @ _products(at, self._powers)

    def in_triangles(self, values: Real) -> Callable[[Real], Real]:
        """Function with a constant value in each triangle, shape (triangle,), of positions as for
        w."""

        def at(x: Real) -> Real:
            triangle, _ = self._found(x)
            return np.reshape(values[triangle], x.shape[1:])

        return at

    def _found(self, x: Real) -> Located:
        """Located positions, see `_located`; cached for positions that are requested again."""
        for known, found in self._known:
            if known is x:
                return found
        found = self._located(np.reshape(x, (2, -1)))
        self._known.append((x, found))
        return found

    def _located(self, x: Real) -> Located:
        """Triangle (point,) of each point, and its position in the triangle (2, point)."""
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

    def _barycentric(self, x: Real, triangle: Integer) -> Real:
        away = x - self.origin[:, triangle]
        along = np.einsum("...ij,j...->i...", self.inverse[triangle], away)
        return np.stack([1 - along.sum(axis=0), *along])
