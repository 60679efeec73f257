"""The chosen solutions found again by elements of any order, on cells of any shape."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.verification_parts.chosen import Problem, capacitance
from rcskin.simulator.fem.assembly import element_pairs, fill, pattern_of_pairs, quadrilateral
from rcskin.simulator.fem.quadrature import (
    gauss_rule,
    interpolated,
    mass_terms,
    stiffness_terms,
    surface,
    triangle_rule,
)
from rcskin.simulator.fem.unknowns import TRIANGLES, quadrilateral_trial, triangle_trial
from rcskin.simulator.mesh.quadrilaterals import QuadrilateralCells, rectangles, ringed
from rcskin.simulator.models.heterogeneous.elements import flat_triangles
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu
from skfem import LinearForm, MeshQuad, MeshTri
from skfem.assembly import FacetBasis

SMOOTHER = 8
"""How much higher a degree the rule is exact for than products of basis functions need."""


@dataclass(frozen=True)
class Triangles:
    """Points in m, shape (2, point), and corners, ascending in each column, shape (3, cell)."""

    p: NDArray[np.float64]
    t: NDArray[np.int64]


def squares(n: int) -> QuadrilateralCells:
    """n x n equal cells."""
    return rectangles(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))


def with_rings(n: int) -> QuadrilateralCells:
    """The same, two rings of trapezoids around the middle of the left edge; n even."""
    middle = n // 2 * (n + 1)
    return ringed(squares(n), np.array([middle]), layers=2)


def bent(n: int) -> QuadrilateralCells:
    """The same, moved smoothly within the square: no cell is a parallelogram."""
    even = squares(n)
    bump = 0.08 * np.sin(np.pi * even.p[0]) * np.sin(np.pi * even.p[1])
    return of_points(even.p + np.stack([bump, -1.5 * bump]), even.t)


def of_points(p: NDArray[np.float64], t: NDArray[np.int64]) -> QuadrilateralCells:
    """Straight-edged cells from their points in m, shape (2, point), and corners."""
    first, second, third, fourth = (p[:, corner] for corner in t)
    return QuadrilateralCells(p, t, second - first, fourth - first, third - second - fourth + first)


def halved(n: int) -> Triangles:
    """The bent cells cut in two, all by the same diagonal."""
    cells = bent(n)
    a, b, c, d = cells.t
    halves = np.hstack([np.stack([a, b, c]), np.stack([a, c, d])])
    return Triangles(cells.p, np.sort(halves, axis=0))


MESHES = {"squares": squares, "with rings": with_rings, "bent": bent, "triangles": halved}
ORDERS = {"squares": 6, "with rings": 6, "bent": 6, "triangles": 4}
"""The highest one on each mesh."""
CELLS = {1: (16, 32), 2: (16, 32), 3: (8, 16), 4: (8, 12), 5: (6, 8), 6: (6, 8)}
CELLS_FOR_CURRENT = {1: (16, 32), 2: (8, 16), 3: (6, 12), 4: (6, 10), 5: (4, 6), 6: (2, 4)}
"""Fewer, for its error soon meets rounding."""
QUANTITIES: dict[str, Callable[[int], int]] = {
    "L2": lambda order: order + 1,
    "H1": lambda order: order,
    "current": lambda order: 2 * order,
}
"""What is measured, and the order in h that theory gives it."""


@dataclass(frozen=True)
class Errors:
    """Relative errors of the potentials, of their gradients, and of the foil's current."""

    L2: float
    H1: float
    current: float


def errors(problem: Problem, cells: QuadrilateralCells | Triangles, order: int) -> Errors:
    """Of elements of that order on these cells."""
    discrete = Discrete(problem, cells, order)
    u, current = discrete.solution()
    x = discrete.surface.x
    dx = discrete.rule.weights * discrete.surface.area
    off, size = np.zeros(2), np.zeros(2)
    for field, true in enumerate(problem.potentials):
        found, slope = interpolated(
            discrete.rule, discrete.surface, u[field, discrete.dofs.element_dofs]
        )
        pairs = (found, true.value(x)), (slope, true.gradient(x))
        off += [(abs(a - b) ** 2 * dx).sum() for a, b in pairs]
        size += [(abs(b) ** 2 * dx).sum() for _, b in pairs]
    L2, H1 = np.sqrt(off / size)
    return Errors(L2, H1, abs(current / problem.foil_current() - 1))


