"""Three panels: cost against pixels, error against the basis, and ways to one sweep."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd
from rcskin.simulator.chart_style import COLOURS, UNPRESSED_COLOUR, chart

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FULL, REDUCED, PREPARATION, CERTIFICATE = UNPRESSED_COLOUR, COLOURS[0], COLOURS[1], COLOURS[2]
WAYS = (COLOURS[0], UNPRESSED_COLOUR, *COLOURS[1:])
MARKERS = "soDv^P*"


def draw(
    path: Path, pixels: pd.DataFrame, sizes: pd.DataFrame, ways: pd.DataFrame, rtol: float
) -> None:
    """Write the chart. rtol: asked of the models in the first and the last panel."""
    with chart(path, 13, 4.6) as figure:
        panels = figure.subplots(1, 3, width_ratios=(1, 1, 1.15))
        _cost(panels[0], pixels)
        _error(panels[1], sizes)
        _ways(panels[2], ways, rtol)


def _cost(axes: Axes, table: pd.DataFrame) -> None:
    along = table["pixels along a side"]
    for column, scale, label, marker, colour in (
        ("preparation (s)", 1e3, "preparation, once", "D", PREPARATION),
        ("full (µs)", 1e-3, "full model, a further press", "o", FULL),
        ("reduced (µs)", 1e-3, "reduced model, a press", "s", REDUCED),
    ):
        axes.loglog(along, scale * table[column], marker=marker, color=colour, label=label)
    _tell_vectors(axes, table)
    axes.set_ylim(bottom=0.4e-3 * table["reduced (µs)"].min())
    axes.set_xticks(along, [f"{n}" for n in along])
    axes.minorticks_off()
    axes.set_xlabel("Pixels along a side (in blue: vectors in the basis)")
    axes.set_ylabel("Time of a sweep of 20 frequencies (ms)")
    axes.set_title("Cost against pixels, tolerance 1e-5", loc="left")
    axes.legend(loc="upper left")


def _tell_vectors(axes: Axes, table: pd.DataFrame) -> None:
    places = zip(table["pixels along a side"], 1e-3 * table["reduced (µs)"], strict=True)
    for place, vectors in zip(places, table["vectors"], strict=True):
        axes.annotate(
            f"{vectors}",
            place,
            xytext=(0, -12),
            textcoords="offset points",
            ha="center",
            fontsize=8,
            color=REDUCED,
        )


def _error(axes: Axes, table: pd.DataFrame) -> None:
    axes.semilogy(
        table["vectors"], table["certificate"], "^--", color=CERTIFICATE, label="certificate"
    )
    axes.semilogy(table["vectors"], table["error"], "s-", color=REDUCED, label="error")
    axes.set_xlabel("Vectors in the basis")
    axes.set_ylabel("Largest relative error of Rs and Cp left by the basis")
    axes.set_title("Error against basis size, sheet-5x5 trained at 1e-7", loc="left")
    axes.legend(loc="upper right")


def _ways(axes: Axes, table: pd.DataFrame, rtol: float) -> None:
    axes.axhline(rtol, color="0.45", lw=1, ls=":", label=f"{rtol:g} is asked")
    names = table["way"] + ", " + table["setting"]
    places = zip(1e-3 * table["a sweep (µs)"], table["true error"], strict=True)
    for name, place, colour, marker in zip(names, places, WAYS, MARKERS, strict=False):
        axes.loglog(*place, marker, color=colour, markersize=8, label=name)
    axes.margins(x=0.12, y=0.2)
    axes.set_xlabel("Time of a sweep, all being prepared (ms)")
    axes.set_ylabel("Largest relative error of Rs and Cp")
    axes.set_title("Ways to a sweep of sheet-5x5", loc="left")
    axes.legend(loc="upper left")
