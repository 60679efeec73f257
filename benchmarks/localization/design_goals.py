"""What could a skin be designed to tell at best? Pixels, columns, positions and pairs.

`rcskin design` is asked for each goal on a built-in sheet with other pixels, and its own report is
read: the best accuracy of any classifier of a known skin, or how near half of all answers can come,
before and after; on the nominal skin, and on the worst of three samples. Nothing is trained
but the simulator's reduced model.

With a folder of searches, goals that were told are not searched again, by `twin_design.py` neither.

Run: python benchmarks/localization/design_goals.py [--searches FOLDER] [--only GOAL] [--quick]
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd
from rcskin.benchmarks.bench import SEARCHES_OPTION, Run, launch
from rcskin.benchmarks.localization.designs import USUAL, searched
from rcskin.benchmarks.localization.twins import DOUBLE, ONE, SINGLE, TWO, believed
from rcskin.simulator.design.design_charts import scale_of
from rcskin.simulator.scene.design_goals import Design, Target
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

QUICK = ("--casts", "1", "--draws", "20")
MORE = "--frequencies", "40", "--band", "5e3:200e3"
HALVES = {"low": (0.0, 0.495), "high": (0.505, 1.0)}
HALVED = [
    {"name": f"{sheet}-{half}", "electrode": sheet, "edge": "left", "span": list(span)}
    for sheet in ("top", "bottom")
    for half, span in HALVES.items()
]
"""Foils along the halves of one edge, in the place of one along all of it."""
FOUR_ON_ONE_EDGE = {
    "contact": HALVED,
    "interface": [
        {"name": "left", "high": ["top-low", "top-high"], "low": ["bottom-low", "bottom-high"]}
    ],
}


@dataclass(frozen=True)
class Goal:
    """One of them. asked: options of the search beside its target; changed: keys of the sheet."""

    name: str
    base: str
    pixels: int
    target: Target = "pixel"
    asked: tuple[str, ...] = ()
    changed: Mapping[str, object] = field(default_factory=dict)

    @property
    def scene(self) -> Scene:
        """That the search begins with."""
        touches = DOUBLE if self.target == "pair" else SINGLE
        plain = believed(self.base, self.pixels, touches, anywhere=self.target == "position")
        return plain.with_(dict(self.changed))

    @property
    def options(self) -> tuple[str, ...]:
        """Of the search, as a user gives them."""
        told = () if self.target == "pixel" else ("--target", self.target)
        return *told, *self.asked


GOALS = (
    Goal("3x3 pixels", TWO, 3),
    Goal("6x6 pixels", TWO, 6, asked=("--seconds", "0.4", "--sheet-ratio", "1")),
    Goal("6x6 pixels", TWO, 6, asked=("--seconds", "1", "--readings", "12", "--sheet-ratio", "1")),
    Goal("8x8 columns from one edge, two wires", ONE, 8, "column"),
    Goal("8x8 columns from one edge, two wires", ONE, 8, "column", MORE),
    Goal("8x8 columns from one edge, two wires", ONE, 8, "column", ("--grading", "10")),
    Goal("8x8 columns from one edge, four wires", ONE, 8, "column", (), FOUR_ON_ONE_EDGE),
    Goal("positions on 5x5 pixels", TWO, 5, "position"),
    Goal("pairs on 4x4 pixels", TWO, 4, "pair"),
)
FEW = (Goal("2x2 pixels", TWO, 2), Goal("positions on 2x2 pixels", TWO, 2, "position"))


def row(goal: Goal, folder: Path, usual: tuple[str, ...]) -> dict[str, object]:
    """What was found, searched for where it is not there."""
    told = searched(goal.scene, (*goal.options, *usual), folder)
    steps = json.loads((told / "design.json").read_text(encoding="utf-8"))["steps"]
    before, after = steps[0], [each for each in steps[1:] if each["taken"]][-1]
    scale = scale_of(goal.scene.parts, Design(target=goal.target))
    sheets = " and ".join(f"{each:.0f}" for each in _sheets(after))
    return {
        "goal": goal.name,
        "requested": f"`{' '.join(goal.options)}`" if goal.options else "",
        "as it was": f"{scale.text(before['nine_of_ten_samples'])} {scale.unit}",
        "designed, worst of three": f"{scale.text(after['nine_of_ten_samples'])} {scale.unit}",
        "nominal skin": f"{scale.text(after['nominal'])} {scale.unit}",
        "sheets (kohm/sq)": sheets,
        "readings": _readings(told),
        "frequencies": len(after["frequencies_Hz"]),
        "sweep (s)": f"{after['sweep_s']:.2g}",
    }


def _sheets(step: Mapping[str, float]) -> list[float]:
    return sorted({1e-3 * step["top_ohm_sq"], 1e-3 * step["bottom_ohm_sq"]})


def _readings(folder: Path) -> int:
    return len(load_scene(folder / "design.toml").interfaces)


def main(run: Run) -> None:
    """Search for all, or for those that are asked for, and publish."""
    goals = [each for each in run.sized(GOALS, FEW) if (run.asked.only or "") in each.name]
    usual = run.sized(USUAL, QUICK)
    with run.kept(run.asked.searches) as folder:
        table = pd.DataFrame([row(goal, folder, usual) for goal in goals])
    run.publish("design_goals", "Best skins that could be designed for each goal", table)


if __name__ == "__main__":
    launch(
        main, SEARCHES_OPTION | {"--only": {"default": "", "help": "Goals whose name holds this."}}
    )
