"""Numbers of a scene that are far from those of any skin, and what was likely meant."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from ..models.line import cut_off_frequency
from ..scene.scene import Scene


class Span(NamedTuple):
    """The usual numbers of one kind, and those beyond which one is a slip.

    factors: from other units of the same kind, the likeliest first.
    """

    unit: str
    least: float
    low: float
    high: float
    most: float
    factors: tuple[float, ...]

    def meant(self, value: float, near: float | None = None) -> float | None:
        """A usual number that a slip was likely meant to be, that nearest to `near`."""
        usual = [value * by for by in self.factors if self.low <= value * by <= self.high]
        if near is not None and self.least <= near <= self.most:
            usual.sort(key=lambda each: abs(math.log(each / near)))
        return usual[0] if usual else None

    def slip(self, key: str, value: float | None, near: float | None = None) -> Iterator[str]:
        """What is told of a number; nothing where it may be one of a skin."""
        if value is None or value == 0 or self.least <= value <= self.most:
            return
        meant = self.meant(value, near)
        asked = "" if meant is None else f"; did you mean {meant:.6g}?"
        usual = f"{self.least:g} to {self.most:g} {self.unit}"
        yield f"{key} = {value:g} {self.unit}{asked} (skins have {usual})"


MILLI, CENTI, MICRO, NANO, PICO = 1e-3, 1e-2, 1e-6, 1e-9, 1e-12
SIDE = Span("m", 1e-3, 5e-3, 3.0, 4.0, (MILLI, CENTI, MICRO, 1 / MILLI))
THICKNESS = Span("m", 1e-6, 1e-5, 3e-2, 0.2, (MILLI, MICRO, CENTI, 1 / MILLI))
PER_AREA = Span("F/m²", 1e-10, 2e-10, 1e-6, 1e-4, (NANO, PICO, MICRO, 1 / MICRO, 1 / NANO))
SHEET = Span("ohm/sq", 1e-3, 1e2, 1e7, 1e10, (1 / MILLI, 1 / MICRO, MILLI))
FARAD = Span("F", 1e-16, 1e-14, 1e-8, 1e-6, (PICO, NANO, MICRO))
HERTZ = Span("Hz", 1e-4, 1.0, 1e9, 1e9, (1 / MILLI, MILLI))

FAR = 1e4
"""Times that a cut-off may lie beyond either end of the sweep."""
IN_KILO = 1e3
"""Hz, and ohm/sq: what sweeps end below, and sheets resist less, that are likely given in kilo."""
APART = 10.0
"""Times that the cut-off then lies above the sweep."""


def slips(scene: Scene) -> list[str]:
    """One line for each number far outside what skins have, with what was likely meant."""
    skin, foam = scene.skin, scene.skin.foam
    of_all = (1 / (skin.length * skin.width), *PER_AREA.factors)
    per_area = PER_AREA._replace(factors=of_all)
    told = [
        *SIDE.slip("skin.length", skin.length, skin.width),
        *SIDE.slip("skin.width", skin.width, skin.length),
        *THICKNESS.slip("skin.foam.thickness", foam.thickness),
        *per_area.slip("skin.foam.capacitance_per_area", foam.capacitance_per_area),
        *SHEET.slip("skin.top.sheet_resistance", skin.top.sheet_resistance),
        *SHEET.slip("skin.bottom.sheet_resistance", skin.bottom.sheet_resistance),
        *FARAD.slip("leads.stray_capacitance", scene.leads.stray_capacitance),
        *HERTZ.slip("sweep.frequencies", scene.sweep.frequencies[0]),
        *HERTZ.slip("sweep.frequencies", scene.sweep.frequencies[-1]),
    ]
    return told or list(_cut_off(scene))


def _cut_off(scene: Scene) -> Iterator[str]:
    """What a cut-off frequency tells that lies far from the sweep."""
    start, stop = scene.sweep.frequencies[0], scene.sweep.frequencies[-1]
    cut_off = cut_off_frequency(scene)
    sheet = max(scene.skin.top.sheet_resistance, scene.skin.bottom.sheet_resistance)
    if stop <= IN_KILO and cut_off > APART * stop and start <= cut_off / IN_KILO <= stop:
        yield (
            f"sweep.frequencies end at {stop:g} Hz, far below the skin's cut-off frequency of "
            f"{cut_off:.3g} Hz; did you mean {IN_KILO * start:g} to {IN_KILO * stop:g} Hz?"
        )
    elif sheet < IN_KILO and cut_off > APART * stop and start <= cut_off / IN_KILO <= stop:
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
