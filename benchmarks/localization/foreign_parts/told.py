"""Answers about foreign twins as a table by effect, and as a chart."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from rcskin.benchmarks.bench import publish
from rcskin.benchmarks.localization.foreign_parts.questions import Question
from rcskin.simulator.chart_style import COLOURS

NARROW = 0.8
"""Of the room of an effect, that its bars take."""


def tell(question: Question, answers: pd.DataFrame, folder: Path) -> None:
    """Write every answer, the table and the chart."""
    found, skins = summary(answers), answers["skin"].nunique()
    title = f"Columns of {skins} skins of a three-dimensional solve told right, % (answered)"
    publish(folder, "foreign_twin", title, table(found))
    draw(found, question, folder / "foreign_twin.png")


def summary(answers: pd.DataFrame) -> pd.DataFrame:
    """Mean over skins in %, and its standard error."""
    by = answers.groupby(["effect", "way"], sort=False)
    scores = 100 * by["score"].agg(mean="mean", error="sem").fillna(0.0)
    return scores.assign(answered=100 * by["answered"].mean()).reset_index()


def table(found: pd.DataFrame) -> pd.DataFrame:
    """A row for each effect, a column for each localizer."""
    numbers = found[["mean", "error", "answered"]].to_numpy()
    cells = [f"{mean:.1f} ± {error:.1f} ({answered:.0f})" for mean, error, answered in numbers]
    wide = found.assign(cell=cells).pivot(index="effect", columns="way", values="cell")
    ways, effects = found["way"].unique(), found["effect"].unique()
    return wide.loc[effects, ways].fillna("-").reset_index()


def draw(found: pd.DataFrame, question: Question, path: Path) -> None:
    """A group of bars for each effect; what is not answered counts as not right."""
    effects, ways = found["effect"].unique(), found["way"].unique()
    figure = Figure(figsize=(8.5, 1.4 + 0.8 * len(effects)), layout="constrained")
    axes, width = figure.subplots(), NARROW / len(ways)
    place, colours = np.arange(len(effects)), [*COLOURS, "0.5"]
    for k, way in enumerate(ways):
        own = found[found["way"] == way].set_index("effect").reindex(effects)
        at = place + (k - (len(ways) - 1) / 2) * width
        axes.barh(at, own["mean"], width, xerr=own["error"], color=colours[k], label=way)
    axes.axvline(100 * question.trial.goal, color="0.3", linestyle="--", linewidth=1)
    axes.set_yticks(place, effects)
    axes.invert_yaxis()
    axes.set_xlabel("right answers (%); what is not answered is not right; dashed: goal")
    axes.spines[["top", "right"]].set_visible(False)
    figure.legend(loc="outside upper center", ncols=4, frameon=False)
    figure.savefig(path, dpi=150)
