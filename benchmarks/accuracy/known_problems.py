"""Problems whose solution is known, and elements held against them: manufactured fields, discs and
annuli, and the observed orders.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rcskin.simulator.fem.assembly import element_pairs, fill, pattern_of_pairs, quadrilateral
from rcskin.simulator.fem.quadrature import (
    CellGeometry,
    Rule,
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
from scipy.special import ive, kve
from skfem import LinearForm, MeshQuad, MeshTri
from skfem.assembly import FacetBasis


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
UP_TO = {"squares": 6, "with rings": 6, "bent": 6, "triangles": 4}
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


SMOOTHER_ON_DISCS = 16
SAME_POINT = 9
"""Decimals to which points that two cells share agree."""
CORE = 0.45
"""Half the side of the square in the middle of a disc, as a fraction of its radius."""
SECTORS = 4
CORNERS = np.array([[0, 1, 1, 0], [0, 0, 1, 1]])


@dataclass(frozen=True)
class Curved:
    """A mesh whose cells are bent. mesh: its corners. rule, surface: where the points are.

    c: F/m² at the points, shape (cell, point). radius: of the corners, m.
    """

    mesh: MeshQuad
    rule: Rule
    surface: CellGeometry
    c: NDArray[np.float64]
    radius: NDArray[np.float64]


def impedance(curved: Curved, rim: float, order: int, s: NDArray) -> NDArray:
    """Z in ohm of a skin of 1 ohm/sq fed all along the rim of that radius. s: rad/s.

    Y = s 1'M1 - s² (M1)' (K + s M)^-1 (M1): the deviation from 1 V.
    """
    trial = quadrilateral_trial(curved.mesh, order)
    dofs, one = trial.dofs, trial.one
    pattern, slots = pattern_of_pairs(*element_pairs(dofs.element_dofs), size=dofs.N)
    K, M = np.zeros((2, len(pattern.indices)))
    for terms in stiffness_terms(curved.rule, curved.surface, np.ones_like(curved.c)):
        fill(K, slots, *terms)
    for terms in mass_terms(curved.rule, curved.surface, curved.c):
        fill(M, slots, *terms)
    K, M = pattern.matrix(K), pattern.matrix(M)
    facets = curved.mesh.boundary_facets()
    ends = np.asarray(curved.mesh.facets)[:, facets]
    on_rim = np.isclose(curved.radius[ends], rim).all(axis=0)
    free = np.setdiff1d(np.arange(dofs.N), dofs.get_facet_dofs(facets[on_rim]).flatten())
    charge = M @ one
    K, M, late = K[free][:, free], M[free][:, free], charge[free]
    Y = [each * (one @ charge) - each**2 * late @ splu(K + each * M).solve(late + 0j) for each in s]
    return 1 / np.array(Y)


def disc(n: int, order: int) -> Curved:
    """Of radius 1: a square of n x n cells, and n x n on each of its sides out to the rim."""
    rule = gauss_rule(quadrilateral(order), 2 * order + SMOOTHER_ON_DISCS)
    blocks = [_core, *(_beside(turn, mirror) for turn in (0, 1) for mirror in (1, -1))]
    corners = _joined([_cells(block, n, CORNERS) for block in blocks])
    points = _joined([_cells(block, n, rule.points) for block in blocks])
    return _curved(corners.x, rule, points)


def annulus(n: int, order: int, r1: float, r2: float) -> Curved:
    """n cells from rim to rim, SECTORS n around."""
    rule = gauss_rule(quadrilateral(order), 2 * order + SMOOTHER_ON_DISCS)

    def block(r: NDArray, t: NDArray) -> CellGeometry:
        angle = 2 * np.pi * t
        radius, out = r1 + (r2 - r1) * r, np.stack([np.cos(angle), np.sin(angle)])
        around = 2 * np.pi * radius * np.stack([-out[1], out[0]])
        return CellGeometry(radius * out, (r2 - r1) * out, around)

    corners = _cells(block, n, CORNERS, SECTORS * n)
    return _curved(corners.x, rule, _cells(block, n, rule.points, SECTORS * n))


def unrolled_annulus(n: int, order: int, r1: float, r2: float) -> Curved:
    """ln(r) along x and the angle along y, n x n equal rectangles."""
    rule = gauss_rule(quadrilateral(order), 2 * order + SMOOTHER_ON_DISCS)
    cells = rectangles(np.linspace(np.log(r1), np.log(r2), n + 1), np.linspace(0, 2 * np.pi, n + 1))
    at = surface(cells, rule)
    return Curved(MeshQuad(cells.p, cells.t), rule, at, np.exp(2 * at.x[0]), np.exp(cells.p[0]))


def disc_formula(s: NDArray) -> NDArray:
    """Z = 1/(2 pi k) I0(k)/I1(k), k = sqrt(s), of radius 1 m, 1 ohm/sq and 1 F/m²."""
    k = np.sqrt(s)
    return ive(0, k) / ive(1, k) / (2 * np.pi * k)


def annulus_formula(s: NDArray, r1: float, r2: float) -> NDArray:
    """Fed at r1, open at r2: [I0(k r1) K1(k r2) + K0(k r1) I1(k r2)] / [I1(k r2) K1(k r1) - ...].

    Scaled functions throughout: I = ive exp(Re), K = kve exp(-z).
    """
    k = np.sqrt(s)
    decay = np.exp(np.real(k) * (r1 - r2) - k * (r2 - r1))
    inner = ive(0, k * r1) * kve(1, k * r2) * decay + kve(0, k * r1) * ive(1, k * r2)
    outer = ive(1, k * r2) * kve(1, k * r1) - ive(1, k * r1) * kve(1, k * r2) * decay
    return inner / outer / (2 * np.pi * k * r1)


def _core(a: NDArray, b: NDArray) -> CellGeometry:
    zero, side = np.zeros_like(a), np.full_like(a, 2 * CORE)
    x = CORE * np.stack([2 * a - 1, 2 * b - 1])
    return CellGeometry(x, np.stack([side, zero]), np.stack([zero, side]))


def _beside(turn: int, mirror: int):
    """A block between the square and the rim; its sideways edges run as those of the square do."""

    def block(a: NDArray, b: NDArray) -> CellGeometry:
        angle = (2 * b - 1) * np.pi / 4
        side = CORE * np.stack([np.ones_like(b), 2 * b - 1])
        rim = np.stack([np.cos(angle), np.sin(angle)])
        along_side = CORE * np.stack([np.zeros_like(b), np.full_like(b, 2.0)])
        along_rim = np.pi / 2 * np.stack([-np.sin(angle), np.cos(angle)])
        vectors = (1 - a) * side + a * rim, rim - side, (1 - a) * along_side + a * along_rim
        turned = [each * np.array([mirror, 1]).reshape(2, *[1] * a.ndim) for each in vectors]
        return CellGeometry(*(each[::-1] if turn else each for each in turned))

    return block


def _cells(block, n: int, points: NDArray, m: int | None = None) -> CellGeometry:
    """A block cut into n x m cells, at points of the unit square in each."""
    m = m or n
    i, j = (each.ravel()[:, None] for each in np.meshgrid(np.arange(n), np.arange(m)))
    at = block((i + points[0]) / n, (j + points[1]) / m)
    return CellGeometry(at.x, at.along / n, at.across / m)


def _joined(blocks: list[CellGeometry]) -> CellGeometry:
    parts = ([at.x for at in blocks], [at.along for at in blocks], [at.across for at in blocks])
    return CellGeometry(*(np.concatenate(part, axis=1) for part in parts))


def _curved(corners: NDArray, rule: Rule, at: CellGeometry) -> Curved:
    p = np.round(corners.reshape(2, -1), SAME_POINT) + 0.0
    distinct, number = np.unique(p, axis=1, return_inverse=True)
    mesh = MeshQuad(distinct, np.ascontiguousarray(number.reshape(-1, 4).T))
    return Curved(mesh, rule, at, np.ones(at.x.shape[1:]), np.hypot(*distinct))
