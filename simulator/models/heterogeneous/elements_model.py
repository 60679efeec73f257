"""Elements for any skin and press: the kinds of mesh, and the mechanics of the press."""

from __future__ import annotations

from collections.abc import MutableMapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Protocol
from weakref import WeakKeyDictionary

import numpy as np

from ...arrays import Complex, Real
from ...fem.circuit import Circuit, one_field, two_fields
from ...fem.system import check_grid_fits
from ...press.press import Press, check_fingers
from ...progress import ProgressCallback, silent
from ...scene.parts import Setup, Skin
from ...sweeps import ToleranceError
from ..model import DEFAULT_RTOL, GivenPress, Model, Presses, PressPlace
from ..solution import Answer, SolutionFields
from ..time_estimate import RemainingTime
from .coefficients import raised_by_deflection
from .discretised import Discretised
from .materials import Materials
from .pressed_system import check_surroundings
from .square_meshes import Squares
from .triangle_meshes import Triangles

if TYPE_CHECKING:
    from ..mechanics.deformation import Deformation

MECHANICS_SHARE = 0.3
"""Share of the tolerance for the error of mechanics."""
MIN_ERROR_RATIO = 0.3
"""Smallest ratio by which the error of mechanics is reduced at once."""


class MeshSequence(Protocol):
    """Discretisations of one press, each finer than the one before."""

    def finer(self, frequency: Real) -> Discretised:
        """Next discretisation, for frequencies in Hz. Raises ToleranceError if there is none."""
        ...


class SquaresThenTriangles:
    """Quadrilaterals as long as there are finer ones, then triangles."""

    def __init__(self, squares: Squares, triangles: Triangles) -> None:
        self._kinds: list[MeshSequence] = [squares, triangles]

    def finer(self, frequency: Real) -> Discretised:
        """Next discretisation; see `MeshSequence`."""
        try:
            return self._kinds[0].finer(frequency)
        except ToleranceError:
            if len(self._kinds) == 1:
                raise
            del self._kinds[0]
            return self.finer(frequency)


Latest = MutableMapping[PressPlace, Triangles]
"""Latest triangles of each pressed place."""


class DeflectedTriangles:
    """Triangles of a deflected skin; mechanics is refined as far as Rs and Cp need it."""

    def __init__(
        self, latest: Latest, place: PressPlace, pressed: Deformation, rtol: float
    ) -> None:
        """latest: of the place to begin with, and kept up to date. pressed: their deformation."""
        self._latest, self._place, self._pressed, self._rtol = latest, place, pressed, rtol

    def finer(self, frequency: Real) -> Discretised:
        """Next discretisation; see `MeshSequence`."""
        most, triangles = MECHANICS_SHARE * self._rtol, self._latest[self._place]
        while True:
            found = triangles.finer(frequency)
            raised, closer = raised_by_deflection(found.coefficients), self._pressed.within_error
            if raised is None or closer is None:
                return found
            error = found.changes(raised, frequency, self._rtol)
            if error.max() <= most:
                return replace(found, deflection_error=error)
            self._pressed = closer(max(MIN_ERROR_RATIO, most / error.max()) * self._pressed.error)
            triangles = triangles.for_other_depths(self._pressed)
            self._latest[self._place] = triangles


class Elements(Model):
    """Elements for any skin and any press: quadrilaterals first where they are suitable."""

    name, seconds = "elements", 2e-3

    def __init__(self, skin: Skin, setup: Setup) -> None:
        self.skin, self.setup = skin, setup
        self._latest = WeakKeyDictionary[PressPlace, Triangles]()

    def refuses(self, press: GivenPress) -> str | None:
        """See `Domain`: uniform skins and presses, which elements on pixels solve."""
        return None if press.uniform is None else "skin and press are uniform"

    def solve(self, press: Presses, frequency: Real, rtol: float = DEFAULT_RTOL) -> Answer:
        """See `Model`; it stops where the finest mesh does not keep the tolerance."""
        given = self._given(press, rtol)
        finer, progress = self._meshes(given, rtol), self._progress(given, frequency, rtol)
        while not progress.done:
            try:
                discretised = finer.finer(progress.frequency)
            except ToleranceError as end:
                reasons = ": ".join([str(end), *progress.rejected[-1:]])
                return progress.answer(ToleranceError(reasons, end.times))
            progress.offer(discretised.result(progress.frequency, rtol))
        return progress.answer()

    def fields(
        self,
        press: Press,
        frequencies: Sequence[float],
        interface: str,
        rtol: float = 1e-3,
        progress: ProgressCallback = silent,
    ) -> SolutionFields:
        """Fields of a press, see `Model`.

        They are solved on the flat, unpressed skin, on a mesh that keeps the tolerance of Rs and
        Cp; currents and power are per length and area of the flat skin.
        """
        from .solution_fields import solution_fields

        check_fingers(press, self.skin)
        frequency = np.array(sorted(frequencies), dtype=np.float64)
        excitation = self.setup.names.index(self.setup.checked_name(interface))
        given = GivenPress(self.skin, press, rtol, callback=progress)
        found = self._resolved(given, frequency, rtol)
        return solution_fields(self.setup, given, *found, frequency, excitation)

    def _resolved(
        self, press: GivenPress, frequency: Real, rtol: float
    ) -> tuple[Discretised, Complex]:
        """Mesh that keeps the tolerance at all frequencies in Hz, and Z on it in ohm.

        Z has the shape (interface, frequency). Raises ToleranceError if no mesh keeps it.
        """
        finer, remaining = self._meshes(press, rtol), RemainingTime(rtol)
        solving = f"solving, frequencies: {frequency.size}"
        press.callback(solving)
        while True:
            discretised = finer.finer(frequency)
            result = discretised.result(frequency, rtol)
            press.callback(solving, remaining.share(float(result.error.max())))
            if result.error.max() <= rtol:
                return discretised, result.Z

    def _meshes(self, press: GivenPress, rtol: float) -> MeshSequence:
        """Sequence of meshes for a press.

        Raises InputError for surroundings that elements cannot represent.
        """
        check_surroundings(self.skin)
        sharp, pressed = press.sharp, press.deformation
        if pressed is not None:
            latest = self._latest.get(press.place)
            self._latest[press.place] = (
                latest.for_other_depths(pressed)
                if latest
                else self._triangles(sharp, rtol, pressed)
            )
            return DeflectedTriangles(self._latest, press.place, pressed, rtol)
        triangles = self._triangles(sharp, rtol)
        if self.skin.outline is not None or self.skin.mesh is not None:
            return triangles
        check_grid_fits(self.skin, self._circuit)
        if not sharp.boxes:
            return triangles
        squares = Squares(self.skin, self._circuit, sharp, rtol)
        return SquaresThenTriangles(squares, triangles)

    def _triangles(
        self, press: Press, rtol: float, pressed: Deformation | None = None
    ) -> Triangles:
        return Triangles(self.skin, self._circuit, press, rtol, pressed)

    @cached_property
    def _circuit(self) -> Circuit:
        return circuit_of(self.skin, self.setup)


def circuit_of(skin: Skin, setup: Setup, same_sheets: bool = True) -> Circuit:
    """Circuit with one field if both sheets and their foils vary in the same way, else with two.

    same_sheets: True if they vary in the same way on all skins that share the model.
    """
    return (single_field(skin, setup) if same_sheets else None) or two_fields(
        skin.electrical, setup
    )


def single_field(skin: Skin, setup: Setup) -> Circuit | None:
    """Circuit of the potential difference; None where it would not be exact."""
    return one_field(skin.electrical, setup) if Materials(skin).same_sheets else None
