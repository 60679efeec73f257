"""Element matrices of coefficients that vary within cells of any shape, on quads and triangles.

An integral over a cell is a sum over the points of a rule. The products of basis functions at a
point are the same in every cell; the coefficient there, the cell's area and its slant differ. So
they are reference matrices, one per point for c u v and three per point for grad u . S grad v, and
the kernel for weighted reference matrices adds them. Coefficients that are
constant in each cell are integrated once: one matrix, and three.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from skfem import Element, MeshQuad, MeshTri
from skfem.assembly import Basis
from skfem.quadrature import get_quadrature
from skfem.refdom import RefQuad, RefTri

from ..arrays import Integer, Real
from ..mesh.quadrilaterals import QuadrilateralCells

ROUNDING = 1e-14
"""Fraction of the largest integral below which integrals are set to 0, so that factors stay sparse.
"""
BLOCK = 4_000_000
ONE_FIELD = np.ones((1, 1))

Terms = tuple[Real, Real]
"""Weights, shape (cell, term), and their matrices, one per row, shape (term, local²)."""


@dataclass(frozen=True)
class Rule:
    """Points of the unit square or triangle and an element's basis functions there.

    points: (a, b), shape (2, point). weights: shape (point,). values: shape (function, point).
    slopes: d/da and d/db, shape (2, function, point).
    """

    points: Real
    weights: Real
    values: Real
    slopes: Real

    @cached_property
    def mass(self) -> Real:
        """Integrals of u v, shape (function, function)."""
        return self._products(self.values, self.values)

    @cached_property
    def stiffness(self) -> Real:
        """Integrals of d/da d/da, d/db d/db and d/da d/db + d/db d/da, shape (3, function,
        function)."""
        a, b = self.slopes
        both = 2 * self._products(a, b)
        return np.stack([self._products(a, a), self._products(b, b), both])

    def _products(self, u: Real, v: Real) -> Real:
        """Integrals of (u_i v_j + u_j v_i) / 2, shape (local, local); 0 where only rounding is
        left."""
        one_way = (u * self.weights) @ v.T
        found = (one_way + one_way.T) / 2
        return np.where(np.abs(found) > ROUNDING * np.abs(found).max(), found, 0.0)


@dataclass(frozen=True)
class CellGeometry:
    """Positions of a rule's points in each cell, and the derivatives of x by a and b there.

    x: m. along: dx/da in m. across: dx/db in m. All of shape (2, cell, point). On a surface in
    space x holds the first two coordinates; along and across are in each cell's own frame.
    """

    x: Real
    along: Real
    across: Real

    @property
    def area(self) -> Real:
        """Area of the parallelogram of along and across at each point, m², shape (cell, point)."""
        along, across = self.along, self.across
        return np.abs(along[0] * across[1] - along[1] * across[0])

    def some(self, cells: Integer | slice) -> CellGeometry:
        """Geometry of some of the cells."""
        return CellGeometry(self.x[:, cells], self.along[:, cells], self.across[:, cells])


def gauss_rule(element: Element, degree: int) -> Rule:
    """Product rule that is exact for polynomials of that degree in a and in b."""
    nodes, weights = np.polynomial.legendre.leggauss(degree // 2 + 1)
    points = np.stack([each.ravel() for each in np.meshgrid((nodes + 1) / 2, (nodes + 1) / 2)])
    return rule_at(element, points, np.outer(weights, weights).ravel() / 4)


def triangle_rule(element: Element, degree: int) -> Rule:
    """Rule that is exact for polynomials of that total degree."""
    return rule_at(element, *get_quadrature(RefTri, degree))


def divided(element: Element, rule: Rule) -> Rule:
    """The rule applied to each of the four triangles that the reference triangle is divided
    into."""
    half = rule.points / 2
    turned = 0.5 - half
    corners = [half, half + [[0.5], [0.0]], half + [[0.0], [0.5]]]
    return rule_at(element, np.hstack([*corners, turned]), np.tile(rule.weights / 4, 4))


def rule_at(element: Element, points: Real, weights: Real) -> Rule:
    """Basis functions of an element at these points of its reference cell, shape (2, point)."""
    basis = Basis(_reference_mesh(element), element, quadrature=(points, weights)).basis
    functions = [each for each, *_ in basis]
    return Rule(
        points,
        weights,
        np.stack([np.asarray(each)[0] for each in functions]),
        np.stack([np.asarray(each.grad)[:, 0] for each in functions], axis=1),
    )


def edge_rule(element: Element, edge: int, count: int) -> tuple[Rule, Real]:
    """Rule with `count` points along one edge of the reference cell, and the direction of that
    edge."""
    corners = np.asarray(element.refdom.p)
    start, end = (corners[:, k] for k in np.asarray(element.refdom.facets)[edge])
    nodes, weights = np.polynomial.legendre.leggauss(count)
    points = start[:, None] + (end - start)[:, None] * (nodes + 1) / 2
    return rule_at(element, points, weights / 2), end - start


def _reference_mesh(element: Element) -> MeshQuad | MeshTri:
    if element.refdom is RefQuad:
        return MeshQuad()
    return MeshTri(np.eye(3)[1:], np.arange(3)[:, None])


def surface(cells: QuadrilateralCells, rule: Rule) -> CellGeometry:
    """Geometry of straight-edged quadrilaterals: x = x0 + a along + b across + a b twist."""
    a, b = rule.points
    vectors = (cells.p[:, cells.t[0]], cells.along, cells.across, cells.twist)
    origin, along, across, twist = (each[:, :, None] for each in vectors)
    return CellGeometry(
        origin + a * along + b * across + a * b * twist, along + b * twist, across + a * twist
    )


def mass_terms(
    rule: Rule, surface: CellGeometry, c: Real, fields: Real = ONE_FIELD
) -> Iterator[Terms]:
    """Terms of the form c u v. c: F/m², shape (cell, point). fields: its coupling between fields.

    Yields blocks of a few points; none takes more than BLOCK numbers.
    """
    density = surface.area * c
    if _uniform(density):
        yield density[:, :1], _between_fields(fields, rule.mass[None])
        return
    weights = rule.weights * density
    for some in _blocks(rule, fields):
        v = rule.values[:, some]
        yield weights[:, some], _between_fields(fields, np.einsum("ip,jp->pij", v, v))


def stiffness_terms(
    rule: Rule, surface: CellGeometry, conductance: Real, fields: Real = ONE_FIELD
) -> Iterator[Terms]:
    """Terms of the form grad u . S grad v.

    conductance: S in S, a scalar of shape (cell, point) or a tensor by its xx, yy and xy of shape
    (3, cell, point). With J = [along, across] the weights are |J| J^-1 S J^-T, of da da, db db and
    da db + db da.
    """
    density = _pulled_back(surface, conductance)
    if _uniform(density):
        yield density[..., 0].T, _between_fields(fields, rule.stiffness)
        return
    weights = rule.weights * density
    for some in _blocks(rule, fields):
        a, b = rule.slopes[:, :, some]
        aa, bb, ab = (np.einsum("ip,jp->pij", u, v) for u, v in ((a, a), (b, b), (a, b)))
        matrices = np.concatenate([aa, bb, ab + ab.transpose(0, 2, 1)])
        yield np.hstack([*weights[..., some]]), _between_fields(fields, matrices)


def _pulled_back(surface: CellGeometry, conductance: Real) -> Real:
    """|J| J^-1 S J^-T by its components along a a, b b and a b, shape (3, cell, point)."""
    along, across = surface.along, surface.across
    if conductance.ndim == along.ndim - 1:
        metric = np.stack([(across**2).sum(0), (along**2).sum(0), -(along * across).sum(0)])
        return conductance / surface.area * metric
    xx, yy, xy = conductance
    to_a, to_b = np.stack([across[1], -across[0]]), np.stack([-along[1], along[0]])

    def form(u: Real, v: Real) -> Real:
        return xx * u[0] * v[0] + yy * u[1] * v[1] + xy * (u[0] * v[1] + u[1] * v[0])

    return np.stack([form(to_a, to_a), form(to_b, to_b), form(to_a, to_b)]) / surface.area


def _uniform(density: Real) -> bool:
    """True if a density is constant in each cell."""
    return bool((density == density[..., :1]).all())


def interpolated(rule: Rule, surface: CellGeometry, u: NDArray) -> tuple[NDArray, NDArray]:
    """A function and its gradient, per m, from its coefficients u, shape (function, cell).

    Returns shapes (cell, point) and (2, cell, point).
    """
    along, across = surface.along, surface.across
    determinant = along[0] * across[1] - along[1] * across[0]
    da, db = (u.T @ slope for slope in rule.slopes)
    dx = (across[1] * da - along[1] * db) / determinant
    dy = (along[0] * db - across[0] * da) / determinant
    return u.T @ rule.values, np.stack([dx, dy])


def _blocks(rule: Rule, fields: Real) -> Iterator[slice]:
    functions, points = rule.values.shape
    size = max(1, BLOCK // (3 * (functions * len(fields)) ** 2))
    return (slice(start, start + size) for start in range(0, points, size))


def _between_fields(fields: Real, matrices: Real) -> Real:
    return np.einsum("fg,pij->pfigj", fields, matrices).reshape(len(matrices), -1)
