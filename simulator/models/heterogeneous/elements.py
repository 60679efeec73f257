"""Elements of a heterogeneous skin: trial functions, rules and geometry on one mesh."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from numpy.typing import NDArray
from skfem import Element, MeshTri
from skfem.mesh import Mesh2D

from ...arrays import Integer, Real
from ...fem.assembly import quadrilateral
from ...fem.quadrature import (
    CellGeometry,
    Rule,
    divided,
    edge_rule,
    gauss_rule,
    rule_at,
    surface,
    triangle_rule,
)
from ...fem.unknowns import (
    TRIANGLES,
    TrialSpace,
    quadrilateral_trial,
    triangle_trial,
)
from ...mesh.arcs import mapped
from ...mesh.domain import Domain
from ...mesh.quadrilaterals import PixelMesh
from ...scene.contacts import Contact
from ...scene.skin import SheetsAndFoam
from ...scene.wiring_checks import under_foil

MORE_ON_SQUARES, MORE_ON_TRIANGLES = 6, 4
"""Degree of the rules above twice the order, for the coefficients."""


@dataclass(frozen=True)
class Elements:
    """Trial functions on a mesh.

    surface_at: geometry at the points of a rule, in some of the cells. cells_at_facets: a cell at
    each facet and the number of the facet among its edges, shapes (facet,). facets: those under a
    foil. inside: cells that a foil with a width covers. mesh: in the numbering of scikit-fem, as
    seen along z. groups: straight cells, and curved ones. in_space: of triangles in space their
    first corners and the two edges from there, m, each of shape (3, cell, 1); None in the plane.
    """

    element: Element
    order: int
    trial: TrialSpace
    rule: Rule
    surface_at: Callable[[Rule, Integer | slice], CellGeometry]
    cells_at_facets: Callable[[Integer], tuple[Integer, Integer]]
    facets: Callable[[Contact], Integer]
    inside: Callable[[Contact], Integer]
    mesh: Mesh2D
    groups: Sequence[Integer | slice] = (slice(None),)
    in_space: tuple[Real, ...] | None = None

    @property
    def cells(self) -> int:
        """Number of cells."""
        return self.trial.dofs.element_dofs.shape[1]

    @property
    def outline(self) -> Integer:
        """Facets along the skin's edges, holes included."""
        return self.mesh.boundary_facets()

    def across(self, of_cell: NDArray) -> tuple[Integer, NDArray, NDArray]:
        """Facets at which a value per cell jumps, and its values on either side.

        of_cell: shape (cell,). Returns three arrays of shape (facet,).
        """
        one, other = np.asarray(self.mesh.f2t, dtype=np.int64)
        facets = np.flatnonzero((other >= 0) & (of_cell[one] != of_cell[other]))
        return facets, of_cell[one[facets]], of_cell[other[facets]]

    @cached_property
    def surface(self) -> CellGeometry:
        """Geometry at the rule's points in all cells."""
        return self.surface_at(self.rule, slice(None))

    @cached_property
    def divided(self) -> tuple[Rule, CellGeometry]:
        """The rule on each quarter of every triangle, and the geometry at its points."""
        rule = divided(self.element, self.rule)
        return rule, self.surface_at(rule, slice(None))

    def edge_rule(self, edge: int) -> tuple[Rule, Real]:
        """Rule along one edge of the reference cell, and the direction of that edge."""
        return edge_rule(self.element, edge, self.order + 1 + MORE_ON_TRIANGLES // 2)


def squares(pixels: PixelMesh, order: int) -> Elements:
    """Quadrilaterals that conform to pixels."""
    element = quadrilateral(order)
    middles = pixels.cells.p[:, pixels.cells.t].mean(axis=1)

    def at_facets(facets: Integer) -> tuple[Integer, Integer]:
        return _cells_at_facets(pixels.mesh, facets)

    return Elements(
        element=element,
        order=order,
        trial=quadrilateral_trial(pixels.mesh, order),
        rule=_rule_on_squares(order),
        surface_at=lambda rule, some: surface(pixels.cells.some(some), rule),
        cells_at_facets=at_facets,
        facets=pixels.facets,
        inside=lambda contact: _covered(contact, pixels.skin, middles),
        mesh=pixels.mesh,
    )


def _covered(contact: Contact, skin: SheetsAndFoam | None, middles: Real) -> Integer:
    """Cells with these middles that a foil with a width covers."""
    if not contact.width:
        return np.empty(0, dtype=np.int64)
    assert skin is not None
    return np.flatnonzero(under_foil(contact, skin, middles))


@cache
def _rule_on_squares(order: int) -> Rule:
    return gauss_rule(quadrilateral(order), 2 * order + MORE_ON_SQUARES)


def triangles(domain: Domain, order: int, skin: SheetsAndFoam | None = None) -> Elements:
    """Triangles of a domain in the plane or in space, orders 1 to 4.

    skin: the skin of the domain, for foils with a width.
    """
    element, rule = _triangle(order)
    mesh = domain.flat

    def at_facets(facets: Integer) -> tuple[Integer, Integer]:
        return _cells_at_facets(mesh, facets)

    return Elements(
        element=element,
        order=order,
        trial=triangle_trial(mesh, order),
        rule=rule,
        surface_at=on_triangles(domain),
        cells_at_facets=at_facets,
        facets=lambda contact: numbers_of(mesh, domain.foils[contact.name]),
        inside=lambda contact: _covered(contact, skin, domain.middles),
        mesh=mesh,
        groups=_straight_and_bent(domain),
        in_space=_edges(domain.p, domain.t) if len(domain.p) == 3 else None,
    )


@cache
def _triangle(order: int) -> tuple[Element, Rule]:
    element = TRIANGLES[order - 1]()
    return element, triangle_rule(element, 2 * order + MORE_ON_TRIANGLES)


@cache
def raising(order: int) -> Real:
    """Matrix from coefficients on triangles of an order to those of the next order.

    Shape (function of the next order, function).
    """
    finer = TRIANGLES[order]()
    return rule_at(TRIANGLES[order - 1](), finer.doflocs.T, np.zeros(len(finer.doflocs))).values.T


def on_triangles(domain: Domain) -> Callable[[Rule, Integer | slice], CellGeometry]:
    """Function that gives the geometry at the points of a rule in some of the triangles."""
    curvature = domain.curvature

    def surface_at(rule: Rule, some: Integer | slice) -> CellGeometry:
        t = domain.t[:, some]
        if len(domain.p) == 3:
            return flat_triangles(domain.p, t, rule)
        return CellGeometry(*mapped(domain.p, t, curvature[:, some], rule.points))

    return surface_at


def _straight_and_bent(domain: Domain) -> Sequence[Integer | slice]:
    bent = domain.curvature.any(axis=0)
    return (np.flatnonzero(~bent), np.flatnonzero(bent)) if bent.any() else (slice(None),)


def flat_triangles(p: Real, t: Integer, rule: Rule) -> CellGeometry:
    """Geometry of straight triangles, x = x0 + a along + b across; in space each has its own
    frame."""
    origin, along, across = _edges(p, t)
    a, b = rule.points
    x = (origin + a * along + b * across)[:2]
    if len(p) == 3:
        along, across = _in_their_plane(along, across)
    every = np.ones_like(a)
    return CellGeometry(x, along * every, across * every)


def _edges(p: Real, t: Integer) -> tuple[Real, ...]:
    """First corners and the edges from there to the other two, each of shape (dim, cell, 1)."""
    origin = p[:, t[0]][:, :, None]
    return origin, *(p[:, t[k]][:, :, None] - origin for k in (1, 2))


def numbers_of(mesh: MeshTri, ends: Integer) -> Integer:
    """Numbers of facets given by their two points, ascending, shape (2, facet)."""
    count = mesh.p.shape[1]
    keys = np.asarray(mesh.facets, dtype=np.int64)
    known = keys[0] * count + keys[1]
    order = np.argsort(known)
    return order[np.searchsorted(known[order], ends[0] * count + ends[1])]


def _cells_at_facets(mesh: Mesh2D, facets: Integer) -> tuple[Integer, Integer]:
    cell = np.asarray(mesh.f2t, dtype=np.int64)[0, facets]
    return cell, np.argmax(np.asarray(mesh.t2f)[:, cell] == facets, axis=0)


def _in_their_plane(along: Real, across: Real) -> tuple[Real, Real]:
    """Both edges in a frame of their plane whose first axis is the first edge."""
    length = np.linalg.norm(along, axis=0)
    shared = (along * across).sum(axis=0) / length
    height = np.sqrt((across**2).sum(axis=0) - shared**2)
    return np.stack([length, np.zeros_like(length)]), np.stack([shared, height])
