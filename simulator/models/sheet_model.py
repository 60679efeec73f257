"""The skin in two dimensions: finite elements for one or two fields, any contacts, any press."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy.sparse import csc_matrix

from ..arrays import Complex, Real
from ..fem.circuit import Circuit
from ..fem.error_estimate import Swept
from ..fem.factors import one_blas_thread
from ..fem.galerkin import Galerkin
from ..fem.sweep import swept
from ..fem.system import build_system
from ..fem.terminals import Network
from ..mesh.quadrilaterals import Resolution, tile_lines
from ..press.capacitance import capacitance_map, lines, tile_map
from ..press.press import Press
from ..scene.frequency import laplace_variable
from ..scene.parts import Skin
from ..scene.planar import NO_LINES
from ..sweeps import InputError


class SheetModel:
    """A scene discretised once, solved for any press and frequency."""

    def __init__(self, skin: Skin, circuit: Circuit, resolution: Resolution) -> None:
        self.skin, self.circuit = skin, circuit
        self.resolution = resolution
        self.system = build_system(skin, circuit, resolution)
        self.space = Galerkin(self.system, circuit, resolution.order)
        self._filled: tuple[Press, csc_matrix] | None = None

    @cached_property
    def nested(self) -> Galerkin:
        """Galerkin space on the same mesh with elements of one order less."""
        return Galerkin(self.system, self.circuit, self.resolution.order - 1)

    @property
    def unknowns(self) -> int:
        """Size of the sparse system."""
        return self.space.inner

    def impedance(self, press: Press, frequency: Real) -> Complex:
        """Z in ohm at every interface, shape (interface, frequency). frequency: Hz.

        One complex system for each frequency: the reference for faster methods.
        """
        network = self.network(press, frequency)
        return np.stack([network.impedance(excitation) for excitation in self.circuit.excitations])

    def network(self, press: Press, frequency: Real) -> Network:
        """N-terminal network at these frequencies in Hz."""
        with one_blas_thread():
            return self.space.network(self.mass(press), self._s(frequency))

    def sweep(
        self, press: Press, frequency: Real, rtol: float, *spaces: Galerkin
    ) -> list[tuple[Complex, Real]]:
        """Z in ohm and the relative error in Rs and Cp of its real solves.

        One pair for each of `spaces`, or for the whole space; of shape (interface, frequency).
        frequency: Hz. rtol: tolerance of the solves.
        """
        found, combined = self.forms(press, frequency, rtol, *spaces), self.circuit.combination
        return [(combined.impedance(Q), error) for Q, error in found]

    def forms(self, press: Press, frequency: Real, rtol: float, *spaces: Galerkin) -> list[Swept]:
        """Forms of the excitations in S, in place of Z; see `sweep`."""
        mass, s = self.mass(press), self._s(frequency)
        with one_blas_thread():
            return [
                swept(space, mass, self.circuit.excitations, s, rtol)
                for space in spaces or (self.space,)
            ]

    def mass(self, press: Press) -> csc_matrix:
        """M in F of a press, in the system's pattern.

        Raises InputError if a touch ends within the cells between the mesh's lines.
        """
        if self._filled is None or self._filled[0] != press:
            self._filled = press, self.system.mass(self._capacitance(press))
        return self._filled[1]

    def _capacitance(self, press: Press) -> Real:
        """c in F/m² between the lines of the mesh, shape (row, column)."""
        if self.resolution.lines == NO_LINES:
            return capacitance_map(self.skin, press)
        for own, of_touches in zip(self.resolution.lines, lines(self.skin, press), strict=True):
            if not set(of_touches) <= set(own):
                raise InputError(f"press {press} has edges that the mesh does not conform to")
        x, y = (tile_lines(self.skin, axis, self.resolution) for axis in (0, 1))
        return self.skin.foam.unpressed_capacitance_per_area * tile_map(self.skin, press, x, y)

    def moments(self, press: Press, count: int) -> Real:
        """Taylor coefficients of the network's Y(s), shape (count + 1, N, N)."""
        return self.space.moments(self.mass(press), count)

    def _s(self, frequency: Real) -> Complex:
        return laplace_variable(frequency, self.skin.foam.loss)
