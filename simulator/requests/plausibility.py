"""Warnings for numbers of a scene that no real skin has, with the likely intended value.

The warning limits lie beyond every skin in the literature and every data sheet, so that any
measured scene passes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from ..models.line import cut_off_frequency
from ..scene.mesh_data import off_grid
from ..scene.parts import Skin
from ..scene.scene import Scene


class UsualRange(NamedTuple):
    """Usual range (low to high) of one quantity, and the limits beyond which a value is a mistake.

    factors: conversions from other units of the quantity, the most likely first.
    """

    unit: str
    minimum: float
    low: float
    high: float
    maximum: float
    factors: tuple[float, ...]

    def suggestion(self, value: float, near: float | None = None) -> float | None:
        """The usual value that a wrong unit probably stands for; the one nearest to `near`."""
        usual = [value * by for by in self.factors if self.low <= abs(value * by) <= self.high]
        if near is not None and self.minimum <= near <= self.maximum:
            usual.sort(key=lambda each: abs(math.log(each / near)))
        return usual[0] if usual else None

    def slip(self, key: str, value: float | None, near: float | None = None) -> Iterator[str]:
        """A warning for an implausible value; nothing for a plausible one."""
        if value is None or value == 0 or self.minimum <= abs(value) <= self.maximum:
            return
        suggested = self.suggestion(value, near)
        hint = "" if suggested is None else f"; did you mean {suggested:.6g}?"
        usual = f"{self.minimum:g} to {self.maximum:g} {self.unit}".rstrip()
        yield f"{key} = {' '.join(f'{value:g} {self.unit}'.split())}{hint} (skins have {usual})"


MILLI, CENTI, MICRO, NANO, PICO = 1e-3, 1e-2, 1e-6, 1e-9, 1e-12
KILO, MEGA = 1e3, 1e6
DEGREE = math.pi / 180
SIDE = UsualRange("m", 1e-3, 5e-3, 3.0, 4.0, (MILLI, CENTI, MICRO, KILO))
THICKNESS = UsualRange("m", 1e-6, 1e-5, 3e-2, 0.2, (MILLI, MICRO, CENTI, KILO))
PER_AREA = UsualRange("F/m²", 1e-10, 2e-10, 1e-6, 1e-4, (NANO, PICO, MICRO, MEGA, 1 / NANO))
SHEET = UsualRange("ohm/sq", 1e-3, 1e2, 1e7, 1e10, (KILO, MEGA, MILLI))
FARAD = UsualRange("F", 1e-16, 1e-14, 1e-8, 1e-6, (PICO, NANO, MICRO))
HERTZ = UsualRange("Hz", 1e-4, 1.0, 1e9, 1e9, (KILO, MILLI))
SHARE = UsualRange("of |Z|", 1e-8, 1e-5, 0.05, 0.1, (CENTI,))
"""A data sheet rates no range of an LCR meter worse than 10 %."""
TURN = UsualRange("rad", 1e-8, 1e-5, 0.05, 0.1, (DEGREE,))
"""0.1 rad is 5.7 degrees, comparable to 10 % of |Z|."""
ANGLE = UsualRange("rad", 0.0, 0.0, math.pi, 2 * math.pi, (DEGREE,))

USUAL = {
    "skin.top.sheet_resistance": SHEET,
    "skin.bottom.sheet_resistance": SHEET,
    "skin.foam.thickness": THICKNESS,
    # Solids have at most a few; filled rubber of percolating carbon some thousand.
    "skin.foam.relative_permittivity": UsualRange("", 1.0, 1.0, 100.0, 1e4, (CENTI,)),
    # tan d of polymers is 1e-4 to 0.1, of wet foam up to 1; in per cent a hundred times that.
    "skin.foam.loss_tangent": UsualRange("", 1e-7, 1e-5, 0.5, 1.0, (CENTI,)),
    # Young's moduli: foams of 1 kPa to 10 MPa, rubber up to 0.1 GPa, glassy polymers 3 GPa.
    "skin.foam.mechanics.modulus": UsualRange("Pa", 500.0, 1e3, 1e8, 1e9, (KILO, MEGA, MILLI)),
    "skin.foam.mechanics.solid_modulus": UsualRange(
        "Pa", 1e4, 1e5, 1e10, 1e11, (MEGA, KILO, 1e9, MILLI)
    ),
    "skin.foam.mechanics.plateau_stress": UsualRange(
        "Pa", 10.0, 50.0, 1e7, 1e8, (KILO, MEGA, MILLI)
    ),
    # 1 m of film stretched by less than it breaks at: fabric holds 1e4 N/m.
    "skin.foam.mechanics.tension": UsualRange("N/m", 1e-3, 0.1, 1e3, 1e4, (MILLI,)),
    "skin.top.anisotropy.angle": ANGLE,
    "skin.bottom.anisotropy.angle": ANGLE,
    "skin.shape.radius": UsualRange("m", 1e-3, 2e-3, 1.0, 2.0, (MILLI, CENTI)),
    "leads.stray_capacitance": FARAD,
    # A coil has a millihenry; a metre of cable a microhenry and a tenth of an ohm.
    "leads.inductance": UsualRange("H", 1e-10, 1e-9, 1e-4, 1e-3, (MICRO, NANO, MILLI)),
    "leads.resistance": UsualRange("ohm", 1e-5, 1e-3, 1e3, 1e5, (MILLI,)),
    # A foil of 0.1 m with 1e5 ohm m puts a megohm before the skin.
    "contact.resistance": UsualRange("ohm m", 1e-9, 1e-6, 1e3, 1e5, (MILLI, MICRO)),
    # Copper foil under tape overlaps a sheet by a tenth of a millimetre to a few centimetres.
    "contact.width": UsualRange("m", 1e-6, 1e-5, 0.1, 0.5, (MILLI, CENTI, MICRO)),
    # From the liner of a sleeve to where air adds no more than a thousandth to thin foam.
    "surroundings.body.distance": UsualRange("m", 1e-6, 1e-5, 0.3, 0.5, (MILLI, CENTI, MICRO)),
    "surroundings.cover.thickness": THICKNESS,
    "surroundings.cover.relative_permittivity": UsualRange("", 1.0, 1.0, 100.0, 1e4, (CENTI,)),
    "surroundings.air": UsualRange("m", 1e-6, 1e-5, 0.3, 0.5, (MILLI, CENTI, MICRO)),
    "press.depth": THICKNESS,
    # A finger presses by 0.1 to 50 N; in grams a force is a hundred times that.
    "press.force": UsualRange("N", 1e-3, 1e-2, 200.0, 1e3, (MILLI, 9.81e-3)),
    # Foam pressed to a tenth of its thickness has 10; in per cent a factor is a hundred times that.
    "press.capacitance_factor": UsualRange("times", 0.01, 1.0, 20.0, 50.0, (CENTI,)),
    "readout.magnitude_accuracy": SHARE,
    "readout.magnitude_noise": SHARE,
    "readout.phase_accuracy": TURN,
    "readout.phase_noise": TURN,
    "design.within": UsualRange("m", 1e-5, 1e-4, 0.2, 0.5, (MILLI, CENTI)),
    "design.seconds": UsualRange("s", 1e-3, 1e-2, 1e4, 1e5, (MILLI,)),
    "design.sheet_resistance": SHEET,
    "design.foam_thickness": THICKNESS,
    "design.band": HERTZ,
    "dataset.press.depth": THICKNESS,
    "dataset.session.loss_tangent": UsualRange("", 0.0, 1e-5, 0.5, 1.0, (CENTI,)),
    "dataset.session.stray_capacitance": FARAD,
    "dataset.session.lead_resistance": UsualRange("ohm", 0.0, 1e-3, 1e3, 1e5, (MILLI,)),
}
"""Usual ranges by key, without item numbers and parts of distributions."""


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
