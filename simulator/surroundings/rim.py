"""Capacitance along the outline of a skin, beyond the local one of its sheets.

It follows from the charges of the two sheets, each at one potential, less those of straight fields:
across the foam, and towards planes in front of the sheets. The rest is spread uniformly along the
outline.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ..arrays import Real
from ..scene.foam import VACUUM_PERMITTIVITY
from ..scene.parts import Skin
from ..scene.surroundings import Rim
from .charges import capacitances
from .panels import PanelBlock, Shape, blocks, shape_of
from .reflections import Layer, layer

CACHED = 64
MARGIN = 0.5
"""Estimated error over the change by extrapolation to panels of zero size.

On nine rectangles, 0.5 to 10 mm thick, with planes at 0.5 to 20 mm and without, the error was 0.14
of that change at most, and 0.5 on triangles.
"""


@dataclass(frozen=True)
class RimDensities:
    """Capacitance per metre of the outline, holes included, F/m.

    mutual: between the sheets. top, bottom: from each sheet to earth; if there is a body, to that
    body, whatever its potential. error: estimated, of the largest of them, F/m; 0 where a scene
    gives them.
    """

    mutual: float
    top: float = 0.0
    bottom: float = 0.0
    error: float = 0.0


def rim_densities(skin: Skin) -> RimDensities:
    """Densities of a scene: given, computed if `surroundings.rim = true`, else 0.

    A bent skin is taken as flat, and a stretched one as it is stretched. A foam without thickness
    is as thick as one of ASSUMED_PERMITTIVITY. Without a body, and with a low terminal that floats,
    earth takes no part: both sheets' capacitance to it is in `mutual`, in series. Raises InputError
    for a mesh that is not flat.
    """
    around = skin.around
    if around is None or around.rim is False:
        return RimDensities(0.0)
    if isinstance(around.rim, Rim):
        return RimDensities(around.rim.mutual, around.rim.top, around.rim.bottom)
    return computed(skin)


def computed(skin: Skin) -> RimDensities:
    """Computed densities of a scene, even if it gives its rim."""
    around, key = skin.around, "surroundings.rim = true"
    shape = shape_of(skin, key)
    above, below = (around.in_front_of(side) if around else None for side in ("top", "bottom"))
    if below is None and above is not None:
        mutual, bottom, top, error = _solved(shape, layer(above))
        return RimDensities(mutual, top, bottom, error)
    mutual, top, bottom, error = _solved(shape, below and layer(below), above and layer(above))
    if above or below:
        return RimDensities(mutual, top, bottom, error)
    if around is not None and around.low == "floating":
        return RimDensities(mutual + top * bottom / (top + bottom), error=error)
    return RimDensities(mutual, top, bottom, error)


@lru_cache(maxsize=CACHED)
def _solved(
    shape: Shape, below: Layer | None, above: Layer | None = None
) -> tuple[float, float, float, float]:
    """Mutual density, of the top sheet and of the bottom one; error.

    below, above: layers towards planes on either side; one alone is below. All are in F/m. Errors
    are proportional to the square of the panels' size. No density is below 0: within the thickness
    of an edge a cover as thin as that takes more from the foam than fringes add.
    """
    (coarse, size), (fine, half) = (
        (_densities(block, below, above, shape.permittivity), size) for block, size in blocks(shape)
    )
    found = fine + (fine - coarse) / ((size / half) ** 2 - 1)
    kept = np.maximum(found, 0.0)
    error = MARGIN * np.abs(found - fine) + (kept - found)
    return *kept.tolist(), float(error.max())


def _densities(
    block: PanelBlock, below: Layer | None, above: Layer | None, permittivity: float
) -> Real:
    """Mutual density, of the top sheet and of the bottom one, F/m, shape (3,)."""
    C = capacitances(block, below, permittivity, above)
    foam = VACUUM_PERMITTIVITY * permittivity / block.thickness * block.area
    top, bottom = (each.per_area * block.area if each else 0.0 for each in (above, below))
    whole = np.array([-C[0, 1] - foam, C[:, 1].sum() - top, C[:, 0].sum() - bottom])
    return whole / block.perimeter
