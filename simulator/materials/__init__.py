"""What a scene's skin is made of, place by place, in the coordinates of the flat skin at rest.

With F the tangents of where the skin is in space, G = F'F, J = sqrt(det G) and U = sqrt(G), a sheet
of resistance R' on the stretched skin and of conductance A / R' along its own directions (A turns
with the sheet) takes the place of a flat sheet of conductance S = J U^-1 A U^-1 / R', and foam of
c' per stretched area that of c = J c'. By the sheets' Poisson ratio p, R' = R J^(p / (1 - p)): R J
where they keep their volume. c' = c0 J^(q / (1 - q)) by that of the foam.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from simulator.grid import SAME_EDGE, Lines, distinct
from simulator.materials.embedding import isometric, metric, position, tangents
from simulator.materials.tensors import adjugate, between, directed, root
from simulator.scene import Electrode, Scene, Sheet
from simulator.shape import Stretch

__all__ = ["Materials", "position", "strain_of"]

ISOTROPIC = np.array([1.0, 1.0, 0.0])


def strain_of(factor: ArrayLike) -> NDArray[np.float64]:
    """Compressive strain of foam of constant permittivity at that factor of its capacitance.

    1 - 1 / factor; 0 where the factor is below 1.
    """
    return np.maximum(1 - 1 / np.asarray(factor, dtype=np.float64), 0.0)


class Materials:
    """Conductances and capacitance of a scene's skin at any places x, flat and in m."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._isometric = isometric(scene.skin)
        self._sheet_power, self._foam_power = (scene.skin.stretch or Stretch()).thinning

    def conductance(
        self, electrode: Electrode, x: NDArray[np.float64], strain: ArrayLike = 0.0
    ) -> NDArray[np.float64]:
        """S of an electrode as (xx, yy, xy) in S, shape (3, ...), at x of shape (2, ...).

        strain: compressive strain of the foam there, which broadcasts with (...), see `strain_of`.
        """
        sheet = self.scene.skin.sheet(electrode)
        R = self._resistance(sheet, x) * (1 + sheet.piezoresistance * np.asarray(strain))
        own = sheet.anisotropy
        A = directed(own.ratio, own.angle) if own else ISOTROPIC
        A = A.reshape(3, *(1,) * np.ndim(R))
        if self._isometric:
            return A / R
        found = metric(self.scene, x)
        J = found.area
        B = adjugate(root(found.G, J))
        return between(B, A) / (R * J ** (1 + self._sheet_power))

    def capacitance(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """c of the foam at rest in F per flat m², shape (...), at x of shape (2, ...)."""
        foam = self.scene.skin.foam
        c = foam.rest_capacitance_per_area * self._factors(foam.map, x)
        if self._isometric:
            return c
        return c * metric(self.scene, x).area ** (1 + self._foam_power)

    def line_stretch(
        self, x: NDArray[np.float64], direction: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Length over that at rest of a line through x, both of shape (2, ...), along a direction.

        The direction need not be of unit length. Shape (...).
        """
        along = np.asarray(direction) / np.hypot(*direction)
        if self._isometric:
            return np.ones(np.broadcast_shapes(np.shape(x)[1:], np.shape(along)[1:]))
        return np.sqrt(np.sum(np.sum(tangents(self.scene, x) * along, axis=1) ** 2, axis=0))

    @property
    def alike(self) -> bool:
        """Whether both sheets' conductances are in one ratio everywhere, pressed or not."""
        top, bottom = self.scene.skin.top, self.scene.skin.bottom
        same_maps = top.map == bottom.map or None not in (_uniform(top), _uniform(bottom))
        return (
            same_maps
            and top.piezoresistance == bottom.piezoresistance
            and np.allclose(_direction(top), _direction(bottom), rtol=1e-12, atol=1e-12)
        )

    @cached_property
    def lines(self) -> Lines:
        """Lines in m across x, and across y, at which a map's slope jumps; ascending."""
        sides, maps = self.scene.skin.sides, self.scene.skin.maps.values()
        kinks = [of_place.kinks(sides) for of_place in maps]
        found = []
        for axis, side in enumerate(sides):
            all_lines = [line for each in kinks for line in each[axis]]
            found.append(tuple(distinct([*all_lines, side], SAME_EDGE)[:-1].tolist()))
        return found[0], found[1]

    @property
    def shortest(self) -> float:
        """The least length in m over which a map varies; inf where none does."""
        maps = self.scene.skin.maps.values()
        return min((each.shortest(self.scene.skin.sides) for each in maps), default=np.inf)

    def _resistance(self, sheet: Sheet, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """At rest, ohm/sq."""
        return sheet.sheet_resistance * self._factors(sheet.map, x)

    def _factors(self, of_place, x: NDArray[np.float64]) -> NDArray[np.float64]:
        if of_place is None:
            return np.ones(np.shape(x)[1:])
        return of_place.factors(np.asarray(x, dtype=np.float64), self.scene.skin.sides)


def _uniform(sheet: Sheet) -> float | None:
    return 1.0 if sheet.map is None else sheet.map.uniform


def _direction(sheet: Sheet) -> NDArray[np.float64]:
    own = sheet.anisotropy
    return directed(own.ratio, own.angle) if own else ISOTROPIC
