"""Elements for any skin and press: the kinds of mesh, and the mechanics of the press."""

from __future__ import annotations

from collections.abc import MutableMapping
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Protocol
from weakref import WeakKeyDictionary

from ...arrays import Complex, Real
from ...fem.circuit import Circuit, one_field, two_fields
from ...fem.system import check_grid_fits
from ...press.press import Press
from ...progress import ProgressCallback
from ...scene.parts import Setup, Skin
from ...sweeps import InputError, ToleranceError
from ..model import GivenPress, Model, PressPlace
from ..solution import SolutionProgress
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
    """Elements for any skin and any press: quadrilaterals first where they are suitable.

    rtol: tolerance of Rs and Cp, or of gains.
    """

    name = "sheet"

    def __init__(self, skin: Skin, setup: Setup, rtol: float) -> None:
        self.skin, self.setup, self.rtol = skin, setup, rtol
        self._latest = WeakKeyDictionary[PressPlace, Triangles]()

    def check(self, press: GivenPress) -> None:
        """Raises InputError for uniform skins and presses, which elements on pixels solve."""
        if press.uniform is not None:
            raise InputError("skin and press are uniform")

    def solve(self, press: GivenPress, progress: SolutionProgress) -> None:
        """Offers results on one mesh after the other; see `Model`."""
        finer = self.meshes(press)
        while not progress.done:
            try:
                discretised = finer.finer(progress.frequency)
            except ToleranceError as end:
                reasons = ": ".join([str(end), *progress.rejected[-1:]])
                raise ToleranceError(reasons, end.times) from end
            progress.offer(discretised.result(progress.frequency, self.rtol))

    def resolved(
        self, press: GivenPress, frequency: Real, callback: ProgressCallback
    ) -> tuple[Discretised, Complex]:
        """Mesh that keeps the tolerance at all frequencies in Hz, and Z on it in ohm.

        Z has the shape (interface, frequency). Raises ToleranceError as `solve` does.
        """
        finer, remaining = self.meshes(press), RemainingTime(self.rtol)
        solving = f"solving, frequencies: {frequency.size}"
        callback(solving)
        while True:
            discretised = finer.finer(frequency)
            result = discretised.result(frequency, self.rtol)
            callback(solving, remaining.share(float(result.error.max())))
            if result.error.max() <= self.rtol:
                return discretised, result.Z

    def meshes(self, press: GivenPress) -> MeshSequence:
        """Sequence of meshes for a press.

        Raises InputError for surroundings that elements cannot represent.
        """
        check_surroundings(self.skin)
        sharp, pressed = press.sharp, press.deformation
        if pressed is not None:
            latest = self._latest.get(press.place)
            self._latest[press.place] = (
                latest.for_other_depths(pressed) if latest else self._triangles(sharp, pressed)
            )
            return DeflectedTriangles(self._latest, press.place, pressed, self.rtol)
        triangles = self._triangles(sharp)
        if self.skin.outline is not None or self.skin.mesh is not None:
            return triangles
        check_grid_fits(self.skin, self._circuit)
        if not sharp.boxes:
            return triangles
        squares = Squares(self.skin, self._circuit, sharp, self.rtol)
        return SquaresThenTriangles(squares, triangles)

    def _triangles(self, press: Press, pressed: Deformation | None = None) -> Triangles:
        return Triangles(self.skin, self._circuit, press, self.rtol, pressed)

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
