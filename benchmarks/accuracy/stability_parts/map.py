"""Heat maps of errors: ways down, what is varied across, one row of maps for Rs and one for Cp."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from rcskin.simulator.chart_style import chart

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.image import AxesImage

FAILED, REFUSED = np.inf, -np.inf
"""In place of an error: an answer that is no number, and none where none was promised."""
BEST, WORST = -12, 0
OURS = "rcskin"
NO_ANSWER = "0.88"


def draw(path: Path, ways: list[str], maps: dict[str, pd.DataFrame], wrong: float) -> None:
    """Write the chart. maps: way, value, Rs, Cp by the label of what is varied.

    Errors from `wrong` on are hatched, FAILED as the worst; NaN is left grey, REFUSED dotted.
    """
    columns = [len(np.unique(rows["value"])) for rows in maps.values()]
    with chart(path, 11, 7.2) as figure:
        panels = figure.subplots(2, len(maps), sharey=True, width_ratios=[8 + n for n in columns])
        for name, row in zip(("Rs", "Cp"), panels, strict=True):
            for axes, (label, rows) in zip(row, maps.items(), strict=True):
                errors = rows.pivot(index="way", columns="value", values=name).loc[ways]
                image = _heat_map(axes, errors, wrong)
                axes.set_xlabel(label)
            row[0].set_title(f"Error of {name}", loc="left", fontweight="bold")
            row[0].set_yticks(range(len(ways)), ways)
            for label in row[0].get_yticklabels():
                label.set_fontweight("bold" if label.get_text().startswith(OURS) else "normal")
        bar = figure.colorbar(image, ax=panels, shrink=0.5, aspect=30)
        bar.set_label("log10 of the relative error")
        figure.suptitle(
            f"Hatched: wrong by more than {wrong:.0%}, or no number.   Dotted: refused to answer."
            "   Grey: for lines only.",
            fontsize=9,
        )


def _heat_map(axes: Axes, errors: pd.DataFrame, wrong: float) -> AxesImage:
    values = errors.to_numpy()
    with np.errstate(divide="ignore", invalid="ignore"):
        exponents = np.where(values == REFUSED, np.nan, np.log10(values))
    image = axes.imshow(
        np.clip(exponents, BEST, WORST), cmap="YlOrRd", vmin=BEST, vmax=WORST, aspect="auto"
    )
    axes.set_facecolor(NO_ANSWER)
    axes.grid(False)
    axes.set_yticks(np.arange(len(errors)))
    for hatch, where in (("////", values >= wrong), ("....", values == REFUSED)):
        for row, column in np.argwhere(where):
            sides = [column - 0.5, column + 0.5]
            axes.fill_between(sides, row - 0.5, row + 0.5, hatch=hatch, fc="none", lw=0)
    for line in np.arange(len(errors) - 1) + 0.5:
        axes.axhline(line, color="white", lw=0.8)
    _value_ticks(axes, errors.columns.to_numpy(dtype=float))
    return image


def _value_ticks(axes: Axes, values: np.ndarray) -> None:
    """Every second value is listed, or of powers of ten every third."""
    exponents = np.log10(values)
    if values.max() / values.min() > 1e4:
        shown = np.flatnonzero(np.isclose(exponents % 3, 0))
        labels = [f"1e{exponent:.0f}" for exponent in exponents[shown]]
    else:
        shown = np.arange(0, len(values), 2)
        labels = [f"{value:g}" for value in values[shown]]
    axes.set_xticks(shown, labels)
