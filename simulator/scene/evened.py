"""The skin that is electrically equivalent to a stretched, bent or uniformly mapped one.

A uniform stretch of an isotropic rectangle leaves a rectangle: its sides grow, the sheets'
resistance R' = R J^(p / (1 - p)) and the foam's capacitance per area c' = c0 J^(q / (1 - q)) are
uniform again (see `models.heterogeneous.materials`). Contact resistance times length of contact
line is assumed constant. Bending to a cylinder changes no length. Maps of one factor are factors.
"""

from __future__ import annotations

from typing import TypeVar

from .foam.foam import Foam
from .skin import Sheet, SheetsAndFoam

SheetOrFoam = TypeVar("SheetOrFoam", Sheet, Foam)
AnySkin = TypeVar("AnySkin", bound=SheetsAndFoam)


def evened(skin: AnySkin) -> AnySkin:
    """Electrically equivalent skin.

    Uniform maps, anisotropy of ratio 1 and bending to a cylinder are always replaced; a stretch is
    replaced if the rest is uniform. A skin without any of them is returned as it is.
    """
    flat = _without_uniform_maps(skin)
    return _stretched(flat) if flat.beyond_uniform == ["skin.stretch"] else flat


def _without_uniform_maps(skin: AnySkin) -> AnySkin:
    """Skin without uniform maps, without anisotropy of ratio 1, and flat if it only bends."""
    changed = {
        "top": _without_uniform_map(_without_unit_anisotropy(skin.top)),
        "bottom": _without_uniform_map(_without_unit_anisotropy(skin.bottom)),
        "foam": _without_uniform_map(skin.foam),
        "shape": None if skin.shape is not None and skin.shape.developable else skin.shape,
    }
    if all(getattr(skin, name) is part for name, part in changed.items()):
        return skin
    return skin.with_parts(**changed)


def _without_unit_anisotropy(sheet: Sheet) -> Sheet:
    if sheet.anisotropy is None or sheet.anisotropy.ratio != 1:
        return sheet
    return sheet.model_copy(update={"anisotropy": None})


def _without_uniform_map(part: SheetOrFoam) -> SheetOrFoam:
    factor = None if part.map is None else part.map.uniform
    if factor is None:
        return part
    return _times(part, factor).model_copy(update={"map": None})


def _times(part: SheetOrFoam, factor: float) -> SheetOrFoam:
    """Part with `factor` times the resistance, or times the capacitance per area."""
    if isinstance(part, Sheet):
        return part.model_copy(update={"sheet_resistance": part.sheet_resistance * factor})
    if part.capacitance_per_area is None and part.mechanics is None:
        assert part.thickness is not None
        return part.model_copy(update={"thickness": part.thickness / factor})
    c = part.unpressed_capacitance_per_area * factor
    return part.model_copy(update={"capacitance_per_area": c, "relative_permittivity": None})


def _stretched(skin: AnySkin) -> AnySkin:
    stretch = skin.stretch
    assert stretch is not None
    along, across = stretch.ratios
    of_sheets, of_foam = ((along * across) ** power for power in stretch.thinning)
    return skin.with_parts(
        length=skin.length * along,
        width=skin.width * across,
        top=_times(skin.top, of_sheets),
        bottom=_times(skin.bottom, of_sheets),
        foam=_thinned(skin.foam, of_foam),
        stretch=None,
    )


def _thinned(foam: Foam, factor: float) -> Foam:
    """Foam with `factor` times the capacitance per area, by its thickness if that is known."""
    thinner = _times(foam, factor)
    if foam.thickness is None:
        return thinner
    return thinner.model_copy(update={"thickness": foam.thickness / factor})
