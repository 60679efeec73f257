"""Report of a design: gain of each step, wiring, what to make, sensitivity, bounds; the scene."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from ..report.files import write_text
from ..report.findings import Chart, DataTable, Finding, Findings, Head, Heading, Items
from ..scene.contacts import Interface
from ..scene.parts import Skin
from ..scene.scene import Scene
from ..scene.scene_files import scene_text
from ..scene.wiring_checks import conductor_groups
from .design_charts import MeritScale, draw_flat, draw_steps, draw_wiring, scale_of
from .evaluator import SearchSettings
from .layout import Layout, designed
from .search import SearchResult, SearchStep
from .sensitivity import SensitivityCurve, loss_without_each, sensitivity_curves


def wiring(
    skin: Skin, wired: Sequence[str], readings: Sequence[Interface]
) -> list[tuple[str, ...]]:
    """Name, wires on the high and the low side, and open wires of each reading.

    wired: first foils of the terminals that have a wire.
    """
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
        found.append((each.name, *map(" + ".join, sides)))
    return found


def parts_of(
    found: SearchResult,
    settings: SearchSettings,
    measured: tuple[Sequence[SensitivityCurve], Sequence[float]],
    table: Sequence[tuple[str, ...]],
) -> list[Finding]:
    """All parts of the report.

    measured: sensitivity to each number, and loss without each reading. table: the wiring.
    """
    (flat, lost), scale = measured, scale_of(found.evaluator.parts, settings.request)
    skin = designed(found.evaluator.parts.scene, found.best.layout).parts.skin
    return [
        _bounds_meaning(settings, scale),
        *_gain(found, scale, scale.wanted(settings.request)),
        *_wiring(found, skin, table, lost, scale),
        Heading("What to make"),
        Items(_material_items(skin, flat, scale)),
        Heading("Sensitivity of the optimum"),
        Chart("flat", "The bound at other values", partial(draw_flat, flat, scale), below=False),
        Items([_sensitivity_sentence(each, scale) for each in flat]),
        Heading("Distance from the best choice"),
        _distance_from_best(found, scale),
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


def _gain(found: SearchResult, scale: MeritScale, wanted: float | None) -> list[Finding]:
    heads = [
        "step",
        *(f"nine of ten samples ({scale.unit})", "gain", f"nominal skin ({scale.unit})"),
        "top, bottom sheet (kohm/sq)",
        *("readings", "frequencies", "sweep (s)"),
        "taken",
    ]
    before = (None, *found.steps[:-1])
    rows = [_row(step, other, scale) for step, other in zip(found.steps, before, strict=True)]
    columns = [
        Head(head, form=str if k in (1, 2, 3, 5, 6, 7) else "") for k, head in enumerate(heads)
    ]
    chart = partial(draw_steps, found.steps, wanted, scale)
    return [
        Heading("Gain of each step"),
        DataTable("gains", columns, rows),
        Chart("steps", "The bound after each step", chart, below=False),
    ]


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


def _wiring(
    found: SearchResult,
    skin: Skin,
    table: Sequence[tuple[str, ...]],
    lost: Sequence[float],
    scale: MeritScale,
) -> list[Finding]:
    layout, unit = found.best.layout, "points" if scale.guess is None else "mm"
    losses = [f"{_change(part, scale):.2g}" for part in lost] or [""]
    rows = [[*row, part] for row, part in zip(table, losses, strict=True)]
    loss = Head("loss", f"loss without it ({unit})", str)
    wires = ["reading", Head("high", "H"), Head("low", "L"), "open", loss]
    caption = (
        "The foils at each reading. Solid: top sheet; dashed, outside them: bottom sheet; grey: "
        "open."
    )
    return [
        Heading("Wiring"),
        DataTable("wiring", wires, rows, csv=True),
        Chart("wiring", caption, partial(draw_wiring, skin, layout.readings)),
        f"Frequencies of the readings: {_listed(layout)} Hz. A sweep takes "
        f"{found.best.seconds:.2f} s.",
    ]


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


DESIGN = "design.toml"
WRITTEN = (DESIGN, "design.json", "report.html", "wiring.*", "steps.png", "flat.png")
"""Name patterns of the written files."""


def scene_of(found: SearchResult) -> Scene:
    """The design as a parts."""
    parts = found.evaluator.parts
    text = {
        "name": f"{parts.skin.name}-designed",
        "description": f"designed from {parts.skin.name}",
    }
    return designed(parts.scene, found.best.layout).with_(text)


def answer(found: SearchResult, settings: SearchSettings) -> str:
    """Result of a search in one line, compared with the required merit."""
    request, best = settings.request, found.best
    scale = scale_of(found.evaluator.parts, request)
    text = (
        f"{scale.of}: {scale.text(best.tenth)} {scale.unit} on nine of ten samples "
        f"(given scene: {scale.text(found.before.tenth)} {scale.unit}), with "
        f"{counted(len(best.layout.readings), 'reading')} of "
        f"{counted(len(found.evaluator.wired), 'wire')}"
    )
    wanted = scale.wanted(request)
    if wanted is None:
        return text
    goal = f"{scale.number(wanted):g} {scale.unit}"
    if best.tenth >= wanted:
        return f"{goal} is reached: {text}"
    return f"{goal} is not reached by any design found; the best: {text}"


def report_of(found: SearchResult, settings: SearchSettings) -> Findings:
    """Sentences, tables, charts, numbers and the scene of a design. Raises as bounds do."""
    scene, layout = scene_of(found), found.best.layout
    settings.progress("sensitivity")
    flat, lost = (
        sensitivity_curves(found.evaluator, layout),
        loss_without_each(found.evaluator, layout),
    )
    scale = scale_of(found.evaluator.parts, settings.request)
    table = wiring(scene.parts.skin, found.evaluator.wired, layout.readings)
    return Findings(
        f"{found.evaluator.parts.skin.name}: a design",
        parts_of(found, settings, (flat, lost), table),
        answer(found, settings),
        _numbers(found, flat, lost, scale),
        {DESIGN: lambda path: write_text(path, scene_text(scene))},
    )


def _numbers(
    found: SearchResult, flat: Sequence[SensitivityCurve], lost: Sequence[float], scale: MeritScale
) -> dict[str, Any]:
    """Shares of sweeps, or merits of positions with the distance at merit 0."""
    picked, layout = found.picked, found.best.layout
    guess = {} if scale.guess is None else {"distance_of_a_guess_m": scale.guess}
    return guess | {
        "steps": [
            {
                "step": step.name,
                "nine_of_ten_samples": step.tenth,
                "nominal": step.nominal,
                "top_ohm_sq": step.layout.material.top,
                "bottom_ohm_sq": step.layout.material.bottom,
                "readings": [each.name for each in step.layout.readings],
                "frequencies_Hz": list(step.layout.frequencies),
                **_of_each(step.layout),
                "sweep_s": step.seconds,
                "taken": step.taken,
            }
            for step in found.steps
        ],
        "lost_without": dict(zip((each.name for each in layout.readings), lost, strict=False)),
        "less_than_a_point_lost": {each.name: each.within(scale.point) for each in flat},
        "by_pairs": {
            "share": picked.share,
            "most_by_other_readings": picked.bound_over_readings,
            "most_by_other_frequencies": picked.bound_over_frequencies,
            "most_by_frequencies_of_each_reading": bound_with_own_frequencies(found),
        },
    }


def _of_each(layout: Layout) -> dict[str, Any]:
    if not layout.has_own_frequencies:
        return {}
    names = (each.name for each in layout.readings)
    return {
        "frequencies_of_each_Hz": dict(
            zip(names, map(list, layout.frequencies_of_each), strict=True)
        )
    }
