"""Models of a uniform scene: the exact line, one R and one C, and elements of growing order.

The error of elements is estimated by elements of one order more on the same mesh: the output error
is the square of the field's, so their difference is the error.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..arrays import Real
from ..fem.circuit import Circuit, one_field, two_fields
from ..fem.error_estimate import ROUNDING, UNIFORM, relative_difference
from ..fem.terminals import impedance_with_error
from ..mesh.quadrilaterals import Resolution
from ..method_cache import cached_method
from ..press.press import Press
from ..scene.parts import Setup, Skin
from ..sweeps import InputError
from .line import Line
from .lumped import Lumped, min_truncation_error
from .resolution import ResolutionHierarchy
from .sheet_model import SheetModel
from .solution import ModelResult, SolutionProgress

GAIN = 0.1
SHEETS_KEPT = 16
GRIDS_KEPT = 256
LUMPED = "one R and one C"


class UniformModels:
    """Models of a uniform scene without training; each offers its result to a solution."""

    def __init__(self, skin: Skin, setup: Setup, rtol: float, bound_first: bool) -> None:
        """bound_first: True if one R and one C is tried only where it suffices without a press."""
        self.skin, self.setup = skin, setup
        self.rtol, self._bound_first = rtol, bound_first
        self._sheets: dict[Resolution, SheetModel] = {}

    def line(self, press: Press, progress: SolutionProgress) -> None:
        """Offer the result of the exact line. Raises InputError if it does not apply."""
        if isinstance(self._exact_line, str):
            raise InputError(self._exact_line)
        Z = self._exact_line.impedance(press, progress.frequency)
        progress.offer(ModelResult("exact line", 0, Z, np.full((2, *Z.shape), ROUNDING)))

    @cached_property
    def _exact_line(self) -> Line | str:
        """Exact line model of the scene, or the reason why there is none."""
        try:
            return Line(self.skin, self.setup)
        except InputError as no_line:
            return str(no_line)

    def lumped(self, press: Press, progress: SolutionProgress) -> None:
        """Offer the result of one R and one C. Raises InputError if it does not apply."""
        frequency = progress.frequency
        unpressed = self._unpressed_error(tuple(frequency)) if self._bound_first else 0.0
        if unpressed > self.rtol:
            return progress.reject(
                f"{LUMPED}: error of the unpressed skin is {unpressed:.1e} of Rs or Cp or more"
            )
        sheet = self._sheet(self._hierarchy.resolution(self._first_level, press, frequency[-1]))
        lumped, finer = Lumped(sheet, sheet.nested), Lumped(sheet)
        Z = lumped.impedance(press, frequency)
        resolved = UNIFORM * relative_difference(Z, finer.impedance(press, frequency))
        error = resolved + lumped.truncation_error(press, frequency) + ROUNDING
        return progress.offer(ModelResult(LUMPED, sheet.nested.inner, Z, error))

    @cached_method(GRIDS_KEPT)
    def _unpressed_error(self, frequency: tuple[float, ...]) -> float:
        """Largest relative error of Rs and Cp by one R and one C for the unpressed skin.

        If even the short line with the smallest error exceeds the tolerance, the skin is not
        solved.
        """
        least = min_truncation_error(self.skin, frequency[-1])
        if least > self.rtol:
            return least
        sheet = self._sheet(self._hierarchy.resolution(self._first_level, Press(), frequency[-1]))
        left_out = Lumped(sheet, sheet.nested).truncation_error(Press(), np.array(frequency))
        return float(left_out.max())

    def elements(self, press: Press, progress: SolutionProgress) -> None:
        """Offer the results of elements of growing order until all frequencies have one."""
        level = self._first_level
        while not progress.done and level < len(self._hierarchy.levels):
            result = self._element_result(level, press, progress.frequency)
            progress.offer(result)
            level += self._levels_ahead(float(result.error.max()))

    def _levels_ahead(self, error: float) -> int:
        """Number of levels after which the tolerance is likely to be kept, if each gains GAIN."""
        if not math.isfinite(error):
            return 1
        return max(1, math.floor(math.log(self.rtol / error) / math.log(GAIN)))

    def _element_result(self, level: int, press: Press, frequency: Real) -> ModelResult:
        sheet = self._sheet(self._hierarchy.resolution(level, press, frequency[-1]))
        Z, error = impedance_with_error(
            lambda f, rtol: sheet.forms(press, f, rtol, sheet.nested, sheet.space),
            self._circuit.excitations,
            frequency,
            self.rtol,
        )
        answered = replace(sheet.resolution, order=sheet.resolution.order - 1)
        name = f"2-D elements, {self._circuit.description}, {answered}"
        return ModelResult(name, sheet.nested.inner, Z, error)

    def _sheet(self, resolution: Resolution) -> SheetModel:
        """Sheet model at a resolution; the oldest ones are dropped, because they are large."""
        if resolution not in self._sheets:
            if len(self._sheets) == SHEETS_KEPT:
                del self._sheets[next(iter(self._sheets))]
            self._sheets[resolution] = SheetModel(self.skin, self._circuit, resolution)
        return self._sheets[resolution]

    @cached_property
    def _circuit(self) -> Circuit:
        return one_field(self.skin, self.setup) or two_fields(self.skin, self.setup)

    @cached_property
    def _hierarchy(self) -> ResolutionHierarchy:
        return ResolutionHierarchy(self.skin, self._circuit)

    @cached_property
    def _first_level(self) -> int:
        return self._hierarchy.first(self.rtol)
