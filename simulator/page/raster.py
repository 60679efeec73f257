"""What a reduced model's coordinates are on the skin: potentials on an even grid of points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from skfem import CellBasis

from ..fem.assembly import quadrilateral
from ..mesh.quadrilaterals import pixel_mesh
from ..models.reduced.even import EvenFamily
from ..models.reduced.model import ReducedSkin
from ..scene.scene import Scene


@dataclass(frozen=True)
class Raster:
    """Points in the middle of even cells over a skin, row by row from the corner (0, 0)."""

    length: float
    width: float
    columns: int
    rows: int

    @classmethod
    def over(cls, scene: Scene, points: int) -> Raster:
        """About so many points, as far apart along both sides."""
        length, width = scene.skin.sides
        columns = max(2, round((points * length / width) ** 0.5))
        return cls(length, width, columns, max(2, round(points / columns)))

    @cached_property
    def points(self) -> NDArray[np.float64]:
        """x and y in m, shape (2, row * column)."""
        x = self.length * (np.arange(self.columns) + 0.5) / self.columns
        y = self.width * (np.arange(self.rows) + 0.5) / self.rows
        return np.stack([each.ravel() for each in np.meshgrid(x, y)])


def potentials(skin: ReducedSkin, raster: Raster) -> NDArray[np.float64]:
    """V of each field at the raster's points, 1 V in each of the skin's coordinates in turn.

    Of shape (field, point, coordinate). The field is that of both sheets' difference where the
    circuit has one, of top and bottom where it has two.
    """
    reduced = skin.reduced
    family = reduced.family
    assert isinstance(family, EvenFamily)
    mesh = pixel_mesh(family.scene, family.circuit.contacts, family.mesh).mesh
    basis = CellBasis(mesh, quadrilateral(family.mesh.order), intorder=1)
    at_points = basis.probes(raster.points).tocsr()
    whole = family.space.spread(reduced.coordinates @ skin.turn)
    held = np.vstack([whole, np.zeros((1, whole.shape[1]))])
    return np.stack([at_points @ held[number] for number in family.system.unknowns.number])
