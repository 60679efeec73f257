"""Values of one quantity at one moment, with their scale and texts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from ..arrays import Complex, Real
from .marks import Arrows, arrows
from .quantities import (
    COLOUR_MAPS,
    ViewedQuantity,
    difference,
    point_areas,
    prefix,
    scales,
    span_text,
)

if TYPE_CHECKING:
    from ..models.solution import SolutionFields
    from .skin_surface import SkinSurface

CONTOUR_STEPS = (1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0)
"""Degrees between lines of equal phase, to choose from."""
MAX_CONTOURS = 9


@dataclass(frozen=True)
class DisplayedQuantity:
    """Values of a quantity and how they are displayed.

    values: (point,) in `unit`. contours: lines (3, n) on the skin. moment: frequency and Z, as
    text; empty where the values are those of all frequencies.
    """

    title: str
    moment: str
    unit: str
    colours: str
    cyclic: bool
    values: Real
    limits: tuple[float, float]
    arrows: Arrows | None = None
    contours: tuple[Real, ...] = ()
    note: str = ""

    @property
    def beyond(self) -> Literal["neither", "min", "max", "both"]:
        """Ends of the scale beyond which values lie."""
        low, high = self.limits
        rounding = 1e-9 * (high - low)
        below = bool(self.values.min() < low - rounding)
        above = bool(self.values.max() > high + rounding)
        if below and above:
            return "both"
        return "min" if below else "max" if above else "neither"


def at_frequencies(
    quantity: ViewedQuantity,
    fields: SolutionFields,
    skin: SkinSurface,
    numbers: Sequence[int],
) -> list[DisplayedQuantity]:
    """Quantity at frequencies by number, on the scales of `scales`."""
    values = [quantity.values(fields, at) for at in numbers]
    ends = scales(quantity, values, point_areas(fields))
    drawn = [
        _displayed(quantity, fields, skin, at, each, scale)
        for at, each, scale in zip(numbers, values, ends, strict=True)
    ]
    if len(set(ends)) == 1:
        return drawn
    return [replace(each, note=_note_with_scale(each)) for each in drawn]


def _note_with_scale(shown: DisplayedQuantity) -> str:
    """Note of a frame, and the ends of its colours, which other frames do not share."""
    scale = f"colours: {span_text(*shown.limits, shown.unit)}"
    return f"{shown.note}, {scale}" if shown.note else scale


def _displayed(
    quantity: ViewedQuantity,
    fields: SolutionFields,
    skin: SkinSurface,
    at: int,
    values: Real,
    scale: tuple[float, float],
) -> DisplayedQuantity:
    factor, unit = quantity.shown_unit(scale[1])
    closed = quantity.scale == "cyclic" and scale[1] - scale[0] == 360
    shown = DisplayedQuantity(
        title=quantity.title,
        moment="" if quantity.everywhere else heading(fields, at),
        unit=unit,
        colours=COLOUR_MAPS["cyclic" if closed else quantity.open_scale],
        cyclic=closed,
        values=factor * values,
        limits=(factor * scale[0], factor * scale[1]),
    )
    if skin.exaggeration and quantity.everywhere:
        return replace(shown, note=f"heights drawn {skin.exaggeration:g} times")
    if quantity.sheet is not None:
        moment = np.exp(-1j * np.angle(1 / fields.Z[at]))
        flow = np.real(moment * fields.current[quantity.sheet, at])
        note = "arrows: direction at the meter's greatest current"
        return replace(shown, arrows=arrows(skin, flow, scale[1]), note=note)
    if quantity.scale == "cyclic":
        lines, step = phase_contours(skin, difference(fields, at))
        return replace(shown, contours=lines, note=f"a line every {step:g}°")
    return shown


def over_one_period(
    quantity: ViewedQuantity, fields: SolutionFields, skin: SkinSurface, at: int, count: int
) -> list[DisplayedQuantity]:
    """Potential or current at `count` moments of one period."""
    complex_values = difference(fields, at)
    if quantity.sheet is not None:
        complex_values = fields.current[quantity.sheet, at]
    moments = 2 * np.pi * np.arange(count) / count
    moving = [np.real(np.exp(1j * moment) * complex_values) for moment in moments]
    values = moving if quantity.sheet is None else [np.hypot(*flow) for flow in moving]
    highest = max(end for _, end in scales(quantity, values, point_areas(fields)))
    factor, unit = quantity.shown_unit(highest)
    signed = quantity.sheet is None
    return [
        DisplayedQuantity(
            title=quantity.title,
            moment=f"{heading(fields, at)}\n{np.degrees(moment):.0f}° after the source's peak",
            unit=unit,
            colours=COLOUR_MAPS["signed" if signed else "magnitude"],
            cyclic=False,
            values=factor * each,
            limits=(-factor * highest if signed else 0.0, factor * highest),
            arrows=None if signed else arrows(skin, flow, highest),
        )
        for moment, flow, each in zip(moments, moving, values, strict=True)
    ]


def heading(fields: SolutionFields, at: int) -> str:
    """Frequency and Z, as text."""
    return f"{frequency_text(fields.frequency[at])}, Z = {impedance_text(fields.Z[at])}"


def frequency_text(frequency: float) -> str:
    """Frequency as text, such as 12.5 kHz."""
    return f"{frequency / 1e3:.4g} kHz"


def impedance_text(Z: complex) -> str:
    """Impedance as text, such as 21.3 − 105j kohm, or 20.9 kohm − 1.14j Mohm."""
    real, unit = _in_ohm(Z.real)
    imaginary, other = _in_ohm(abs(Z.imag))
    sign = "−" if Z.imag < 0 else "+"
    return f"{real} {'' if unit == other else f'{unit} '}{sign} {imaginary}j {other}"


def _in_ohm(value: float) -> tuple[str, str]:
    factor, unit = prefix(abs(value), "ohm")
    return f"{factor * value:.4g}".replace("-", "−"), unit


def phase_contours(skin: SkinSurface, V: Complex) -> tuple[tuple[Real, ...], float]:
    """Lines (3, n) of equal phase of V (point,), and the degrees between them.

    Where the phase is a, V exp(-ja) is real and positive, so that nothing jumps at 180 degrees.
    """
    turned = np.degrees(np.angle(V * np.exp(-1j * np.angle(V.mean()))))
    span = np.ptp(turned)
    step = next((step for step in CONTOUR_STEPS if span <= MAX_CONTOURS * step), 90.0)
    lines = [
        line for level in np.arange(-180, 180, step) for line in _isophase(skin, V, float(level))
    ]
    return tuple(lines), step


def _isophase(skin: SkinSurface, V: Complex, level: float) -> list[Real]:
    from .skin_surface import polygons

    turned = V * np.exp(-1j * np.radians(level)) / np.maximum(np.abs(V), np.finfo(float).tiny)
    mesh = polygons(skin.points, skin.cells)
    mesh.point_data["real"], mesh.point_data["imaginary"] = turned.real, turned.imag
    found = mesh.contour([0.0], scalars="imaginary")
    if not found.n_points:
        return []
    ends = found.lines.reshape(-1, 3)[:, 1:]
    ahead = found.point_data["real"][ends].min(axis=1) > 0
    return [np.asarray(found.points[pair], dtype=float).T for pair in ends[ahead]]
