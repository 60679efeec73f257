"""The page of a design: what each step gained, the wiring, what to cast, how good it is."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...report.page import Grid, Items, Picture, Section
from ...scene.scene import Scene
from ..bench import Asking
from ..flat import Along
from ..judged import Layout, designed
from ..picking import sweep_time
from ..search import Found, Step
from .scale import Scale, scale_of
from .wiring import Row


def sections_of(
    found: Found,
    asking: Asking,
    measured: tuple[Sequence[Along], Sequence[float]],
    table: Sequence[Row],
    folder: Path,
) -> list[Section]:
    """All that stands on the page.

    measured: how flat the optimum is along each number, and what is lost without each reading.
    table: the wiring. folder: where the charts are.
    """
    (flat, lost), scale = measured, scale_of(found.bench.scene, asking.asked)
    scene = designed(found.bench.scene, found.best.layout)
    return [
        Section("", [_meant(asking, scale)]),
        _gained(found, scale, folder),
        _wiring(found, table, lost, scale, folder),
        Section("What to cast", [Items(_cast(scene, flat, scale))]),
        _flatness(flat, scale, folder),
        Section("How far from the best", [_far(found, scale)]),
    ]


def _meant(asking: Asking, scale: Scale) -> str:
    """What the bounds are."""
    asked = asking.asked
    casts = (
        f"The tenth of {asked.casts} casts that is worst off counts, drawn as [dataset.session] of "
        "the scene says"
    )
    if scale.guess is None:
        return (
            f"Bounds are Bayes' accuracy of a {asked.target}, which no classifier of a known skin "
            f"exceeds: {_against(asked.against_rest)}. {casts}; each over {asking.draws} presses, "
            "the same for all designs."
        )
    return (
        "Bounds are those of Cramér and Rao on the place of a touch as large as a pixel, whose "
        f"strength is unknown, on a known skin: {_against(asked.against_rest)}. Half of all errors "
        f"of an unbiased estimate are larger. {casts}."
    )


def _gained(found: Found, scale: Scale, folder: Path) -> Section:
    of = f"nine of ten casts ({scale.unit})", "gained", f"as it was meant ({scale.unit})"
    sheets = "top, bottom sheet (kohm/sq)"
    heads = ["step", *of, sheets, "readings", "frequencies", "sweep (s)", "taken"]
    before = (None, *found.steps[:-1])
    rows = [_row(step, other, scale) for step, other in zip(found.steps, before, strict=True)]
    chart = Picture(folder / "steps.png", "The bound after each step", below=False)
    return Section("What each step gained", [Grid(heads, rows, (1, 2, 3, 5, 6, 7)), chart])


def _row(step: Step, before: Step | None, scale: Scale) -> list[str]:
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
        f"{time_of(step):.2f}",
        "yes" if step.taken else "no",
    ]


def _wiring(
    found: Found, table: Sequence[Row], lost: Sequence[float], scale: Scale, folder: Path
) -> Section:
    layout, unit = found.best.layout, "points" if scale.guess is None else "mm"
    told = [f"{_change(part, scale):.2g}" for part in lost] or [""]
    rows = [[*row, part] for row, part in zip(table, told, strict=True)]
    shown = (
        "The foils at each reading. Solid: foils of the top sheet; dashed, outside them: of the "
        "bottom sheet; grey: left open."
    )
    return Section(
        "Wiring",
        [
            Grid(["reading", "H", "L", "open", f"lost without it ({unit})"], rows, (4,)),
            Picture(folder / "wiring.png", shown),
            f"Every reading at {_listed(layout)} Hz. On the meter a sweep takes "
            f"{time_of(found.best):.2f} s, at the virtual meter's pace.",
        ],
    )


def _flatness(flat: Sequence[Along], scale: Scale, folder: Path) -> Section:
    chart = Picture(folder / "flat.png", "The bound where numbers are off", below=False)
    return Section("How flat the optimum is", [chart, Items([_told(each, scale) for each in flat])])


def _cast(scene: Scene, flat: Sequence[Along], scale: Scale) -> list[str]:
    """What a person mixes: sheets with their tolerance, and the foam."""
    within, foam = flat[0].within(scale.point), scene.skin.foam
    sheets = [
        f"{name} sheet: {1e-3 * sheet.sheet_resistance:.3g} kohm/sq, "
        f"{_between(sheet, within, scale)}"
        for name, sheet in (("top", scene.skin.top), ("bottom", scene.skin.bottom))
    ]
    thick = "" if foam.thickness is None else f", {1e3 * foam.thickness:.3g} mm thick"
    return [*sheets, f"foam: {1e9 * foam.unpressed_capacitance_per_area:.3g} nF/m²{thick}"]


def _between(sheet: Any, within: tuple[float, float], scale: Scale) -> str:
    ends = (1e-3 * sheet.sheet_resistance * end for end in within)
    told = "from {:.3g} to {:.3g} kohm/sq less than {} is lost, both together"
    return told.format(*ends, scale.named)


def _told(each: Along, scale: Scale) -> str:
    low, high = each.within(scale.point)
    return f"{each.name}: less than {scale.named} is lost from {low:.2g} to {high:.2g} times"


def _count(layout: Layout) -> str:
    if not layout.own:
        return str(len(layout.frequencies))
    counts = sorted(map(len, layout.of_each))
    return f"{counts[0]} to {counts[-1]}, {layout.numbers} in all"


def _listed(layout: Layout) -> str:
    if not layout.own:
        return ", ".join(f"{f:g}" for f in layout.frequencies)
    return "; ".join(
        f"{each.name}: {', '.join(f'{f:g}' for f in own)}"
        for each, own in zip(layout.readings, layout.of_each, strict=True)
    )


def _far(found: Found, scale: Scale) -> str:
    picked, by_each = found.picked, most_by_each(found)
    apart = ""
    if by_each is not None:
        apart = (
            "Had each reading frequencies of its own, as many in all, no choice would exceed "
            f"{_percent(by_each)} %. "
        )
    kind = "a share that pairs of presses give"
    if scale.guess is not None:
        kind = "how far touches are told over how far guesses are, taken from 1"
    return (
        f"Readings and frequencies are picked by {kind} "
        f"({_percent(picked.share)} % here), a concave function of what is read. At these "
        f"frequencies no other so many readings exceed {_percent(picked.most_by_readings)} % of "
        "it; of these readings no other so many candidates of frequencies exceed "
        f"{_percent(picked.most_by_frequencies)} %. {apart}All hold for that share, on the "
        "casts that were picked for, and each while the other stays. Sheets are looked for along "
        "one number at a time, and of those nothing is proven."
    )


def _against(rests: int) -> str:
    if not rests:
        return "a sweep alone, with the meter's errors of the session"
    return f"a sweep against {counted(rests, 'sweep')} at rest of the same session"


def _change(part: float, scale: Scale) -> float:
    """What is lost, as a positive number."""
    return abs(scale.change(part)) if part > 0 else -abs(scale.change(part))


def _percent(share: float) -> str:
    return f"{100 * share:.1f}"


def time_of(step: Step) -> float:
    """Of a sweep, s, at the virtual meter's pace."""
    return sweep_time(step.layout.of_each)


def counted(count: int, noun: str) -> str:
    """A number of things in words."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def most_by_each(found: Found) -> float | None:
    """What no choice of own frequencies for each reading exceeds; None where that is not known."""
    return found.bench.most_by_each(found.best.layout.material, found.picked)
