"""Where the thin-sheet model itself ends: what a foam of some thickness does that it leaves out.

Foam of thickness d carries displacement current along the skin too. Where the potential grows
evenly from sheet to sheet that is a conductance s c d² / 12 beside 1 / R, of which it is the part
|s R c| d² / 12 = (d / delta)² / 6; at the end of a long strip Rs falls and Cp rises by half as
much. At the edges of the skin the field fringes, as if each edge lay FRINGE d farther out; at those
of a press it is smoothed over d.
"""

from __future__ import annotations

from ..scene.scene import Scene
from ..scene.skin import VACUUM_PERMITTIVITY

FRINGE = 0.44
LATERAL_LIMIT, FRINGE_LIMIT = 0.01, 0.1
PIXEL_LIMIT = 2.0


def least_thickness(scene: Scene) -> float:
    """The foam's thickness in m; where only its capacitance is given, the least it can be."""
    foam = scene.skin.foam
    return foam.thickness or VACUUM_PERMITTIVITY / foam.rest_capacitance_per_area


def lateral_error(thickness: float, depth: float) -> float:
    """Bound on the relative error of Rs and Cp by currents along the foam; both arguments in m."""
    return (thickness / depth) ** 2 / 6


def fringe_error(thickness: float, length: float, width: float) -> float:
    """Relative error of the whole capacitance from fields around the edges of a skin, all in m."""
    return 2 * FRINGE * thickness * (1 / length + 1 / width)


def warnings(scene: Scene) -> list[str]:
    """One line for each way in which the scene leaves the model's range; none where it is within.

    Where the capacitance is given, and not its geometry, it is taken to hold the fringe field.
    """
    skin, pixels = scene.skin, scene.pixels
    d = least_thickness(scene)
    depth = skin.depth(scene.frequencies[-1], max(1.0, scene.press.capacitance_factor))
    lateral, fringe = lateral_error(d, depth), fringe_error(d, skin.length, skin.width)
    pixel = min(skin.length / pixels.columns, skin.width / pixels.rows)
    told = []
    if lateral > LATERAL_LIMIT:
        told.append(
            f"at {scene.frequencies[-1]:.3g} Hz the field reaches {1e3 * depth:.2g} mm, not far "
            f"enough beyond the foam's {1e3 * d:.2g} mm: currents along the foam change Rs and Cp "
            f"by up to {100 * lateral:.2g} % (limit {100 * LATERAL_LIMIT:g} %)"
        )
    if skin.foam.thickness and fringe > FRINGE_LIMIT:
        told.append(
            f"fields around the edges add {100 * fringe:.2g} % to the capacitance of a foam "
            f"{1e3 * d:.2g} mm thick (limit {100 * FRINGE_LIMIT:g} %); give capacitance_per_area "
            "as measured"
        )
    if pixel < PIXEL_LIMIT * d:
        told.append(
            f"pixels of {1e3 * pixel:.2g} mm are less than {PIXEL_LIMIT:g} times the foam's "
            f"{1e3 * d:.2g} mm: the edge of a press is not as sharp as modelled"
        )
    return told
