"""As `full`, in the small basis of a model that is trained for all terminals of a skin.

dY = u'(dK + s dM + ds M) u with the potentials u of 1 V.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...fem.circuit import two_fields
from ...fem.factors import one_blas_thread
from ...models.network.terminals import chain, read
from ...models.parameters import by_sheets
from ...models.plain import electrical
from ...models.reduced.cases import Case
from ...models.reduced.families.resolving import unreduced
from ...models.reduced.greedy import Basis
from ...models.reduced.model import Reduced
from ...models.response import Response, at_meter
from ...progress import silent
from ...scene.frequency import laplace_variable, slopes_of_s
from ...scene.scene import Scene
from ..touches.cells import Cells, TouchSize
from .full import CELLS_PER_PIXEL, NONE, Maps
from .full import RTOL as MESH_RTOL
from .pressed import PressedSkin

RTOL = 4e-4


class ReducedFields:
    """A scene on the cells of a grid, under touches alike, at any frequencies up to `highest`."""

    def __init__(
        self, scene: Scene, highest: float, touch: TouchSize, cells: int = CELLS_PER_PIXEL
    ) -> None:
        """cells: along each side of a pixel. highest: Hz. Raises ToleranceError where the scene
        does not reduce."""
        self.scene, self.cells = scene, cells
        self.grid = scene.divided(cells).pixels.shape
        self._touch = touch
        model = self._trained(electrical(scene.on_grid(*self.grid)), highest)
        self._skin = read(model, scene.interfaces).skin(None)
        self._pressed = PressedSkin(self._skin)

    def respond(
        self,
        factors: NDArray[np.float64],
        directions: Maps,
        frequency: NDArray[np.float64],
        of_foam: Maps = NONE,
    ) -> Response:
        """Of one map of c, as `Fields` does."""
        s = laplace_variable(frequency, self.scene.skin.foam.loss)
        with one_blas_thread():
            M = self._pressed.rest + self._pressed.mass(factors - 1)
            u = self._pressed.solved(M, s)
            maps = {**directions, **of_foam}
            by = {name: s * u.energy(self._pressed.mass(change)) for name, change in maps.items()}
            by_s = u.energy(M)
            by_K = np.stack([u.energy(term) for term in self._stiffness])
        of_s = slopes_of_s(frequency, self.scene.skin.foam.loss)
        by |= {name: by_s * of_s[name] for name in ("capacitance", "loss_tangent")}
        by |= by_sheets(by_K[:2], *self.scene.skin.sheet_resistances)
        if len(by_K) > 2:
            by["contact_resistance"] = -by_K[2:].sum(axis=0)
        return at_meter(1 / u.Y, by, self.scene.leads, frequency)

    def _trained(self, scene: Scene, highest: float) -> Reduced:
        """A basis that a batch of fresh touches is told in, on the mesh that `Fields` takes."""
        random = np.random.default_rng(0)
        with one_blas_thread():
            circuit = two_fields(scene).read(chain(scene))
            family = unreduced(scene, circuit, MESH_RTOL, highest)
            band = np.array([self.scene.frequencies[0], highest])
            return Basis(family, RTOL, 0.0, band).grow(self._draw, random, silent, most=1)

    def _draw(self, random: np.random.Generator) -> Case:
        """A touch anywhere on the skin."""
        cells = Cells.of(self.scene.skin.length, self.scene.skin.width, self.grid)
        return Case(None, *cells.drawn(self._touch, random))

    @cached_property
    def _stiffness(self) -> NDArray[np.float64]:
        """K of each sheet, then of each film, in S."""
        turn = self._skin.turn
        return turn.T @ self._skin.reduced.stiffness @ turn
