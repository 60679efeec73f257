"""Answers about foreign twins as a table by effect, and as a chart."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from rcskin.benchmarks.bench import publish
from rcskin.benchmarks.localization.foreign_parts.experiment import Experiment
from rcskin.simulator.chart_style import COLOURS

NARROW = 0.8
"""Share of the height of an effect that its bars take."""


def write_report(experiment: Experiment, answers: pd.DataFrame, folder: Path) -> None:
    """Write the table and the chart."""
    placed, skins = experiment.trial.placed, answers["skin"].nunique()
    found = summary(answers, placed)
    publish(folder, experiment.table, experiment.title.format(skins=skins), table(found, placed))
    draw(found, experiment, folder / f"{experiment.table}.png")


def summary(answers: pd.DataFrame, placed: bool) -> pd.DataFrame:
    """A row for each effect and way, over the skins.

    Shares in %: mean, and from one standard error below it to one above. placed: distances in mm:
    median, smallest and largest.
    """
    groups = answers.groupby(["effect", "way"], sort=False)
    scores = groups["score"]
    if placed:
        found = scores.agg(middle="median", low="min", high="max")
    else:
        middle, error = 100 * scores.mean(), 100 * scores.sem().fillna(0.0)
        found = pd.DataFrame({"middle": middle, "low": middle - error, "high": middle + error})
    return found.assign(answered=100 * groups["answered"].mean()).reset_index()


def table(found: pd.DataFrame, placed: bool) -> pd.DataFrame:
    """A row for each effect, a column for each localizer."""
    cells = [_cell(each, placed) for each in found.itertuples()]
    wide = found.assign(cell=cells).pivot(index="effect", columns="way", values="cell")
    ways, effects = found["way"].unique(), found["effect"].unique()
    return wide.loc[effects, ways].fillna("-").reset_index()


def draw(found: pd.DataFrame, experiment: Experiment, path: Path) -> None:
    """A group of bars for each effect; an infinite distance has no bar."""
    effects, ways = found["effect"].unique(), found["way"].unique()
    figure = Figure(figsize=(8.5, 1.6 + 0.8 * len(effects)), layout="constrained")
    axes, width = figure.subplots(), NARROW / len(ways)
    place, colours = np.arange(len(effects)), [*COLOURS, "0.5"]
    for k, way in enumerate(ways):
        own = found[found["way"] == way].set_index("effect").reindex(effects)
        own = own.replace(np.inf, np.nan)
        at = place + (k - (len(ways) - 1) / 2) * width
        errors = [own["middle"] - own["low"], own["high"] - own["middle"]]
        axes.barh(at, own["middle"], width, xerr=errors, color=colours[k], label=way)
    placed, goal = experiment.trial.placed, experiment.trial.goal
    axes.axvline(goal if placed else 100 * goal, color="0.3", linestyle="--", linewidth=1)
    axes.set_yticks(place, effects)
    axes.invert_yaxis()
    axes.set_xlabel(
        "median distance (mm), from the best skin to the worst\nno bar: half of the touches are "
        "unanswered; dashed: goal"
        if placed
        else "right answers (%); an unanswered touch is not right; dashed: goal"
    )
    axes.spines[["top", "right"]].set_visible(False)
    figure.legend(loc="outside upper center", ncols=4, frameon=False)
    figure.savefig(path, dpi=150)


def _cell(row: Any, placed: bool) -> str:
    if placed:
        return f"{row.middle:.2f} ({row.low:.2f} to {row.high:.2f}) ({row.answered:.0f})"
    return f"{row.middle:.1f} ± {row.high - row.middle:.1f} ({row.answered:.0f})"
