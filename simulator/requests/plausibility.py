"""Warnings for numbers of a scene that no real skin has, with the likely intended value."""

from __future__ import annotations

from collections.abc import Iterator

from ..models.line import cut_off_frequency
from ..scene.form.mesh_data import off_grid
from ..scene.parts import Skin
from ..scene.scene import Scene
from .usual_ranges import HERTZ, PER_AREA, SIDE, USUAL

FAR = 1e4
"""Factor by which the cut-off may lie beyond either end of the sweep."""
IN_KILO = 1e3
"""Sweeps that end below 1000 Hz and sheets below 1000 ohm/sq were probably given in kilo units."""
NEARLY = 10.0
"""Factor by which two sheets may differ besides the thousand of a forgotten kilo."""
FAR_ABOVE = 10.0
"""Factor by which the cut-off then lies above the sweep."""


def suspicious_values(scene: Scene) -> list[str]:
    """One line for each number far outside the usual range, with the likely intended value.

    Empty for a scene that states `plausible = false`.
    """

    if scene.plausible is False:
        return []
    skin, frequencies = scene.skin, scene.sweep.frequencies
    of_all = (1 / (skin.length * skin.width), *PER_AREA.factors)
    per_area = PER_AREA._replace(factors=of_all)
    found = [
        *SIDE.slip("skin.length", skin.length, skin.width),
        *SIDE.slip("skin.width", skin.width, skin.length),
        *per_area.slip("skin.foam.capacitance_per_area", skin.foam.capacitance_per_area),
        *HERTZ.slip("sweep.frequencies", frequencies[0]),
        *(HERTZ.slip("sweep.frequencies", frequencies[-1]) if len(frequencies) > 1 else ()),
        *_beyond_usual(scene.model_dump(by_alias=True, exclude_none=True)),
        *_off_grid(scene.parts.skin),
    ]
    return found or [*_one_sheet_in_kilo(scene.parts.skin), *_cut_off(scene)]


def _off_grid(skin: Skin) -> Iterator[str]:
    """A warning if a mesh lies beside the grid of pixels that cut it."""
    if skin.mesh is not None and skin.pixels.groups is None:
        yield from off_grid(skin.mesh.surface, skin.length, skin.width)


def _beyond_usual(table: object, key: str = "", place: str = "") -> Iterator[str]:
    """Warnings for all numbers in a table that have an entry in USUAL.

    key: the name in USUAL. place: the name in the scene file.
    """
    if isinstance(table, dict):
        for name, value in table.items():
            part = key if key in USUAL else f"{key}.{name}".lstrip(".")
            yield from _beyond_usual(value, part, f"{place}.{name}".lstrip("."))
    elif isinstance(table, list | tuple):
        for number, value in enumerate(table, 1):
            yield from _beyond_usual(value, key, f"{place}[{number}]")
    elif key in USUAL and isinstance(table, int | float):
        yield from USUAL[key].slip(place, table)


def _one_sheet_in_kilo(skin: Skin) -> Iterator[str]:
    """A warning if one sheet has about a thousandth of the other's sheet resistance.

    Real pairs do not: metal has an ohm or less, a ten-thousandth of carbon-filled rubber.
    """
    top, bottom = skin.sheet_resistances
    less, more = sorted((top, bottom))
    if not (IN_KILO / NEARLY <= more / less <= IN_KILO * NEARLY and less < IN_KILO):
        return
    low, high = ("top", "bottom") if top < bottom else ("bottom", "top")
    yield (
        f"skin.{low}.sheet_resistance = {less:g} ohm/sq, but skin.{high}.sheet_resistance = "
        f"{more:g} ohm/sq; did you mean {IN_KILO * less:g}?"
    )


def _cut_off(scene: Scene) -> Iterator[str]:
    """A warning if the cut-off frequency lies far from the sweep."""
    start, stop = scene.sweep.frequencies[0], scene.sweep.frequencies[-1]
    cut_off = max(
        cut_off_frequency(scene.parts.skin, scene.parts.setup, each) for each in scene.interfaces
    )
    sheet = max(scene.skin.top.sheet_resistance, scene.skin.bottom.sheet_resistance)
    if stop <= IN_KILO and cut_off > FAR_ABOVE * stop and start <= cut_off / IN_KILO <= stop:
        yield (
            f"sweep.frequencies end at {stop:g} Hz, far below the skin's cut-off frequency of "
            f"{cut_off:.3g} Hz; did you mean {IN_KILO * start:g} to {IN_KILO * stop:g} Hz?"
        )
    elif sheet < IN_KILO and cut_off > FAR_ABOVE * stop and start <= cut_off / IN_KILO <= stop:
        yield (
            f"sheet_resistance = {sheet:g} ohm/sq puts the cut-off frequency at "
            f"{cut_off:.3g} Hz, far above the sweep's {stop:g} Hz; did you mean "
            f"{IN_KILO * sheet:g}?"
        )
    elif not start / FAR <= cut_off <= stop * FAR:
        side = "above" if cut_off > stop else "below"
        yield (
            f"the cut-off frequency of {cut_off:.3g} Hz lies far {side} the sweep of {start:g} to "
            f"{stop:g} Hz: check sizes, sheet_resistance, capacitance and frequencies"
        )
