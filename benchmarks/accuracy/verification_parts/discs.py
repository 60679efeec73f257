"""A disc and an annulus fed at a whole rim, on cells with curved edges that follow it.

The rule only asks where its points lie and how a cell runs there, so that a cell may be bent in any
way. An annulus is also a rectangle: ln(r) and the angle are as good as x and y, with the
capacitance c r² that grows within every cell.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from rcskin.simulator.fem.assembly import element_pairs, fill, pattern_of_pairs, quadrilateral
from rcskin.simulator.fem.quadrature import (
    CellGeometry,
    Rule,
    gauss_rule,
    mass_terms,
    stiffness_terms,
    surface,
)
from rcskin.simulator.fem.unknowns import quadrilateral_trial
from rcskin.simulator.mesh.quadrilaterals import rectangles
from scipy.sparse.linalg import splu
from scipy.special import ive, kve
from skfem import MeshQuad

SMOOTHER = 16
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
    rule = gauss_rule(quadrilateral(order), 2 * order + SMOOTHER)
    blocks = [_core, *(_beside(turn, mirror) for turn in (0, 1) for mirror in (1, -1))]
    corners = _joined([_cells(block, n, CORNERS) for block in blocks])
    points = _joined([_cells(block, n, rule.points) for block in blocks])
    return _curved(corners.x, rule, points)


def annulus(n: int, order: int, r1: float, r2: float) -> Curved:
    """n cells from rim to rim, SECTORS n around."""
    rule = gauss_rule(quadrilateral(order), 2 * order + SMOOTHER)

    def block(r: NDArray, t: NDArray) -> CellGeometry:
        angle = 2 * np.pi * t
        radius, out = r1 + (r2 - r1) * r, np.stack([np.cos(angle), np.sin(angle)])
        around = 2 * np.pi * radius * np.stack([-out[1], out[0]])
        return CellGeometry(radius * out, (r2 - r1) * out, around)

    corners = _cells(block, n, CORNERS, SECTORS * n)
    return _curved(corners.x, rule, _cells(block, n, rule.points, SECTORS * n))


def unrolled_annulus(n: int, order: int, r1: float, r2: float) -> Curved:
    """ln(r) along x and the angle along y, n x n equal rectangles."""
    rule = gauss_rule(quadrilateral(order), 2 * order + SMOOTHER)
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
