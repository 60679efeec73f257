"""The folder of a design: the scene, the wiring table, charts, numbers and the report."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...report.files import filled_at_once, write_json, write_rows, write_text
from ...report.page import write_page
from ...scene.scene import Scene
from ...scene.scene_files import scene_text
from ..bench import Asking
from ..flat import Along, along_all, worth
from ..judged import Layout, designed
from ..search import Found
from .figure import draw_flat, draw_steps, draw_wiring
from .page import counted, most_by_each, sections_of, time_of
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
        f"{counted(len(best.layout.readings), 'reading')} of "
        f"{counted(len(found.bench.wired), 'wire')}"
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
        sections = sections_of(found, asking, (flat, lost), table, made)
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
                "sweep_s": time_of(step),
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
            "most_by_frequencies_of_each_reading": most_by_each(found),
        },
    }


def _of_each(layout: Layout) -> dict[str, Any]:
    if not layout.own:
        return {}
    names = (each.name for each in layout.readings)
    return {"frequencies_of_each_Hz": dict(zip(names, map(list, layout.of_each), strict=True))}
