"""Choice of the kind of mesh for a press on a skin, after the mechanics of the press."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Protocol

from ...arrays import Real
from ...fem.circuit import Circuit, one_field, two_fields
from ...fem.system import check_grid_fits
from ...press.press import Press
from ...progress import ProgressCallback, silent
from ...scene.parts import Setup, Skin
from ...sweeps import ToleranceError
from .coefficients import raised_by_deflection
from .discretised import Discretised
from .materials import Materials
from .press_cache import PressPlace
from .pressed_system import check_surroundings
from .square_meshes import Squares
from .triangle_meshes import Triangles

if TYPE_CHECKING:
    from ..mechanics.deformation import Deformation

MECHANICS_SHARE = 0.3
"""Share of the tolerance for the error of mechanics."""
MIN_ERROR_RATIO = 0.3
"""Smallest ratio by which the error of mechanics is reduced at once."""
FACTOR_SHARE, COARSEST_FACTOR = 30.0, 1e-2
"""Tolerance of the capacitance factor anywhere over the tolerance of Rs and Cp, and its maximum.
The error is that large at corners only."""


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


class DeflectedTriangles:
    """Triangles of a deflected skin; mechanics is refined as far as Rs and Cp need it."""

    def __init__(
        self, place: PressPlace, triangles: Triangles, pressed: Deformation, rtol: float
    ) -> None:
        """place: keeps the latest triangles. pressed: their deformation."""
        self._place, self._rtol = place, rtol
        self._pressed, place.triangles = pressed, triangles

    def finer(self, frequency: Real) -> Discretised:
        """Next discretisation; see `MeshSequence`."""
        most, triangles = MECHANICS_SHARE * self._rtol, self._place.triangles
        assert triangles is not None
        while True:
            found = triangles.finer(frequency)
            raised, closer = raised_by_deflection(found.coefficients), self._pressed.within_error
            if raised is None or closer is None:
                return found
            error = found.changes(raised, frequency, self._rtol)
            if error.max() <= most:
                return replace(found, deflection_error=error)
            self._pressed = closer(max(MIN_ERROR_RATIO, most / error.max()) * self._pressed.error)
            self._place.triangles = triangles = triangles.for_other_depths(self._pressed)


def deformed(
    skin: Skin,
    press: Press,
    rtol: float,
    progress: ProgressCallback = silent,
    place: PressPlace | None = None,
) -> tuple[Press, Deformation | None]:
    """Touches with a factor, and the deformation by the other touches.

    If possible, the other touches become factors, too, and the deformation is None.

    rtol: tolerance of Rs and Cp. progress: see `ProgressCallback`. place: cache of the pressed
    place.
    """
    if not press.indented:
        return press, None
    from ..mechanics.indentation import deformation

    found = deformation(
        skin,
        press,
        min(COARSEST_FACTOR, FACTOR_SHARE * rtol),
        progress,
        place and place.deflections,
    )
    return (press.on_patches, found) if found.sharp is None else (found.sharp, None)


def meshes(
    skin: Skin,
    setup: Setup,
    press: Press,
    pressed: Deformation | None,
    rtol: float,
    place: PressPlace | None = None,
) -> MeshSequence:
    """Sequence of meshes for a scene and a press: quadrilaterals first where they are suitable.

    press, pressed: see `deformed`. place: cache of the pressed place, with the triangles of the
    last press there. Raises InputError for surroundings that elements cannot represent.
    """
    check_surroundings(skin)
    if pressed is not None and place and place.triangles:
        return DeflectedTriangles(place, place.triangles.for_other_depths(pressed), pressed, rtol)
    circuit, rectangular = circuit_of(skin, setup), skin.outline is None and skin.mesh is None
    if pressed is not None:
        first = Triangles(skin, circuit, press, rtol, pressed)
        return DeflectedTriangles(place or PressPlace(), first, pressed, rtol)
    if rectangular:
        check_grid_fits(skin, circuit)
    triangles = Triangles(skin, circuit, press, rtol)
    if rectangular and press.boxes:
        return SquaresThenTriangles(Squares(skin, circuit, press, rtol), triangles)
    return triangles


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
