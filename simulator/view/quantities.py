"""Quantities of the fields that can be shown, with their units and colours."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from ..arrays import Complex, Real
from ..sweeps import InputError

if TYPE_CHECKING:
    from ..models.solution import SolutionFields

Scale = Literal["magnitude", "signed", "cyclic"]

COLOUR_MAPS: dict[Scale, str] = {"magnitude": "viridis", "signed": "RdBu_r", "cyclic": "twilight"}
"""Colour maps: perceptually uniform, centred on zero, and closed.

None requires to distinguish red from green.
"""
SAME_SHEETS = 1e-3
"""Relative difference of the sheets' currents up to which they are shown once.

It is the mean difference of their densities over the mean of the top sheet.
"""
SAME_SCALE_RATIO = 10.0
"""Largest ratio of the values of frames that share one scale."""
PEAKS, PEAK_RATIO = 0.01, 1.5
"""Fraction of the area whose values the scale may leave out, and ratio required.

The scale ends below these values if they are more than FAR_LESS times the rest.
"""
MAX_OPEN_SPAN = 300.0
"""Largest span of phases, in degrees, that needs no closed map."""
NO_DEFLECTION = 1e-12
PERCENT_PER_CM2 = 1e2 * 1e-4
PREFIXES = ("f", "p", "n", "µ", "m", "", "k", "M", "G")


@dataclass(frozen=True)
class ViewedQuantity:
    """Quantity that has a value at every point.

    values: (fields, number of the frequency) -> (point,) in `unit`. sheet: 0 or 1 if arrows of that
    sheet's current belong to it. everywhere: True if it is the same at all frequencies. prefixed:
    True if the unit may get a prefix.
    """

    name: str
    title: str
    unit: str
    scale: Scale
    values: Callable[[SolutionFields, int], Real]
    sheet: int | None = None
    everywhere: bool = False
    prefixed: bool = False

    def shown_unit(self, highest: float) -> tuple[float, str]:
        """Factor and unit in which values of up to `highest` are shown."""
        return prefix(highest, self.unit) if self.prefixed else (1.0, self.unit)

    @property
    def open_scale(self) -> Scale:
        """Scale for values that do not go around."""
        return "magnitude" if self.scale == "cyclic" else self.scale


def span_text(low: float, high: float, unit: str) -> str:
    """Range as text, such as −20.6 to 0.0 degrees.

    It has as many decimals as distinguish the ends.
    """
    digits = max(0, 1 - math.floor(math.log10(high - low))) if high > low else 3
    ends = (f"{end:.{digits}f}".replace("-", "−") for end in (low, high + 0.0))
    return f"{' to '.join(ends)} {unit}"


def prefix(highest: float, unit: str) -> tuple[float, str]:
    """Factor and prefixed unit that make `highest` a number from 1 to 1000."""
    power = math.floor(math.log10(highest) / 3) if highest > 0 else 0
    power = min(max(power, -5), 3)
    return 1e3**-power, f"{PREFIXES[power + 5]}{unit}"


def difference(fields: SolutionFields, at: int) -> Complex:
    """V_t - V_b at a frequency by number, V, (point,)."""
    return fields.potential[0, at] - fields.potential[1, at]


def current_size(fields: SolutionFields, at: int, sheet: int) -> Real:
    """Amplitude of a sheet's current density, A/m, (point,)."""
    return np.sqrt((np.abs(fields.current[sheet, at]) ** 2).sum(axis=0))


def _current(sheet: int, title: str) -> ViewedQuantity:
    def values(fields: SolutionFields, at: int) -> Real:
        return current_size(fields, at, sheet)

    return ViewedQuantity("current", title, "A/m", "magnitude", values, sheet, prefixed=True)


POTENTIAL = ViewedQuantity(
    "potential",
    "Potential between the sheets",
    "V",
    "magnitude",
    lambda fields, at: np.abs(difference(fields, at)),
)
PHASE = ViewedQuantity(
    "phase",
    "Phase of the potential between the sheets",
    "degrees",
    "cyclic",
    lambda fields, at: np.degrees(np.angle(difference(fields, at))),
)
POWER = ViewedQuantity(
    "power",
    "Power dissipated in the sheets",
    "W/m²",
    "magnitude",
    lambda fields, at: fields.power[at],
    prefixed=True,
)
SENSITIVITY_RS = ViewedQuantity(
    "sensitivity-Rs",
    "Change of Rs by doubled capacitance",
    "% per cm²",
    "signed",
    lambda fields, at: PERCENT_PER_CM2 * fields.by_rise_Rs[at],
)
SENSITIVITY_CP = ViewedQuantity(
    "sensitivity-Cp",
    "Change of Cp by doubled capacitance",
    "% per cm²",
    "signed",
    lambda fields, at: PERCENT_PER_CM2 * fields.by_rise_Cp[at],
)
CAPACITANCE = ViewedQuantity(
    "capacitance",
    "Capacitance",
    "pF/cm²",
    "magnitude",
    lambda fields, at: 1e8 * fields.capacitance,
    everywhere=True,
)
DEFORMATION = ViewedQuantity(
    "deformation",
    "Deflection of the skin",
    "mm",
    "magnitude",
    lambda fields, at: 1e3 * fields.deflection,
    everywhere=True,
)
EITHER_SHEET = _current(0, "Current density in either sheet")
SHEETS = (_current(0, "Current density, top sheet"), _current(1, "Current density, bottom sheet"))
NAMES = (
    "potential",
    "phase",
    "current",
    "power",
    "sensitivity-Rs",
    "sensitivity-Cp",
    "capacitance",
    "deformation",
)


