"""What a finger buys: how well a touch is told at best, by its capacitance and how hard it presses.

Bayes' accuracy of columns of the paper's sheet, for fingers that touch without a press and that
press, and of telling rod, finger and touch apart. The skin is known, sweeps are compared with six
at rest; the finger's capacitance is known, too.

Run: python benchmarks/localization/fingers.py [--quick]
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
from rcskin.benchmarks.bench import Run, launch
from rcskin.simulator.bounds.bayes import bayes
from rcskin.simulator.bounds.touch_readings import Hypothesis, TouchReadings, hypotheses, kinds
from rcskin.simulator.chart_style import COLOURS, chart
from rcskin.simulator.scene.randomisation import Fixed, Normal
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

CAPACITANCES, FEW = (0.0, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0), (0.0, 5.0)
"""pF."""
ROD = 0.125
"""pF, where a chart of logarithms has the rod."""
FACTORS = (1.0, 1.3, 2.0)
SPREAD = 0.1
"""Of the rise of c between presses."""
RESTS, DRAWS, FEW_DRAWS = 6, 500, 50
RIM = {"mutual": 5.39e-12, "top": 5.47e-12, "bottom": 5.47e-12}
"""F/m, along the outline of the paper's sheet, from charges of a three-dimensional solve."""


def around(name: str, pixels: int) -> Scene:
    """A built-in scene with earth around it."""
    changes = {"surroundings": {"rim": RIM}, "pixels": pixels, "press.finger": 1e-12}
    return load_scene(name).with_(changes)


def by_finger(among: list[Hypothesis], C: float) -> list[Hypothesis]:
    """The same touched by what has this capacitance, F; a rod has none."""
    return [replace(each, fingers=(C,) * len(each.pixels) if C else ()) for each in among]


def rows(scene: Scene, target: str, run: Run) -> list[dict[str, object]]:
    """Of one scene, a row for each capacitance and each factor."""
    readings = TouchReadings(scene.parts, Normal(mean=FACTORS[-1], deviation=0.2), RESTS)
    told, draws = [], run.sized(DRAWS, FEW_DRAWS)
    for C in run.sized(CAPACITANCES, FEW):
        for factor in FACTORS:
            rise = factor - 1
            presses = Normal(mean=factor, deviation=SPREAD * rise) if rise else Fixed(value=1.0)
            among = by_finger(hypotheses(scene.parts.skin, scene.parts.plan, target), 1e-12 * C)
            right = bayes(readings, among, presses, 1, draws)
            row: dict[str, object] = {"finger (pF)": C, "factor": factor}
            row |= {"right at most (%)": 100 * right.share, "error": 100 * right.error}
            if C and rise:
                ways = [each for each in kinds(scene.parts.skin, scene.parts.plan)]
                ways = [
                    each if not each.fingers else replace(each, fingers=(1e-12 * C,))
                    for each in ways
                ]
                row["rod, finger or touch (%)"] = (
                    100 * bayes(readings, ways, presses, 1, draws).share
                )
            told.append(row)
        print(target, C, flush=True)
    return told


def draw(table: pd.DataFrame, path: Path) -> None:
    """A curve for each factor."""
    with chart(path, 6.0, 3.6) as figure:
        axes = figure.subplots()
        for k, (factor, each) in enumerate(table.groupby("factor")):
            name = "touch without a press" if factor == 1 else f"pressed, c times {factor:g}"
            at = np.maximum(each["finger (pF)"], ROD)
            axes.plot(at, each["right at most (%)"], "o-", ms=4, color=COLOURS[k], label=name)
        axes.set_xscale("log", base=2)
        axes.set_xticks([ROD, *CAPACITANCES[1:]], ["rod", *map("{:g}".format, CAPACITANCES[1:])])
        axes.set_xlabel("capacitance of the finger to earth (pF)")
        axes.set_ylabel("columns right at most (%)")
        axes.legend(frameon=False)


def main(run: Run) -> None:
    """All capacitances."""
    table = pd.DataFrame(rows(around("sheet-5x5", run.sized(5, 2)), "column", run))
    title = "Upper bound on the accuracy of columns by a finger's capacitance and the press"
    run.publish(
        "fingers",
        title,
        table.round({name: 1 for name in table.columns[2:]}).astype(object).fillna("-"),
    )
    draw(table, run.results / "fingers.png")


if __name__ == "__main__":
    launch(main)
