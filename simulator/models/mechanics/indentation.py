"""Strain of the foam and factor on its capacitance by the depth or force of a press.

Electrode skins of tension T lie on foam of thickness d as on an elastic foundation (a Winkler
foundation with a Pasternak layer): div(T grad w) = p(w/d). Rigid flat applicators clamp them at
their depth; away from these the deflection falls off over the length sqrt(T d / E).
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Real
from ...mesh.drawing import polygon_of, polygonal
from ...press.press import Press, check_press
from ...press.touch import Disc
from ...progress import ProgressCallback, silent
from ...scene.foam.foam_mechanics import Mechanics
from ...scene.parts import Skin
from ...scene.planar import ring
from .deformation import Deformation, check_depths
from .no_tension import deformation_without_tension

if TYPE_CHECKING:
    from .deflection_cache import DeflectionCache

DISC_SIDES = 128
"""Sides of the polygon of the same area that replaces a disc."""
OUT_OF_ROUND = 0.02 * (np.pi / DISC_SIDES) ** 3
"""Relative error of Rs and Cp by that polygon. It falls with the cube of the sides; a third of this
bound was observed, all of it far above cut-off."""

__all__ = ["Deformation", "deformation"]


def deformation(
    skin: Skin,
    press: Press,
    rtol: float,
    progress: ProgressCallback = silent,
    again: DeflectionCache | None = None,
) -> Deformation:
    """Deformation by the touches of given depth or force, the factor within `rtol` anywhere.

    progress: see `ProgressCallback`. again: cache of presses at the same places. Raises InputError
    as `check_press` does, if the foam cannot be compressed so far, if a touch of given force meets
    another, and if a touch lies outside the skin. Raises ToleranceError if `rtol` is out of reach.
    """
    touches = press.indented
    if not touches:
        return Deformation(None, 1.0, _flat, (), (), 0.0, (), press)
    check_press(press, skin)
    mechanics, thickness = skin.foam.mechanics, skin.foam.thickness
    assert mechanics is not None and thickness is not None
    check_depths(press, mechanics, thickness)
    if not mechanics.tension:
        return deformation_without_tension(skin, press, mechanics, thickness)
    return _spread(skin, press, mechanics, thickness, rtol, progress, again)


def _spread(
    skin: Skin,
    press: Press,
    mechanics: Mechanics,
    thickness: float,
    rtol: float,
    progress: ProgressCallback,
    again: DeflectionCache | None,
) -> Deformation:
    from .adaptive import adaptive_deflection
    from .contact_mesh import straight_contact_mesh
    from .deflection_cache import DeflectionCache

    again = again or DeflectionCache()
    places = [touch.place for touch in press.indented]
    kinks = tuple(ring(polygon_of(skin, polygonal(each, DISC_SIDES))) for each in places)
    contact = again.contact or straight_contact_mesh(skin, places, DISC_SIDES)
    found = adaptive_deflection(press, contact, mechanics, thickness, rtol, progress, again)
    depth, force = tuple(found.solution.depth.tolist()), tuple(found.solution.force.tolist())
    return Deformation(
        mechanics,
        thickness,
        found.surface,
        depth,
        force,
        found.error,
        kinks,
        None,
        out_of_round=OUT_OF_ROUND * any(isinstance(each, Disc) for each in places),
        within_error=partial(deformation, skin, press, again=again),
        uncertainty=found.surface.in_triangles(found.uncertainty),
    )


def _flat(x: Real) -> Real:
    return np.zeros(x.shape[1:])
