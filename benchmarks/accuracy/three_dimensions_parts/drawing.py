"""When which term matters: what each leaves, over what the skin is and what is near."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd
from rcskin.simulator.chart_style import COLOURS, UNPRESSED_COLOUR, chart

from .terms import over

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PANELS = (
    ("foam (mm)", "Thickness of the foam (mm)"),
    ("permittivity", "Relative permittivity of the foam"),
    ("pixel (mm)", "Pixel, and press, along a side (mm)"),
    ("body (mm)", "Distance of an earthed body (mm)"),
)
ROWS = (
    ("Left of Rs or Cp, unpressed (%)", ("Rs (%)", "Cp (%)"), (0.5, 1.0)),
    ("Change by a press off by (σ)", ("change near (σ)", "change far (σ)"), (0.1, 1.0)),
)
COLOURS_OF_TERMS = (UNPRESSED_COLOUR, *COLOURS)
MARKERS = "osD^v"


def draw(path: Path, table: pd.DataFrame) -> None:
    """Write the chart, of skins with an earthed body below."""
    with chart(path, 15, 7.4) as figure:
        panels = figure.subplots(2, len(PANELS), sharey="row")
        for row, (label, columns, goals) in zip(panels, ROWS, strict=True):
            row[0].set_ylabel(label)
            for axes, (varied, along) in zip(row, PANELS, strict=True):
                _lines(axes, over(table, varied), list(columns))
                for goal, style in zip(goals, (":", "--"), strict=True):
                    axes.axhline(goal, color="0.6", lw=0.9, ls=style)
                axes.set_xlabel(along)
        lines = panels[0][0].get_legend_handles_labels()
        figure.legend(*lines, loc="outside lower center", ncols=len(lines[0]))
        figure.suptitle(
            "The paper's sheet over an earthed body (5 mm below, but for the last panels): "
            "what two dimensions leave of three. Grey: 0.5 and 1 %, 0.1 and 1 σ",
            x=0.01,
            ha="left",
        )


def _lines(axes: Axes, table: pd.DataFrame, columns: list[str]) -> None:
    for (term, own), colour, marker in zip(
        table.groupby("term", sort=False), COLOURS_OF_TERMS, MARKERS, strict=False
    ):
        left = own[columns].max(axis=1)
        axes.loglog(own["value"], left, marker=marker, color=colour, label=term)
    places = sorted(table["value"].unique())
    axes.set_xticks(places, [f"{place:g}" for place in places])
    axes.minorticks_off()
