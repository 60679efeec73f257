"""Rates as bars with their intervals, for a small chart beside a table."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..chart_style import COLOURS
from ..notebook_display import MARGINS, TOP, SmallChart

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BAR, WIDTH, NAMES = 0.26, 3.4, 1.2
"""Inches: height of a bar with its space, width of the chart, and space for names on the left."""


class Rate(NamedTuple):
    """A rate and its interval, each from 0 to 1."""

    name: str
    value: float
    low: float
    high: float


def rate_bars(rates: Sequence[Rate], guess: float | None = None) -> SmallChart:
    """Chart of rates in percent. guess: accuracy of a guess, a dashed line."""
    height = MARGINS["bottom"] + TOP + BAR * len(rates)
    return SmallChart(lambda figure: _draw(figure, rates, guess), WIDTH, height)


def _draw(figure: Figure, rates: Sequence[Rate], guess: float | None) -> None:
    figure.subplots_adjust(left=NAMES / WIDTH)
    axes, at = figure.subplots(), np.arange(len(rates))
    value, low, high = 100 * np.array([each[1:] for each in rates]).T
    off = np.maximum([value - low, high - value], 0)
    axes.barh(at, value, xerr=off, height=0.7, color=COLOURS[5], ecolor="0.3", capsize=2)
    axes.set_yticks(at, [each.name for each in rates])
    axes.set_ylim(len(rates) - 0.5, -0.5)
    axes.set_xlim(0, 100)
    axes.grid(False, axis="y")
    axes.set_xlabel("% of sweeps, with 95 % interval")
    if guess is not None:
        line = axes.axvline(100 * guess, color=COLOURS[1], linestyle="--")
        figure.legend([line], ["guess without a sweep"], loc="upper right", borderaxespad=0.1)
