"""The folder of a design: the scene, the wiring table, charts, numbers and the report."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...report.files import filled_at_once, write_json, write_rows, write_text
from ...report.page import Grid, Items, Picture, Section, write_page
from ...scene.files import scene_text
from ...scene.scene import Scene
from ..bench import Asking
from ..flat import Along, along_all, worth
from ..judged import Layout, designed
from ..picking import sweep_time
from ..search import Found, Step
from .figure import draw_flat, draw_steps, draw_wiring
from .scale import Scale, scale_of
from .wiring import Row, rows

DESIGN = "design.toml"
WRITTEN = (DESIGN, "design.json", "report.html", "wiring.*", "steps.png", "flat.png")
"""Patterns of the names of what is written."""


def scene_of(found: Found) -> Scene:
    """The design as a scene."""
    scene = found.bench.scene
    told = {"name": f"{scene.name}-designed", "description": f"a design begun from {scene.name}"}
    return designed(scene, found.best.layout).with_(told)


def answer(found: Found, asking: Asking) -> str:
    """What was found, and whether that is what was wanted, in one line."""
    asked, best = asking.asked, found.best
    scale = scale_of(found.bench.scene, asked)
    told = (
        f"{asked.target}s {scale.of} {scale.text(best.tenth)} {scale.unit} on nine of ten casts "
        f"(as it was: {scale.text(found.before.tenth)} {scale.unit}), "
        f"{_counted(len(best.layout.readings), 'reading')} of "
        f"{_counted(len(found.bench.wired), 'wire')}"
    )
    wanted = scale.wanted(asked)
    if wanted is None:
        return told
    wish = f"{scale.number(wanted):g} {scale.unit}"
    if best.tenth >= wanted:
        return f"{wish} is within reach: {told}"
    return f"{wish} is not reached by any design found; the best: {told}"


def write_folder(found: Found, asking: Asking, folder: Path) -> None:
    """All files, each whole. Raises InputError as bounds do."""
    scene, layout = scene_of(found), found.best.layout
    asking.progress("how flat it is")
    flat, lost = along_all(found.bench, layout), worth(found.bench, layout)
    scale = scale_of(found.bench.scene, asking.asked)
    table = rows(scene, found.bench.wired, layout.readings)
    with filled_at_once(folder) as made:
        write_text(made / DESIGN, scene_text(scene))
        write_rows(made / "wiring.csv", Row._fields, table)
        write_json(made / "design.json", _numbers(found, flat, lost, scale))
        draw_steps(found.steps, scale.wanted(asking.asked), scale, made / "steps.png")
        draw_flat(flat, scale, made / "flat.png")
        draw_wiring(scene, layout.readings, made / "wiring.png")
        sections = [
            Section("", [_meant(asking, scale)]),
            _gained(found, scale, made),
            _wiring(found, table, lost, scale, made),
            Section("What to cast", [Items(_cast(scene, flat, scale))]),
            _flatness(flat, scale, made),
            Section("How far from the best", [_far(found, scale)]),
        ]
        name = f"{found.bench.scene.name}: a design"
        write_page(made / "report.html", name, sections, answer(found, asking))


def _numbers(
    found: Found, flat: Sequence[Along], lost: Sequence[float], scale: Scale
) -> dict[str, Any]:
    """Shares of sweeps, or merits of positions beside the distance at merit 0."""
    picked, layout = found.picked, found.best.layout
    guess = {} if scale.guess is None else {"distance_of_a_guess_m": scale.guess}
    return guess | {
        "steps": [
            {
                "step": step.name,
                "nine_of_ten_casts": step.tenth,
                "as_meant": step.nominal,
                "top_ohm_sq": step.layout.material.top,
                "bottom_ohm_sq": step.layout.material.bottom,
                "readings": [each.name for each in step.layout.readings],
                "frequencies_Hz": list(step.layout.frequencies),
                **_of_each(step.layout),
                "sweep_s": _time(step),
                "taken": step.taken,
            }
            for step in found.steps
        ],
        "lost_without": dict(zip((each.name for each in layout.readings), lost, strict=False)),
        "less_than_a_point_lost": {each.name: each.within(scale.point) for each in flat},
        "by_pairs": {
            "share": picked.share,
            "most_by_other_readings": picked.most_by_readings,
            "most_by_other_frequencies": picked.most_by_frequencies,
            "most_by_frequencies_of_each_reading": _most_by_each(found),
        },
    }


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
            f"{_time(found.best):.2f} s, at the virtual meter's pace.",
        ],
    )


def _flatness(flat: Sequence[Along], scale: Scale, folder: Path) -> Section:
    chart = Picture(folder / "flat.png", "The bound where numbers are off", below=False)
    return Section("How flat the optimum is", [chart, Items([_told(each, scale) for each in flat])])


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
        f"{_time(step):.2f}",
        "yes" if step.taken else "no",
    ]


def _cast(scene: Scene, flat: Sequence[Along], scale: Scale) -> list[str]:
    """What a person mixes: sheets with their tolerance, and the foam."""
    within, foam = flat[0].within(scale.point), scene.skin.foam
    sheets = [
        f"{name} sheet: {1e-3 * sheet.sheet_resistance:.3g} kohm/sq, "
        f"{_between(sheet, within, scale)}"
        for name, sheet in (("top", scene.skin.top), ("bottom", scene.skin.bottom))
    ]
    thick = "" if foam.thickness is None else f", {1e3 * foam.thickness:.3g} mm thick"
    return [*sheets, f"foam: {1e9 * foam.rest_capacitance_per_area:.3g} nF/m²{thick}"]


def _between(sheet: Any, within: tuple[float, float], scale: Scale) -> str:
    ends = (1e-3 * sheet.sheet_resistance * end for end in within)
    told = "from {:.3g} to {:.3g} kohm/sq less than {} is lost, both together"
    return told.format(*ends, scale.named)


def _told(each: Along, scale: Scale) -> str:
    low, high = each.within(scale.point)
    return f"{each.name}: less than {scale.named} is lost from {low:.2g} to {high:.2g} times"


def _most_by_each(found: Found) -> float | None:
    return found.bench.most_by_each(found.best.layout.material, found.picked)


def _of_each(layout: Layout) -> dict[str, Any]:
    if not layout.own:
        return {}
    names = (each.name for each in layout.readings)
    return {"frequencies_of_each_Hz": dict(zip(names, map(list, layout.of_each), strict=True))}


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
    picked, by_each = found.picked, _most_by_each(found)
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
    return f"a sweep against {_counted(rests, 'sweep')} at rest of the same session"


def _change(part: float, scale: Scale) -> float:
    """What is lost, as a positive number."""
    return abs(scale.change(part)) if part > 0 else -abs(scale.change(part))


def _time(step: Step) -> float:
    return sweep_time(step.layout.of_each)


def _percent(share: float) -> str:
    return f"{100 * share:.1f}"


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"
