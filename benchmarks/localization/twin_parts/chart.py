"""The twin experiment as a picture: every skin a dot, the median a bar, the goal a line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from rcskin.simulator.chart_style import COLOURS

SPREAD = 0.18
LEGEND = (
    "dot: a twin, green: calibrated; bar: median; dashed: goal. "
    "Columns by one interface, the others by two"
)


def draw(table: pd.DataFrame, path: Path) -> None:
    """table: a row for each answer, as `twin.scores` gives them."""
    shares, distances = table[table["unit"] == "right"], table[table["unit"] == "mm"]
    figure = Figure(figsize=(13, 5.6), layout="constrained")
    ratio = [max(1, _groups(shares)), max(1, _groups(distances))]
    left, right = figure.subplots(1, 2, width_ratios=ratio)
    _panel(left, shares.assign(score=100 * shares["score"], goal=100 * shares["goal"]))
    _panel(right, distances)
    left.set_ylabel("Right answers (%)")
    left.set_title(LEGEND, loc="left", size=8)
    right.set_ylabel("Median distance (mm)")
    right.set_ylim(bottom=0)
    figure.suptitle("Trained on simulation, evaluated on other simulated skins", size=11)
    figure.savefig(path, dpi=150)


def _groups(table: pd.DataFrame) -> int:
    return len(table.groupby(["trial", "localizer", "calibrated with"]))


def _panel(axes: Axes, table: pd.DataFrame) -> None:
    names, random = [], np.random.default_rng(0)
    for place, (name, group) in enumerate(
        table.groupby(["trial", "localizer", "calibrated with"], sort=False)
    ):
        trial, localizer, touches = name
        color = COLOURS[0] if touches == 0 else COLOURS[2]
        scatter = place + random.uniform(-SPREAD, SPREAD, len(group))
        axes.plot(scatter, group["score"], "o", ms=4, alpha=0.6, color=color, mew=0)
        axes.hlines(group["score"].median(), place - 0.3, place + 0.3, color="black", lw=2)
        axes.hlines(group["goal"].iloc[0], place - 0.4, place + 0.4, color=COLOURS[1], ls="--")
        calibrated = f", {touches} touches" if touches else ""
        of = trial.replace(", two interfaces", "")
        names.append(f"{of}\n{localizer}{calibrated}")
    axes.set_xticks(range(len(names)), names, rotation=90, ma="right", fontsize=8)
    axes.grid(axis="y", color="0.88")
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