def deformed(fields: SolutionFields) -> bool:
    """True if the press is known to deflect the skin."""
    return bool(np.max(np.abs(fields.deflection), initial=0.0) > NO_DEFLECTION)


def chosen(name: str, fields: SolutionFields) -> list[ViewedQuantity]:
    """Quantities of a name: two if the sheets' currents differ.

    For `all` it is all that there are. Raises InputError for deformation where nothing is deformed.
    """
    if name == "all":
        names = [each for each in NAMES if each != "deformation" or deformed(fields)]
        return [quantity for each in names for quantity in chosen(each, fields)]
    if name == "deformation" and not deformed(fields):
        raise InputError(
            "--what deformation: this press states factors of the capacitance and deforms nothing; "
            "press by depth or force, such as --press 2,3:2mm"
        )
    if name == "current":
        return [EITHER_SHEET] if _sheets_agree(fields) else list(SHEETS)
    single = (POTENTIAL, PHASE, POWER, SENSITIVITY_RS, SENSITIVITY_CP, CAPACITANCE, DEFORMATION)
    return [quantity for quantity in single if quantity.name == name]


def _sheets_agree(fields: SolutionFields) -> bool:
    weight = point_areas(fields)
    return all(
        weight @ np.abs(top - bottom) <= SAME_SHEETS * (weight @ top)
        for at in range(len(fields.frequency))
        for top, bottom in [(current_size(fields, at, 0), current_size(fields, at, 1))]
    )


def point_areas(fields: SolutionFields) -> Real:
    """Flat area that belongs to each point, m², (point,)."""
    x, y = fields.x[:, fields.cells]
    area = np.abs((x * np.roll(y, -1, axis=0) - y * np.roll(x, -1, axis=0)).sum(axis=0)) / 2
    share = np.broadcast_to(area / len(fields.cells), fields.cells.shape)
    total = np.bincount(fields.cells.ravel(), share.ravel(), fields.x.shape[1])
    return total.astype(float)


def scales(
    quantity: ViewedQuantity, frames: Sequence[Real], weight: Real
) -> list[tuple[float, float]]:
    """Ends of the colour scale for each frame of values (point,).

    weight: area of each point. The largest values, which have the smallest areas at the ends of
    foils, are left out. All frames have one scale if their largest values, or spans of angles, are
    similar, else each its own. Magnitudes start at 0 unless the smallest is more than half of the
    largest.
    """
    sizes = [_size(quantity, values, weight) for values in frames]
    if max(sizes) > SAME_SCALE_RATIO * min(sizes):
        pairs = zip(frames, sizes, strict=True)
        return [_scale(quantity, [values], size) for values, size in pairs]
    return [_scale(quantity, frames, max(sizes))] * len(frames)


def _size(quantity: ViewedQuantity, values: Real, weight: Real) -> float:
    """Range of the scale that a frame needs: span of angles, else largest value."""
    if quantity.scale == "cyclic":
        return float(np.ptp(values)) or 1.0
    return _largest_shown(np.abs(values), weight) or 1.0


def _scale(quantity: ViewedQuantity, frames: Sequence[Real], high: float) -> tuple[float, float]:
    if quantity.scale == "cyclic":
        return _angles(frames)
    if quantity.scale == "signed":
        return -high, high
    lowest = min(float(values.min()) for values in frames)
    return (lowest if 0.5 * high < lowest < high else 0.0), high


def _largest_shown(sizes: Real, weight: Real) -> float:
    """Largest value, or a bound of all but PEAKS of the area where that is far less."""
    order = np.argsort(sizes)
    covered = np.cumsum(weight[order])
    usual = float(sizes[order[np.searchsorted(covered, (1 - PEAKS) * covered[-1])]])
    return float(sizes.max()) if sizes.max() <= PEAK_RATIO * usual else usual


def _angles(frames: Sequence[Real]) -> tuple[float, float]:
    lowest = min(float(values.min()) for values in frames)
    highest = max(float(values.max()) for values in frames)
    return (lowest, highest) if 0 < highest - lowest <= MAX_OPEN_SPAN else (-180.0, 180.0)


def checked_name(name: str) -> str:
    """Name of a quantity that can be shown; raises InputError for any other."""
    if name not in (*NAMES, "all"):
        raise InputError(f"--what must be one of {', '.join(NAMES)} or all, got {name!r}")
    return name
