"""Potentials of a reduced model's coordinates on a uniform grid of points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_matrix
from skfem import CellBasis

from ..arrays import Mask, Real
from ..fem.assembly import quadrilateral
from ..fem.quadrature import rule_at
from ..models.heterogeneous.elements import triangles
from ..models.heterogeneous.materials import Materials
from ..models.reduced.families.family import Family, Triangulation
from ..models.reduced.families.uniform_family import UniformFamily
from ..models.reduced.reduced_skin import ReducedSkin
from ..scene.parts import Pressing, Skin
from .locating import locate_points


@dataclass(frozen=True)
class Raster:
    """Middles of uniform cells over a skin, row by row from the corner (0, 0)."""

    length: float
    width: float
    columns: int
    rows: int

    @classmethod
    def over(cls, skin: Skin, pressing: Pressing, points: int) -> Raster:
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
