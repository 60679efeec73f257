"""Results in notebooks: a table with a small chart, as HTML without scripts for light and dark."""

from __future__ import annotations

import html
import re
from collections.abc import Callable, Sequence
from io import StringIO
from typing import TYPE_CHECKING, Any, NamedTuple

from .chart_style import STYLE
from .safe_text import escaped, figure_style, rendering

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MAX_CHART = 50_000
"""Largest number of characters of a chart."""
MARGINS = {"left": 0.66, "right": 0.1, "bottom": 0.42}
"""Inches around the panels of a chart."""
TOP = 0.28
"""Inches above the panels, for a title or a line of a legend."""
CLOSE_LEGEND = {"borderaxespad": 0.1, "columnspacing": 1.0, "handlelength": 1.2}
"""Settings of a legend in little space."""
SMALL = {
    "font.size": 8,
    "axes.titlesize": 8,
    "legend.fontsize": 7,
    "lines.linewidth": 1.2,
    "svg.fonttype": "none",
    "font.sans-serif": ["DejaVu Sans"],
}
"""Matplotlib settings of small charts; their text stays text."""
GREY = re.compile(r"(fill|stroke): #([0-9a-f]{2})\2\2(?:; \1-opacity: ([0-9.]+))?")
RULES = re.compile(r"<style.*?</style>", re.DOTALL)
NUMBER_OF_PART = re.compile(r' id="[A-Za-z0-9.]+_[0-9]+"')
FRACTION = re.compile(r"(\.[0-9]{2})[0-9]+")
PATH = re.compile(r' d="[^"]*"')
UNNAMED: dict[str, Any] = dict.fromkeys(("Date", "Creator", "Format", "Type"))
"""Metadata that matplotlib leaves out."""
LEFT = 'style="text-align: left; vertical-align: top; padding: 0.1em 0.8em 0.1em 0"'
SIDE_BY_SIDE = "display: flex; flex-wrap: wrap; gap: 1em; align-items: flex-start"
TABLE = "flex: 1 1 22em; max-width: max-content"


class SmallChart(NamedTuple):
    """A chart beside a table: the function that draws it, and its size in inches.

    top: space above the panels.
    """

    draw: Callable[[Figure], None]
    width: float = 3.2
    height: float = 2.2
    top: float = TOP


def side_by_side(left: Callable[[], str], chart: Callable[[], SmallChart | None]) -> str:
    """HTML and a chart beside it, on one line. An error of either becomes a line of text."""
    text, drawn = _or_reason("no table", left), _or_reason("no chart", lambda: _svg(chart()))
    return f'<div style="{SIDE_BY_SIDE}"><div style="{TABLE}">{text}</div>{drawn}</div>'


def _or_reason(what: str, part: Callable[[], str]) -> str:
    try:
        return part()
    except Exception as error:
        reason = f"{what}: {error or type(error).__name__}"
        return f"<div>{html.escape(escaped(reason))}</div>"


def html_table(cells: Sequence[Sequence[str]]) -> str:
    """A table as HTML, on one line. cells: the heads, and the rows below them."""
    header, *rows = cells
    parts = [_html_row("th", header), *(_html_row("td", row) for row in rows)]
    return f"<table>{''.join(parts)}</table>"


def _html_row(tag: str, cells: Sequence[str]) -> str:
    inside = "".join(f"<{tag} {LEFT}>{html.escape(cell)}</{tag}>" for cell in cells)
    return f"<tr>{inside}</tr>"


def _svg(chart: SmallChart | None) -> str:
    """A chart as SVG without its own background; empty text for no chart.

    Its black is the text colour of the page, and its greys are shades of it. Raises ValueError if
    it is larger than MAX_CHART.
    """
    if chart is None:
        return ""
    drawn = _as_part_of_page(_drawn(chart))
    if len(drawn) > MAX_CHART:
        raise ValueError("it has too many lines for a notebook")
    return drawn


def _drawn(chart: SmallChart) -> str:
    """A chart as an SVG file of matplotlib.

    Ticks between the labelled ones take most of the time to draw, so they are left out. The style
    of a notebook's own figures has no effect.
    """
    from matplotlib import style
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure
    from matplotlib.ticker import NullLocator

    written = StringIO()
    with style.context("default"), figure_style({**STYLE, **SMALL}):
        figure = Figure(figsize=(chart.width, chart.height))
        FigureCanvasSVG(figure)
        figure.subplots_adjust(**_margins(chart))
        chart.draw(figure)
        for axis in (axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)):
            axis.set_minor_locator(NullLocator())
        with rendering(figure):
            figure.savefig(written, format="svg", transparent=True, metadata=UNNAMED)
    return written.getvalue()


def _margins(chart: SmallChart) -> dict[str, float]:
    wide, high = 1 / chart.width, 1 / chart.height
    return {
        "left": MARGINS["left"] * wide,
        "right": 1 - MARGINS["right"] * wide,
        "bottom": MARGINS["bottom"] * high,
        "top": 1 - chart.top * high,
        "wspace": 0.5,
    }


def _as_part_of_page(file: str) -> str:
    """An SVG file as an element of a page: no rules for the page, no names, on one line."""
    svg = NUMBER_OF_PART.sub("", RULES.sub("", file[file.index("<svg") :]))
    svg = PATH.sub(lambda path: FRACTION.sub(r"\1", path[0]), svg)
    svg = GREY.sub(_shade, svg).replace("font-family: 'DejaVu Sans', sans-serif; ", "")
    looks = (
        'role="img" fill="currentColor" stroke-linejoin="round" stroke-linecap="butt" '
        'font-family="sans-serif" style="max-width: 100%; height: auto"'
    )
    return " ".join(f"<svg {looks} {svg[5:]}".split())


def _shade(grey: re.Match[str]) -> str:
    """A grey as the text colour at some opacity."""
    kind, level, opacity = grey.groups()
    ink = (1 - int(level, 16) / 255) * float(opacity or 1)
    return f"{kind}: currentColor" + (f"; {kind}-opacity: {ink:.3g}" if ink < 1 else "")
