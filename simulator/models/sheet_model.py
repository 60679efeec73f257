"""The uniform skin in two dimensions: elements of growing order for one or two fields.

The error of elements is estimated by elements of one order more on the same mesh: the output error
is the square of the field's, so their difference is the error.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property

import numpy as np
from scipy.sparse import csc_matrix

from ..arrays import Complex, Real
from ..fem.circuit import Circuit, one_field, two_fields
from ..fem.error_estimate import Swept
from ..fem.factors import one_blas_thread
from ..fem.galerkin import Galerkin
from ..fem.sweep import swept
from ..fem.system import build_system
from ..fem.terminals import Network, impedance_with_error
from ..mesh.quadrilaterals import Resolution, tile_lines
from ..press.capacitance import capacitance_map, lines, tile_map
from ..press.press import Press
from ..scene.frequency import laplace_variable
from ..scene.parts import Setup, Skin
from ..scene.planar import NO_LINES
from ..sweeps import InputError
from .model import DEFAULT_RTOL, Presses, UniformModel
from .resolution import ResolutionHierarchy
from .solution import Answer, ModelResult


class SheetModel:
    """A uniform skin on one mesh, solved for any press and frequency."""

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


GAIN = 0.1
SHEETS_KEPT = 16


class UniformSheets:
    """Discretisations of a uniform skin, shared by presses and models; the oldest are dropped."""

    def __init__(self, skin: Skin, setup: Setup) -> None:
        self.skin, self.setup = skin, setup
        self.kept: dict[Resolution, SheetModel] = {}

    def first(self, rtol: float) -> int:
        """First level to try. rtol: tolerance of Rs and Cp."""
        return self._hierarchy.first(rtol)

    @property
    def levels(self) -> int:
        """Number of levels."""
        return len(self._hierarchy.levels)

    def of(self, level: int, press: Press, frequency: float) -> SheetModel:
        """Discretisation of a level for a press up to a frequency in Hz."""
        resolution = self._hierarchy.resolution(level, press, frequency)
        if resolution not in self.kept:
            if len(self.kept) == SHEETS_KEPT:
                del self.kept[next(iter(self.kept))]
            circuit = self._hierarchy.circuit
            self.kept[resolution] = SheetModel(self.skin, circuit, resolution)
        return self.kept[resolution]

    @cached_property
    def _hierarchy(self) -> ResolutionHierarchy:
        circuit = one_field(self.skin, self.setup) or two_fields(self.skin, self.setup)
        return ResolutionHierarchy(self.skin, circuit)


class Sheet(UniformModel):
    """Elements of growing order on pixels."""

    name, seconds = "sheet", 1e-4

    def __init__(self, sheets: UniformSheets) -> None:
        self._sheets, self.skin, self.setup = sheets, sheets.skin, sheets.setup

    def solve(self, press: Presses, frequency: Real, rtol: float = DEFAULT_RTOL) -> Answer:
        """See `Model`; levels that are likely not to keep the tolerance are left out."""
        given = self._given(press, rtol)
        uniform, progress = self._uniform(given), self._progress(given, frequency, rtol)
        level = self._sheets.first(rtol)
        while not progress.done and level < self._sheets.levels:
            result = self._result(level, uniform, progress.frequency, rtol)
            progress.offer(result)
            level += _levels_ahead(float(result.error.max()), rtol)
        return progress.answer()

    def _result(self, level: int, press: Press, frequency: Real, rtol: float) -> ModelResult:
        sheet = self._sheets.of(level, press, frequency[-1])
        circuit = sheet.circuit
        Z, error = impedance_with_error(
            lambda f, rtol: sheet.forms(press, f, rtol, sheet.nested, sheet.space),
            circuit.excitations,
            frequency,
            rtol,
        )
        answered = replace(sheet.resolution, order=sheet.resolution.order - 1)
        name = f"2-D elements, {circuit.description}, {answered}"
        return ModelResult(name, sheet.nested.inner, Z, error)


def _levels_ahead(error: float, rtol: float) -> int:
    """Number of levels after which the tolerance is likely to be kept, if each gains GAIN."""
    if not math.isfinite(error):
        return 1
    return max(1, math.floor(math.log(rtol / error) / math.log(GAIN)))
