"""Page of a design: gain of each step, wiring, what to make, sensitivity and bounds."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from ...report.page import Items, Picture, ReportSection, TableGrid
from ...scene.contacts import Interface
from ...scene.parts import Skin
from ...scene.wiring_checks import conductor_groups
from ..evaluator import SearchSettings
from ..layout import Layout, designed
from ..search import SearchResult, SearchStep
from ..sensitivity import SensitivityCurve
from .design_charts import MeritScale, scale_of


class WiringRow(NamedTuple):
    """One reading: its name, wires on the high and the low side, and open wires."""

    reading: str
    high: str
    low: str
    open: str


def rows(skin: Skin, wired: Sequence[str], readings: Sequence[Interface]) -> list[WiringRow]:
    """A row for each reading. wired: first foils of the terminals that have a wire."""
    first = conductor_groups(skin.contacts, skin)
    leader = {c.name: skin.contacts[k].name for c, k in zip(skin.contacts, first, strict=True)}
    found = []
    for each in readings:
        high, low = ({leader[name] for name in side} for side in (each.high, each.low))
        sides = (
            [name for name in wired if name in high],
            [name for name in wired if name in low],
            [name for name in wired if name not in high | low],
        )
        found.append(WiringRow(each.name, *map(" + ".join, sides)))
    return found


def sections_of(
    found: SearchResult,
    settings: SearchSettings,
    measured: tuple[Sequence[SensitivityCurve], Sequence[float]],
    table: Sequence[WiringRow],
    folder: Path,
) -> list[ReportSection]:
    """All sections of the page.

    measured: sensitivity to each number, and loss without each reading. table: the wiring. folder:
    of the charts.
    """
    (flat, lost), scale = measured, scale_of(found.evaluator.parts, settings.request)
    skin = designed(found.evaluator.parts.scene, found.best.layout).parts.skin
    return [
        ReportSection("", [_bounds_meaning(settings, scale)]),
        _gain_section(found, scale, folder),
        _wiring_section(found, table, lost, scale, folder),
        ReportSection("What to make", [Items(_material_items(skin, flat, scale))]),
        _sensitivity_section(flat, scale, folder),
        ReportSection("Distance from the best choice", [_distance_from_best(found, scale)]),
    ]


def _bounds_meaning(settings: SearchSettings, scale: MeritScale) -> str:
    """Meaning of the bounds."""
    request = settings.request
    readings = _baseline_text(request.against_rest)
    casts = (
        f"The value is what nine of ten of {request.casts} skin samples reach, drawn from "
        "[dataset.session] of the scene"
    )
    if scale.guess is None:
        return (
            f"Bounds are Bayes' accuracy of a {request.target}, which no classifier of a known "
            f"skin exceeds: {readings}. {casts}; each over {settings.draws} "
            "presses, the same for all designs."
        )
    return (
        "Bounds are those of Cramér and Rao on the position of a touch of the size of a pixel, of "
        f"unknown strength, on a known skin: {readings}. Half of all errors "
        f"of an unbiased estimate are larger. {casts}."
    )


def _gain_section(found: SearchResult, scale: MeritScale, folder: Path) -> ReportSection:
    of = f"nine of ten samples ({scale.unit})", "gain", f"nominal skin ({scale.unit})"
    sheets = "top, bottom sheet (kohm/sq)"
    heads = ["step", *of, sheets, "readings", "frequencies", "sweep (s)", "taken"]
    before = (None, *found.steps[:-1])
    rows = [_row(step, other, scale) for step, other in zip(found.steps, before, strict=True)]
    chart = Picture(folder / "steps.png", "The bound after each step", below=False)
    return ReportSection("Gain of each step", [TableGrid(heads, rows, (1, 2, 3, 5, 6, 7)), chart])


def _row(step: SearchStep, before: SearchStep | None, scale: MeritScale) -> list[str]:
    material = step.layout.material
    gained = "" if before is None else f"{scale.change(step.tenth - before.tenth):+.2g}"
    return [
        step.name,
        scale.text(step.tenth),
        gained,
        scale.text(step.nominal),
        f"{1e-3 * material.top:.3g}, {1e-3 * material.bottom:.3g}",
        str(len(step.layout.readings)),
        _count(step.layout),
        f"{step.seconds:.2f}",
        "yes" if step.taken else "no",
    ]


def _wiring_section(
    found: SearchResult,
    table: Sequence[WiringRow],
    lost: Sequence[float],
    scale: MeritScale,
    folder: Path,
) -> ReportSection:
    layout, unit = found.best.layout, "points" if scale.guess is None else "mm"
    losses = [f"{_change(part, scale):.2g}" for part in lost] or [""]
    rows = [[*row, part] for row, part in zip(table, losses, strict=True)]
    caption = (
        "The foils at each reading. Solid: top sheet; dashed, outside them: bottom sheet; grey: "
        "open."
    )
    return ReportSection(
        "Wiring",
        [
            TableGrid(["reading", "H", "L", "open", f"loss without it ({unit})"], rows, (4,)),
            Picture(folder / "wiring.png", caption),
            f"Frequencies of the readings: {_listed(layout)} Hz. A sweep takes "
            f"{found.best.seconds:.2f} s.",
        ],
    )


def _sensitivity_section(
    flat: Sequence[SensitivityCurve], scale: MeritScale, folder: Path
) -> ReportSection:
    chart = Picture(folder / "flat.png", "The bound at other values than designed", below=False)
    lines = [_sensitivity_sentence(each, scale) for each in flat]
    return ReportSection("Sensitivity of the optimum", [chart, Items(lines)])


def _material_items(skin: Skin, flat: Sequence[SensitivityCurve], scale: MeritScale) -> list[str]:
    """Properties to make: sheets with their tolerance, and the foam."""
    within, foam = flat[0].within(scale.point), skin.foam
    sheets = [
        f"{name} sheet: {1e-3 * sheet.sheet_resistance:.3g} kohm/sq, "
        f"{_between(sheet, within, scale)}"
        for name, sheet in (("top", skin.top), ("bottom", skin.bottom))
    ]
    thick = "" if foam.thickness is None else f", {1e3 * foam.thickness:.3g} mm thick"
    return [*sheets, f"foam: {1e9 * foam.unpressed_capacitance_per_area:.3g} nF/m²{thick}"]


def _between(sheet: Any, within: tuple[float, float], scale: MeritScale) -> str:
    ends = (1e-3 * sheet.sheet_resistance * end for end in within)
    losses = "from {:.3g} to {:.3g} kohm/sq the loss is less than {}, for both sheets together"
    return losses.format(*ends, scale.named)


def _sensitivity_sentence(each: SensitivityCurve, scale: MeritScale) -> str:
    low, high = each.within(scale.point)
    return f"{each.name}: the loss is less than {scale.named} from {low:.2g} to {high:.2g} times"


def _count(layout: Layout) -> str:
    if not layout.has_own_frequencies:
        return str(len(layout.frequencies))
    counts = sorted(map(len, layout.frequencies_of_each))
    return f"{counts[0]} to {counts[-1]}, {layout.count} in all"


def _listed(layout: Layout) -> str:
    if not layout.has_own_frequencies:
        return ", ".join(f"{f:g}" for f in layout.frequencies)
    return "; ".join(
        f"{each.name}: {', '.join(f'{f:g}' for f in own)}"
        for each, own in zip(layout.readings, layout.frequencies_of_each, strict=True)
    )


def _distance_from_best(found: SearchResult, scale: MeritScale) -> str:
    picked, by_each = found.picked, bound_with_own_frequencies(found)
    own_bound = ""
    if by_each is not None:
        own_bound = (
            "With own frequencies for each reading, of the same total number, the bound is "
            f"{_percent(by_each)} %. "
        )
    kind = "the share of correct answers to pairs of presses"
    if scale.guess is not None:
        kind = "1 minus the position error over that of a guess"
    return (
        f"Readings and frequencies are picked by {kind} ({_percent(picked.share)} % here), a "
        "concave function of the readings. At these frequencies, no other readings of the same "
        f"number exceed {_percent(picked.bound_over_readings)} %. For these readings, no other "
        "candidate frequencies of the same number exceed "
        f"{_percent(picked.bound_over_frequencies)} %. {own_bound}These bounds hold for the "
        "samples that the picks were made for. The search changes one number of the sheets at a "
        "time; there is no bound for other sheets."
    )


def _baseline_text(count: int) -> str:
    if not count:
        return "a sweep alone, with the meter's errors of the session"
    return f"a sweep compared with {counted(count, 'baseline sweep')} of the same session"


def _change(part: float, scale: MeritScale) -> float:
    """A loss as a positive number."""
    return abs(scale.change(part)) if part > 0 else -abs(scale.change(part))


def _percent(share: float) -> str:
    return f"{100 * share:.1f}"


def counted(count: int, label: str) -> str:
    """A count with its label, which gets a plural s."""
    return f"{count} {label}{'' if count == 1 else 's'}"


def bound_with_own_frequencies(found: SearchResult) -> float | None:
    """Upper bound with own frequencies for each reading; None where it is unknown."""
    return found.evaluator.bound_with_own_frequencies(found.best.layout.material, found.picked)