def observed_orders(problem: Problem, mesh: str, order: int) -> dict[str, float]:
    """The order in h of every quantity, from two sizes of cells."""
    slopes = {}
    for counts, quantities in ((CELLS, ("L2", "H1")), (CELLS_FOR_CURRENT, ("current",))):
        n, more = counts[order]
        coarse, fine = (errors(problem, MESHES[mesh](each), order) for each in (n, more))
        for name in quantities:
            fall = getattr(coarse, name) / getattr(fine, name)
            slopes[name] = math.log(fall) / math.log(more / n)
    return slopes


class Discrete:
    """The equations of a problem on a mesh; coefficients of a field are `field * N` further on."""

    def __init__(self, problem: Problem, cells: QuadrilateralCells | Triangles, order: int) -> None:
        self.problem, self.order = problem, order
        degree = 2 * order + SMOOTHER
        if isinstance(cells, Triangles):
            self.element = TRIANGLES[order - 1]()
            self.mesh = MeshTri(cells.p, cells.t, sort_t=False)
            self.rule = triangle_rule(self.element, degree)
            self.surface = flat_triangles(cells.p, cells.t, self.rule)
            self.trial = triangle_trial(self.mesh, order)
        else:
            self.element = quadrilateral(order)
            self.mesh = MeshQuad(cells.p, cells.t)
            self.rule = gauss_rule(self.element, degree)
            self.surface = surface(cells, self.rule)
            self.trial = quadrilateral_trial(self.mesh, order)
        self.dofs = self.trial.dofs
        self.fields = range(len(problem.potentials))

    def solution(self) -> tuple[NDArray[np.complex128], complex]:
        """Coefficients, shape (field, N), and the current into the first field's foil in A.

        The current is A u - b summed over the foil: the variational form.
        """
        N, matrix, right, one = self.dofs.N, self.matrix, self.right, self.trial.one
        u = np.zeros(len(self.fields) * N, dtype=complex)
        foils = [self.under_foil(field) for field in self.fields]
        for field, foil in enumerate(foils):
            u[field * N + foil] = self.problem.potentials[field].offset * one[foil]
        held = np.concatenate([field * N + foil for field, foil in enumerate(foils)])
        free = np.setdiff1d(np.arange(len(u)), held)
        u[free] = splu(matrix[free][:, free]).solve((right - matrix @ u)[free])
        current = one[foils[0]] @ (matrix @ u - right)[foils[0]]
        return u.reshape(len(self.fields), N), complex(current)

    @cached_property
    def matrix(self) -> csc_matrix:
        """K + s M."""
        x, shape = self.surface.x, (self.rule, self.surface)
        unknown = np.concatenate([self.dofs.element_dofs + k * self.dofs.N for k in self.fields])
        size = len(self.fields) * self.dofs.N
        pattern, slots = pattern_of_pairs(*element_pairs(unknown), size=size)
        K, M = np.zeros((2, len(pattern.indices)))
        for field, sheet in enumerate(self.problem.sheets):
            alone = np.zeros((len(self.fields),) * 2)
            alone[field, field] = 1.0
            for terms in stiffness_terms(*shape, sheet.conductance(x), alone):
                fill(K, slots, *terms)
        for terms in mass_terms(*shape, capacitance(x), self.problem.coupling):
            fill(M, slots, *terms)
        return pattern.matrix(K + self.problem.s * M)

    @cached_property
    def right(self) -> NDArray[np.complex128]:
        """Sources, and what enters through the edges without a foil."""
        b = np.zeros((len(self.fields), self.dofs.N), dtype=complex)
        for field in self.fields:
            f = self.problem.source(field, self.surface.x)
            load = self.rule.values @ (self.rule.weights * self.surface.area * f).T
            np.add.at(b[field], self.dofs.element_dofs, load)
            b[field] += self._entering(field)
        return b.ravel()

    def _entering(self, field: int) -> NDArray[np.complex128]:
        facets = np.setdiff1d(self.mesh.boundary_facets(), self._foil(field))
        degree = 2 * self.order + SMOOTHER
        basis = FacetBasis(self.mesh, self.element, facets=facets, intorder=degree)

        def current(v: Any, w: Any) -> Any:
            return self.problem.normal_current(field, w.x, w.n) * v

        real, imaginary = (
            LinearForm(lambda v, w, part=part: part(current(v, w))).assemble(basis)
            for part in (np.real, np.imag)
        )
        return real + 1j * imaginary

    def under_foil(self, field: int) -> NDArray[np.int64]:
        """Coefficients that are not zero under a field's foil."""
        return self.dofs.get_facet_dofs(self._foil(field)).flatten()

    def _foil(self, field: int) -> NDArray[np.int64]:
        axis = self.problem.foils[field]
        return self.mesh.facets_satisfying(lambda x: abs(x[axis]) < 1e-12, boundaries_only=True)
