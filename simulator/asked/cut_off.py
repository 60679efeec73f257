"""Up to which frequency the whole of a skin is seen."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..models.line import interrogation_frequency
from ..models.plain import electrical
from ..scene.contacts import Contact, section
from ..scene.scene import Scene
from ..scene.skin import Skin, curves, on_skin

LINES = 33
"""Along each side of the skin, at whose crossings it is looked at."""
MARKS = 65
"""Along each foil."""


def cut_off_frequency(scene: Scene) -> float:
    """Where the wave has fallen to half power at the place farthest from the driven foils, Hz.

    f = 0.0382 / (R c x²): both sheets in series, the foam at rest, x the distance. Above it less
    of the skin is seen. Maps, curvature and what presses do are left out. Source: paper Eq 6.
    """
    even = electrical(scene)
    skin = even.skin
    sheets = skin.top.sheet_resistance + skin.bottom.sheet_resistance
    c = skin.foam.rest_capacitance_per_area
    return float(interrogation_frequency(farthest(even), sheets, c))


def farthest(scene: Scene) -> float:
    """The largest distance of a place of the skin from all driven foils, m.

    Of a mesh that a file brings, the longer side of its grid of pixels.
    """
    skin = scene.skin
    if skin.mesh is not None:
        return max(skin.sides)
    driven = {name for each in scene.interfaces for name in (*each.high, *each.low)}
    foils = np.concatenate([_along(scene.contact(name), skin) for name in sorted(driven)])
    places = _places(skin)
    square = ((places[:, None] - foils) ** 2).sum(axis=-1)
    return float(np.sqrt(square.min(axis=1).max()))


def _along(foil: Contact, skin: Skin) -> NDArray[np.float64]:
    part = section(foil, skin)
    curve = curves(skin)[part.curve]
    return np.array([curve.at(mark) for mark in np.linspace(part.start, part.stop, MARKS)])


def _places(skin: Skin) -> NDArray[np.float64]:
    """Places of a skin, those on its outline with it, m, shape (place, 2)."""
    x, y = np.meshgrid(*(np.linspace(0, side, LINES) for side in skin.sides))
    everywhere = np.stack([x.ravel(), y.ravel()])
    if skin.outline is None:
        return everywhere.T
    marks = skin.outline.marks
    around = [skin.outline.at(m) for m in np.linspace(0, marks[-1], 4 * LINES)]
    return np.concatenate([everywhere.T[on_skin(skin, everywhere)], around])
