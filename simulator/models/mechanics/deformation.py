"""Deformation of the foam by a press of given depth or force, and the limits of depth and force."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from ...arrays import Real
from ...press.press import Press
from ...press.touch import Depth
from ...scene.foam_mechanics import Mechanics
from ...scene.planar import Circle
from ...scene.skin import SheetsAndFoam
from ...sweeps import InputError


@dataclass(frozen=True)
class Deformation:
    """The skin under the touches of a press that have a depth or a force.

    Touches of a given factor are not included: they multiply the factor. thickness: of the foam, m.
    w: deflection in m at flat positions (2, ...) in m. depth [m], force [N]: of each applicator, in
    order. error: bound on the relative error of `factor` anywhere. kinks: circles and closed
    polylines (point, 2) in m; these are the edges of applicators, at which `factor` has a kink, or
    a jump without tension. sharp: the equivalent press by factors; None with tension and if
    applicators overlap. out_of_round: relative error of Rs and Cp by polygons in place of discs.
    uncertainty: possible error of w, m, a function like w; None if w is exact. within_error: solves
    the same press within another `error`.
    """

    mechanics: Mechanics | None
    thickness: float
    w: Callable[[Real], Real]
    depth: tuple[float, ...]
    force: tuple[float, ...]
    error: float
    kinks: tuple[Circle | Real, ...]
    sharp: Press | None
    out_of_round: float = 0.0
    uncertainty: Callable[[Real], Real] | None = None
    within_error: Callable[[float], Deformation] | None = None

    def deflection(self, x: Real) -> Real:
        """Deflection of the upper electrode towards the lower at flat positions x (2, ...) in m; m,
        (...)."""
        return np.clip(self.w(x), 0.0, max(self.depth, default=0.0))

    def deeper(self, times: float) -> Deformation:
        """Deformation with its possible error, multiplied by `times`, added to the deflection."""
        w, uncertainty = self.w, self.uncertainty
        if uncertainty is None:
            return self
        return replace(self, w=lambda x: w(x) + times * uncertainty(x))

    def strain(self, x: Real) -> Real:
        """Compressive strain of the foam at flat positions x (2, ...) in m, shape (...)."""
        return self.deflection(x) / self.thickness

    def factor(self, x: Real) -> Real:
        """Capacitance over the unpressed one at flat positions x (2, ...) in m, shape (...)."""
        strain = self.strain(x)
        return np.ones_like(strain) if self.mechanics is None else self.mechanics.factor(strain)


def check_plane(skin: SheetsAndFoam) -> None:
    """Raise InputError if a skin is no plane."""
    if skin.mesh is not None and len(skin.mesh.surface.p) > 2:
        raise InputError(
            f"skin.mesh {skin.mesh}: must lie in a plane for depth and force of a press"
        )


def check_depths(press: Press, mechanics: Mechanics, thickness: float) -> None:
    """Raise InputError if a given depth is beyond the largest compression of the foam."""
    for touch in press.indented:
        if isinstance(touch.by, Depth) and touch.by.value > greatest(mechanics, thickness):
            raise InputError(
                f"press {press}: depth must be {_range(mechanics, thickness)}, got {touch.by}"
            )


def check_reached(
    press: Press, depth: Iterable[float], mechanics: Mechanics, thickness: float
) -> None:
    """Raise InputError if a given force presses deeper than the largest compression of the foam."""
    for touch, reached in zip(press.indented, depth, strict=True):
        if not reached <= greatest(mechanics, thickness):
            raise InputError(
                f"press {press}: force must leave the depth {_range(mechanics, thickness)}, "
                f"got {touch.by}"
            )


def greatest(mechanics: Mechanics, thickness: float) -> float:
    """Largest depth, m."""
    return mechanics.elastic.greatest_strain * thickness


def _range(mechanics: Mechanics, thickness: float) -> str:
    strain = mechanics.elastic.greatest_strain
    return (
        f"<= {strain * thickness:.4g} m, where foam of {thickness:g} m is compressed by "
        f"{strain:.3g} and its cells are closed"
    )
