"""Report as one HTML page: text, lists, tables and pictures, in one style.

The page stands alone: it contains its pictures and requests nothing from the network.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..chart_style import COLOURS
from ..notebook_display import MARGINS, TOP, SmallChart
from ..safe_text import template_environment
from .files import write_text

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


@dataclass(frozen=True)
class Cell:
    """Text in a table, with small text below it.

    agrees: marks the text as good or bad.
    """

    text: str
    below: str = ""
    agrees: bool | None = None


@dataclass(frozen=True)
class TableGrid:
    """Table: heads of its columns, rows of cells, and which columns hold numbers."""

    heads: Sequence[str]
    rows: Sequence[Sequence[str | Cell]]
    numbers: Sequence[int] = ()


@dataclass(frozen=True)
class Items:
    """List of lines; `about` gives the subject of each, in bold before it, if any."""

    lines: Sequence[str]
    about: Sequence[str] = ()

    @property
    def both(self) -> Sequence[tuple[str, str]]:
        """Pairs of a line's subject, empty if there is none, and the line."""
        return list(zip(self.about or [""] * len(self.lines), self.lines, strict=True))


@dataclass(frozen=True)
class Picture:
    """PNG file and what it shows.

    below: True if the caption also stands below it.
    """

    path: Path
    caption: str
    below: bool = True

    @property
    def name(self) -> str:
        """Name of the file, without its ending."""
        return self.path.stem

    @property
    def base64(self) -> str:
        """Bytes of the file as text."""
        return b64encode(self.path.read_bytes()).decode("ascii")


@dataclass(frozen=True)
class ReportSection:
    """Heading, empty for none, and what stands below it; a text is a paragraph."""

    title: str
    parts: Sequence[str | Items | TableGrid | Picture]


def write_page(path: Path, title: str, sections: Sequence[ReportSection], answer: str = "") -> None:
    """Writes a page, whole or not at all. answer: what stands first, in bold."""
    environment = template_environment(Path(__file__).parent, trim_blocks=True, lstrip_blocks=True)
    environment.tests |= {
        kind.__name__.lower(): lambda part, kind=kind: isinstance(part, kind)
        for kind in (Items, TableGrid, Picture, Cell)
    }
    template = environment.get_template("page.html.jinja")
    write_text(path, template.render(title=title, sections=sections, answer=answer) + "\n")
