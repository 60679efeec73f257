"""Models of a uniform skin: the exact line, one R and one C, and elements of growing order.

The error of elements is estimated by elements of one order more on the same mesh: the output error
is the square of the field's, so their difference is the error.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..arrays import Real
from ..fem.circuit import one_field, two_fields
from ..fem.error_estimate import ROUNDING, UNIFORM, relative_difference
from ..fem.terminals import impedance_with_error
from ..mesh.quadrilaterals import Resolution
from ..method_cache import cached_method
from ..press.press import Press
from ..press.press import require_plain as require_plain_press
from ..scene.parts import Setup, Skin
from ..sweeps import InputError
from .line import Line
from .lumped import Lumped, min_truncation_error
from .model import GivenPress, Model
from .resolution import ResolutionHierarchy
from .sheet_model import SheetModel
from .solution import ModelResult, SolutionProgress
from .uniform import require_uniform

GAIN = 0.1
SHEETS_KEPT = 16
GRIDS_KEPT = 256
LUMPED = "one R and one C"


class UniformSheets:
    """Sheet models of a uniform skin, shared by presses and models; the oldest are dropped.

    rtol: tolerance of Rs and Cp, or of gains.
    """

    def __init__(self, skin: Skin, setup: Setup, rtol: float) -> None:
        self.skin, self._setup, self.rtol = skin, setup, rtol
        self.kept: dict[Resolution, SheetModel] = {}

    @property
    def first(self) -> int:
        """First level to try."""
        return self._hierarchy.first(self.rtol)

    @property
    def levels(self) -> int:
        """Number of levels."""
        return len(self._hierarchy.levels)

    def of(self, level: int, press: Press, frequency: float) -> SheetModel:
        """Sheet model of a level for a press up to a frequency in Hz."""
        resolution = self._hierarchy.resolution(level, press, frequency)
        if resolution not in self.kept:
            if len(self.kept) == SHEETS_KEPT:
                del self.kept[next(iter(self.kept))]
            circuit = self._hierarchy.circuit
            self.kept[resolution] = SheetModel(self.skin, circuit, resolution)
        return self.kept[resolution]

    @cached_property
    def _hierarchy(self) -> ResolutionHierarchy:
        circuit = one_field(self.skin, self._setup) or two_fields(self.skin, self._setup)
        return ResolutionHierarchy(self.skin, circuit)


class UniformModel(Model):
    """A model of uniform skins under presses by factors of pixels and rectangles."""

    def check(self, press: GivenPress) -> None:
        """Raises InputError if skin or press are not uniform."""
        if press.uniform is None:
            what = f"the model {self.name!r}"
            require_uniform(press.skin.electrical, what)
            require_plain_press(press.press)
            raise InputError(
                f"press {press.press}: {what} cannot take a press that the foam's tension spreads"
            )

    def solve(self, press: GivenPress, progress: SolutionProgress) -> None:
        """Offers results for the press on `Skin.electrical`; see `Model`."""
        assert press.uniform is not None
        self._solve(press.uniform, progress)

    @abstractmethod
    def _solve(self, press: Press, progress: SolutionProgress) -> None: ...


class ExactLine(UniformModel):
    """The exact line; skins that are none are refused with the reason."""

    name = "line"

    def __init__(self, skin: Skin, setup: Setup) -> None:
        self._given = skin, setup

    def _solve(self, press: Press, progress: SolutionProgress) -> None:
        if isinstance(self._line, str):
            raise InputError(self._line)
        Z = self._line.impedance(press, progress.frequency)
        progress.offer(ModelResult("exact line", 0, Z, np.full((2, *Z.shape), ROUNDING)))

    @cached_property
    def _line(self) -> Line | str:
        """Exact line model of the skin, or the reason why there is none."""
        try:
            return Line(*self._given)
        except InputError as no_line:
            return str(no_line)


class OneRC(UniformModel):
    """One R and one C, of elements."""

    name = "lumped"

    def __init__(self, sheets: UniformSheets, bound_first: bool) -> None:
        """bound_first: True if it is tried only where it suffices without a press."""
        self._sheets, self._bound_first = sheets, bound_first

    def _solve(self, press: Press, progress: SolutionProgress) -> None:
        frequency, sheets = progress.frequency, self._sheets
        unpressed = self._unpressed_error(tuple(frequency)) if self._bound_first else 0.0
        if unpressed > sheets.rtol:
            return progress.reject(
                f"{LUMPED}: error of the unpressed skin is {unpressed:.1e} of Rs or Cp or more"
            )
        sheet = sheets.of(sheets.first, press, frequency[-1])
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
        sheets = self._sheets
        least = min_truncation_error(sheets.skin, frequency[-1])
        if least > sheets.rtol:
            return least
        sheet = sheets.of(sheets.first, Press(), frequency[-1])
        left_out = Lumped(sheet, sheet.nested).truncation_error(Press(), np.array(frequency))
        return float(left_out.max())


class UniformElements(UniformModel):
    """Elements of growing order on pixels."""

    name = "sheet"

    def __init__(self, sheets: UniformSheets) -> None:
        self._sheets = sheets

    def _solve(self, press: Press, progress: SolutionProgress) -> None:
        level = self._sheets.first
        while not progress.done and level < self._sheets.levels:
            result = self._result(level, press, progress.frequency)
            progress.offer(result)
            level += self._levels_ahead(float(result.error.max()))

    def _levels_ahead(self, error: float) -> int:
        """Number of levels after which the tolerance is likely to be kept, if each gains GAIN."""
        if not math.isfinite(error):
            return 1
        return max(1, math.floor(math.log(self._sheets.rtol / error) / math.log(GAIN)))

    def _result(self, level: int, press: Press, frequency: Real) -> ModelResult:
        sheet = self._sheets.of(level, press, frequency[-1])
        circuit = sheet.circuit
        Z, error = impedance_with_error(
            lambda f, rtol: sheet.forms(press, f, rtol, sheet.nested, sheet.space),
            circuit.excitations,
            frequency,
            self._sheets.rtol,
        )
        answered = replace(sheet.resolution, order=sheet.resolution.order - 1)
        name = f"2-D elements, {circuit.description}, {answered}"
        return ModelResult(name, sheet.nested.inner, Z, error)
