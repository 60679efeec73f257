"""One panel a skin: error of every way against its time."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from rcskin.simulator.chart_style import COLOURS, UNPRESSED_COLOUR, chart, logarithmic_axis

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FLOOR = 1e-14
"""Errors below are rounding, of the reference too."""
WRONG, TOP = 0.1, 50
STALLED = 0.9
"""Of an error that the next step should have lowered."""
MARKERS = "os^Dv*P"


def draw(path: Path, tables: dict[str, pd.DataFrame], ours: tuple[str, ...]) -> None:
    """Write the chart. tables: way, setting, error and seconds by the title of the skin."""
    names = list(dict.fromkeys(name for table in tables.values() for name in table["way"]))
    looks = looks_of([name for name in names if name not in ours], ours)
    with chart(path, 12, 5) as figure:
        panels = figure.subplots(1, len(tables), sharey=True)
        for axes, (title, table) in zip(panels, tables.items(), strict=True):
            for name, rows in table.groupby("way", sort=False):
                curve(axes, str(name), rows, looks[str(name)])
            axes.set_title(title, loc="left")
            logarithmic_axis(axes, "Time to the answer (ms)")
        panels[0].set_ylim(FLOOR / 10, TOP)
        for axes in panels:
            axes.axhspan(WRONG, TOP, color="0.93", zorder=0)
        panels[0].set_ylabel("Largest relative error of Rs and Cp")
        handles = {
            label: handle
            for axes in panels
            for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
        }
        figure.legend([handles[name] for name in names], names, loc="outside lower center", ncols=9)


def looks_of(others: list[str], ours: tuple[str, ...]) -> dict[str, dict]:
    """How each way is drawn."""
    colours = [*COLOURS, "0.45"]
    looks: dict[str, dict] = {
        name: {"color": colour, "marker": marker, "linewidth": 1.1}
        for name, colour, marker in zip(others, colours, MARKERS, strict=False)
    }
    for name, style in zip(ours, ("-", ":", "--"), strict=False):
        looks[name] = {"color": UNPRESSED_COLOUR, "marker": ".", "linestyle": style, "linewidth": 2}
    return looks


def curve(
    axes: Axes,
    name: str,
    rows: pd.DataFrame,
    look: dict,
    wrong: float = WRONG,
    stalls: bool = True,
) -> None:
    """One way, in ms, with what more work does not cure beside it. wrong: an error of no use.
    stalls: whether it is told where errors no longer fall."""
    errors = np.clip(rows["error"].to_numpy(), FLOOR, None)
    times = 1e3 * rows["seconds"].to_numpy()
    axes.loglog(times, errors, label=name, markersize=5, **look)
    failure = _failure(errors, wrong, stalls)
    if failure:
        axes.annotate(
            f"{name} {failure}",
            (times[0], errors[0]),
            xytext=(0, 6),
            textcoords="offset points",
            fontsize=8,
            color=look["color"],
        )


def _failure(errors: NDArray[np.float64], wrong: float, stalls: bool) -> str | None:
    """What more work does not cure, in a word."""
    if errors.min() > wrong:
        return "is wrong"
    stalled = stalls and len(errors) > 1 and errors[-1] > STALLED * errors[-2] > 1e3 * FLOOR
    return "stalls" if stalled else None
