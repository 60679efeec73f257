"""Which kind of mesh a press on a skin is solved on, and what mechanics makes of it first."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from simulator.circuit import Circuit, one_field, two_fields
from simulator.electrical import electrical
from simulator.materials import Materials
from simulator.press import Press
from simulator.scene import Scene
from simulator.sweeps import ToleranceError
from simulator.varied.discretised import Discretised
from simulator.varied.squares import Squares
from simulator.varied.triangles import Triangles

if TYPE_CHECKING:
    from simulator.mechanics import Pressed

MECHANICS_SHARE = 0.3
"""Of the tolerance: what the capacitance of a press may be off by."""
FACTOR_SHARE, COARSEST_FACTOR = 30.0, 1e-2
"""Of the tolerance and at most: what its factor may be off by anywhere. It is at corners alone."""


class Meshes(Protocol):
    """Discretisations of one press, each finer than the one before."""

    def finer(self, frequency: NDArray[np.float64]) -> Discretised:
        """The next one, for frequencies in Hz. Raises ToleranceError where there is none."""
        ...


class InTurn:
    """Quadrilaterals as long as there are finer ones, then triangles."""

    def __init__(self, squares: Squares, triangles: Triangles) -> None:
        self._kinds: list[Meshes] = [squares, triangles]

    def finer(self, frequency: NDArray[np.float64]) -> Discretised:
        """As of `Meshes`."""
        try:
            return self._kinds[0].finer(frequency)
        except ToleranceError:
            if len(self._kinds) == 1:
                raise
            del self._kinds[0]
            return self.finer(frequency)


def indented(scene: Scene, press: Press, rtol: float) -> tuple[Press, Pressed | None]:
    """Touches of a factor, and what mechanics makes of the others: factors too, if it can.

    rtol: the tolerance asked of Rs and Cp.
    """
    if not press.indented:
        return press, None
    from simulator.mechanics import pressed

    anywhere = min(COARSEST_FACTOR, FACTOR_SHARE * rtol)
    found = pressed(scene, press, anywhere)
    while found.mean_error > MECHANICS_SHARE * rtol:
        anywhere /= 10
        found = pressed(scene, press, anywhere)
    return (press.sharp, found) if found.sharp is None else (found.sharp, None)


def meshes(scene: Scene, press: Press, pressed: Pressed | None, rtol: float) -> Meshes:
    """Those that a scene and a press need: quadrilaterals first wherever they serve.

    press, pressed: as of `indented`.
    """
    circuit, rectangular = circuit_of(scene), scene.skin.outline is None and scene.skin.mesh is None
    triangles = Triangles(scene, circuit, press, rtol, pressed)
    if rectangular and press.plain and pressed is None:
        return InTurn(Squares(scene, circuit, press, rtol), triangles)
    return triangles


def circuit_of(scene: Scene) -> Circuit:
    """One field where both sheets and their foils vary alike."""
    even = electrical(scene)
    alike = one_field(even) if Materials(scene).alike else None
    return alike or two_fields(even)
