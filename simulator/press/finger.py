"""Fingers on the skin: the capacitance to earth of a finger on a patch.

A finger on the cover is a plate as large as the patch that it touches:

    C = eps0 A / (thickness / relative_permittivity + air)
"""

from __future__ import annotations

import numpy as np

from ..arrays import Mask, Real
from ..scene.parts import Skin
from ..scene.planar import Circle, area, inside
from ..scene.ranges import Finger
from ..scene.skin_region import covers
from ..scene.surroundings import NO_COVER, NO_EARTH
from ..sweeps import InputError
from ..sweeps.press_text import EARTHED, FREE_TOUCH, WrittenFinger
from .touch import Disc, Place, Polygon, Touch

PERSON = 150e-12
"""Capacitance of a standing person to earth, F, as in the test of IEC 61000-4-2."""
SAMPLES_PER_SIDE = 256
"""Sample points along each side of a touch for its area on the skin: accurate to 1e-3."""


def finger_of(
    place: Place, written: WrittenFinger | None, given: Finger | None, skin: Skin | None
) -> float:
    """Capacitance to earth of the touching object at a place, F.

    It is the one in the text of the touch, else the given one. Raises InputError if the text needs
    a skin and there is none, or if the skin has no earth or no cover.
    """
    how = given if written is None else (given or EARTHED) if written == FREE_TOUCH else written
    if how is None:
        return 0.0
    if isinstance(how, float | int):
        return float(how)
    if skin is None or skin.around is None:
        raise InputError(f"{place.where}: a finger {NO_EARTH}")
    return finger_capacitance(skin, place, how)


def finger_capacitance(skin: Skin, place: Place, how: Finger) -> float:
    """Capacitance of a finger on a place of a scene with surroundings, F.

    "floating": in series with PERSON. Raises InputError without cover and air.
    """
    if isinstance(how, float | int):
        return float(how)
    around = skin.around
    assert around is not None
    if around.finger_per_area is None:
        raise InputError(f"{skin.name}: a finger on {place.where} {NO_COVER}")
    return float(finger_over(skin, np.array(touched_area(skin, place)), how))


def finger_over(skin: Skin, area: Real, how: Finger | None) -> Real:
    """Capacitances of fingers on areas in m², for a scene with surroundings; 0 for a rod.

    The scene needs a cover or air if the capacitance follows from it.
    """
    if not isinstance(how, str):
        return np.full(area.shape, float(how or 0.0))
    assert skin.around is not None and skin.around.finger_per_area is not None
    earthed = skin.around.finger_per_area * area
    return earthed if how == "earthed" else earthed * PERSON / (earthed + PERSON)


def touched_area(skin: Skin, place: Place) -> float:
    """Area of the skin that a place covers, with stretch, m².

    Exact on a rectangle, and for pixels that are groups of a mesh. Otherwise
    SAMPLES_PER_SIDE² sample points in the box around the place give the share on the skin; a mesh
    in space counts as seen along z.
    """
    groups = skin.pixels.groups
    stretched = np.prod(skin.stretch.ratios) if skin.stretch else 1.0
    if isinstance(place, Touch) and groups is not None and skin.mesh is not None:
        return float(stretched * skin.mesh.surface.area(groups[place.row - 1][place.column - 1]))
    corner, extent = _box_around(skin, place)
    whole = stretched * np.prod(extent)
    if skin.rectangular:
        return float(whole * _covered_share(place, extent))
    steps = (np.arange(SAMPLES_PER_SIDE) + 0.5) / SAMPLES_PER_SIDE
    x = np.stack(np.meshgrid(*(corner + extent * steps[:, None]).T))
    return float(whole * (covers(skin, x) & _within(place, x)).mean())


def _box_around(skin: Skin, place: Place) -> tuple[Real, Real]:
    """Rectangle around a place: its lowest corner, and its sides along x and y; m."""
    if isinstance(place, Touch):
        sides = np.array(skin.sides) / skin.pixels.shape[::-1]
        return sides * (place.column - 1, place.row - 1), sides
    box = np.array(place.box)
    return box[::2], box[1::2] - box[::2]


def _covered_share(place: Place, extent: Real) -> float:
    """Share of the rectangle around it that a place covers; extent: sides of the rectangle, m."""
    if isinstance(place, Disc):
        return np.pi / 4
    if isinstance(place, Polygon):
        return abs(area(np.array(place.points))) / float(np.prod(extent))
    return 1.0


def _within(place: Place, x: Real) -> Mask:
    """True for positions x in the box around a place, m, shape (2, ...), that lie in it."""
    if isinstance(place, Disc):
        return Circle(place.x, place.y, place.radius).holds(x)
    if isinstance(place, Polygon):
        return inside(np.array(place.points), x)
    return np.ones(x.shape[1:], dtype=bool)
