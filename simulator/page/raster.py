"""Potentials of a reduced model's coordinates on a uniform grid of points within its triangles."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix
from skfem import CellBasis

from ..arrays import Integer, Mask, Real
from ..fem.assembly import quadrilateral
from ..fem.quadrature import rule_at
from ..mesh.arcs import mapped
from ..mesh.domain import Domain
from ..models.heterogeneous.elements import triangles
from ..models.heterogeneous.materials import Materials
from ..models.reduced.families_by_system import UniformFamily
from ..models.reduced.family import Family, Triangulation
from ..models.reduced.reduced_skin import ReducedSkin
from ..scene.parts import Skin


@dataclass(frozen=True)
class Raster:
    """Middles of uniform cells over a skin, row by row from the corner (0, 0)."""

    length: float
    width: float
    columns: int
    rows: int

    @classmethod
    def over(cls, skin: Skin, points: int) -> Raster:
        """Raster of about so many points, equally spaced along both sides."""
        length, width = skin.sides
        columns = max(2, round((points * length / width) ** 0.5))
        return cls(length, width, columns, max(2, round(points / columns)))

    @cached_property
    def points(self) -> Real:
        """Positions x and y, m, shape (2, row * column)."""
        x = self.length * (np.arange(self.columns) + 0.5) / self.columns
        y = self.width * (np.arange(self.rows) + 0.5) / self.rows
        return np.stack([each.ravel() for each in np.meshgrid(x, y)])


@dataclass(frozen=True)
class RasterFields:
    """Values that a page shows at the points of a raster.

    potential: V of each field, for 1 V in each of the skin's coordinates in turn, shape (field,
    point, coordinate); of both sheets' difference if the circuit has one field, of top and bottom
    if it has two. on_skin: True for points on the skin, shape (point,). Off the skin potentials are
    those of the nearest place. conductance: that of the top sheet, xx, yy and xy in S, shape (3,
    point).
    """

    potential: Real
    on_skin: Mask
    conductance: Real


def raster_fields(skin: ReducedSkin, raster: Raster) -> RasterFields:
    """Fields of a skin at the raster's points."""
    family = skin.reduced.family
    if isinstance(family, UniformFamily):
        at_points, on_skin = _square_probes(family, raster), np.ones(raster.points.shape[1], bool)
    else:
        at_points, on_skin = _triangle_probes(family, raster)
    whole = family.space.spread(skin.reduced.coordinates @ skin.turn)
    held = np.vstack([whole, np.zeros((1, whole.shape[1]))])
    numbers = family.system.unknowns.number
    top = Materials(family.skin).conductance("top", raster.points)
    every = np.zeros(raster.points.shape[1])
    return RasterFields(
        np.stack([at_points @ held[number] for number in numbers]), on_skin, top + every
    )


def _square_probes(family: UniformFamily, raster: Raster) -> csr_matrix:
    basis = CellBasis(family.system.pixels.mesh, quadrilateral(family.mesh.order), intorder=1)
    return csr_matrix(basis.probes(raster.points))


def _triangle_probes(family: Family, raster: Raster) -> tuple[csr_matrix, Mask]:
    """Matrix from coefficients of one field to values at points.

    Also returns True for points that are on the skin.
    """
    mesh = family.mesh
    assert isinstance(mesh, Triangulation)
    elements, points = triangles(mesh.domain, mesh.order), raster.points
    found = locate_points(mesh.domain, points)
    values = rule_at(elements.element, found.places, np.ones(points.shape[1])).values
    dofs = elements.trial.dofs.element_dofs[:, found.triangle]
    every = np.broadcast_to(np.arange(points.shape[1]), dofs.shape)
    shape = points.shape[1], elements.trial.dofs.N
    return csr_matrix((values.ravel(), (every.ravel(), dofs.ravel())), shape=shape), found.on_skin


EDGE_TOLERANCE = 1e-6
"""Distance beyond a triangle, over its size, up to which a point is still in it."""
NEWTON_STEPS = 5
"""Steps from the straight triangle to the one with arcs for edges."""


class LocatedPoints(NamedTuple):
    """Triangles of points, and places (a, b) in the unit triangle.

    Points off the skin are moved onto it, and on_skin is False for them. triangle, on_skin: shape
    (point,). places: shape (2, point).
    """

    triangle: Integer
    places: Real
    on_skin: Mask


def locate_points(domain: Domain, points: Real) -> LocatedPoints:
    """Places on the mesh of points as seen along z, m, shape (2, point)."""
    each = [_nearest(domain, x) for x in points.T]
    triangle = np.array([number for number, _ in each])
    bends = domain.curvature
    places = np.stack([place for _, place in each], axis=1)
    for k in np.flatnonzero(bends[:, triangle].any(axis=0)):
        here = domain.p[:2], domain.t[:, triangle[[k]]], bends[:, triangle[[k]]]
        places[:, k] = _newton_place(*here, places[:, k], points[:, k])
    corners = np.vstack([places, 1 - places.sum(axis=0)])
    inside = np.maximum(corners, 0.0)
    return LocatedPoints(
        triangle, (inside / inside.sum(axis=0))[:2], corners.min(axis=0) >= -EDGE_TOLERANCE
    )


def _nearest(domain: Domain, x: Real) -> tuple[int, Real]:
    """Triangle that contains x or is nearest, and (a, b) in it, by its corners alone."""
    origin, along, across = domain.p[:2, domain.t].transpose(1, 0, 2)
    along, across, off = along - origin, across - origin, x[:, None] - origin
    area = along[0] * across[1] - along[1] * across[0]
    a = (off[0] * across[1] - off[1] * across[0]) / area
    b = (along[0] * off[1] - along[1] * off[0]) / area
    beyond = -np.minimum(np.minimum(a, b), 1 - a - b) * domain.lengths
    nearest = int(np.argmin(beyond))
    return nearest, np.array([a[nearest], b[nearest]])


def _newton_place(p: Real, t: Integer, bends: Real, place: Real, x: Real) -> Real:
    """Newton's method for (a, b) at x in a triangle with arcs.

    p, t, bends: as for `mapped`.
    """
    for _ in range(NEWTON_STEPS):
        at, along, across = (each[:, 0, 0] for each in mapped(p, t, bends, place[:, None]))
        place = place + np.linalg.solve(np.stack([along, across], axis=1), x - at)
    return place
