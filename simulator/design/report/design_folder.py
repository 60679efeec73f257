"""The folder of a design: the scene, the wiring table, charts, numbers and the report."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...report.files import filled_at_once, write_json, write_rows, write_text
from ...report.page import write_page
from ...scene.scene import Scene
from ...scene.scene_files import scene_text
from ..evaluator import SearchSettings
from ..layout import Layout, designed
from ..search import SearchResult
from ..sensitivity import SensitivityCurve, loss_without_each, sensitivity_curves
from .design_charts import MeritScale, draw_flat, draw_steps, draw_wiring, scale_of
from .design_page import WiringRow, bound_with_own_frequencies, counted, rows, sections_of

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


def write_folder(found: SearchResult, settings: SearchSettings, folder: Path) -> None:
    """Writes all files of a design. Raises InputError as bounds do."""
    scene, layout = scene_of(found), found.best.layout
    settings.progress("sensitivity")
    flat, lost = (
        sensitivity_curves(found.evaluator, layout),
        loss_without_each(found.evaluator, layout),
    )
    scale = scale_of(found.evaluator.parts, settings.request)
    table = rows(scene.parts.skin, found.evaluator.wired, layout.readings)
    with filled_at_once(folder) as made:
        write_text(made / DESIGN, scene_text(scene))
        write_rows(made / "wiring.csv", WiringRow._fields, table)
        write_json(made / "design.json", _numbers(found, flat, lost, scale))
        draw_steps(found.steps, scale.wanted(settings.request), scale, made / "steps.png")
        draw_flat(flat, scale, made / "flat.png")
        draw_wiring(scene.parts.skin, layout.readings, made / "wiring.png")
        sections = sections_of(found, settings, (flat, lost), table, made)
        name = f"{found.evaluator.parts.skin.name}: a design"
        write_page(made / "report.html", name, sections, answer(found, settings))


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
                "nine_of_ten_casts": step.tenth,
                "as_meant": step.nominal,
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
