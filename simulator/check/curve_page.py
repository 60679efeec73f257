"""Plots of sweeps as a single offline HTML page with zoom, drawn by plotly."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..chart_style import checked_chart
from ..safe_text import plotly_text
from ..sweeps import checked_output, require_packages, whole_file
from .sweep_curves import (
    QUANTITIES,
    CurveQuantity,
    colours_of,
    curves_of,
    draw_curves,
    labels_of,
    panels_of,
    rows_of,
)

if TYPE_CHECKING:
    import plotly.graph_objects as go
    import xarray as xr

ENDING = ".html"
DASHES = ("solid", "dash", "dot", "dashdot", "longdashdot")
"""Line styles of the recordings on the page, one after the other."""
PANEL_HEIGHT = 380


def checked_page(path: Path) -> Path:
    """Returns the path if a page can be written there; raises InputError without plotly."""
    require_packages(path, "view", "plotly")
    return checked_output(path, (ENDING,))


def checked_drawing(path: str | Path) -> Path:
    """Returns the path if a picture or a page can be written there. Raises InputError."""
    path = Path(path)
    return checked_page(path) if path.suffix == ENDING else checked_chart(path, ENDING)


def draw(
    recordings: Sequence[xr.Dataset],
    path: str | Path,
    what: Sequence[str] = (),
    names: Sequence[str] = (),
) -> Path:
    """Plots sweeps as a page if the path ends in .html, else as a picture; returns the path.

    Arguments and errors as in `draw_curves`.
    """
    path = checked_drawing(path)
    if path.suffix != ENDING:
        return draw_curves(recordings, path, what, names)
    write_page(recordings, path, what, names)
    return path


def write_page(
    recordings: Sequence[xr.Dataset],
    path: Path,
    what: Sequence[str] = (),
    names: Sequence[str] = (),
) -> None:
    """Writes the panels of `draw_curves` as a self-contained page.

    A click on a press or a recording hides it. Raises InputError as `draw_curves`.
    """
    from plotly.subplots import make_subplots

    panels, across = panels_of(recordings, what)
    down = -(-len(panels) // across)
    titles = [plotly_text(f"{shown.name}, {interface}") for shown, interface in panels]
    figure = make_subplots(rows=down, cols=across, subplot_titles=titles)
    for number, (shown, interface) in enumerate(panels):
        row, column = number // across + 1, number % across + 1
        for trace in _traces(recordings, interface, shown, names):
            figure.add_trace(trace.update(showlegend=number == 0), row, column)
        _dress(figure, shown, row, column)
    figure.update_layout(template="plotly_white", height=PANEL_HEIGHT * down, hovermode="closest")
    with whole_file(path) as unfinished:
        figure.write_html(unfinished, include_plotlyjs=True, div_id="curves")


def _traces(
    recordings: Sequence[xr.Dataset], interface: str, shown: CurveQuantity, names: Sequence[str]
) -> list[go.Scatter]:
    """A trace for each label of each recording; its curves are separated by gaps."""
    import plotly.graph_objects as go

    labels = labels_of(recordings)
    rows = rows_of(recordings, labels)
    colours = colours_of(labels.values())
    traces = []
    for number, sweeps in enumerate(recordings):
        drawn = list(curves_of(sweeps, interface, shown))
        kinds = [(labels[press], rows.get(press, 0)) for press, _, _ in drawn]
        for label, line in dict.fromkeys(kinds):
            own = [each for each, kind in zip(drawn, kinds, strict=True) if kind == (label, line)]
            text = f"{label}, row {line}" if line else label
            name = plotly_text(f"{text}, {names[number]}" if names else text)
            traces.append(
                go.Scatter(
                    x=[each for _, x, _ in own for each in (*x.tolist(), None)],
                    y=[each for _, _, y in own for each in (*y.tolist(), None)],
                    text=[plotly_text(press) for press, x, _ in own for _ in range(len(x) + 1)],
                    name=name,
                    legendgroup=name,
                    mode="lines+markers",
                    marker={"size": 3},
                    line={
                        "color": colours[label],
                        "dash": DASHES[max(number, line - 1) % len(DASHES)],
                        "width": 1.4,
                    },
                )
            )
    return traces


def _dress(figure: go.Figure, shown: CurveQuantity, row: int, column: int) -> None:
    x = {"type": "log", "title": "Frequency (kHz)"}
    y = {"title": f"{shown.name} ({shown.unit})"}
    if shown.unit in ("ohm", "F"):
        y |= {"exponentformat": "SI"}
    if shown is QUANTITIES["nyquist"]:
        x, y = {"title": "Rs (ohm)", "exponentformat": "SI"}, y | {"type": "log"}
    figure.update_xaxes(x, row=row, col=column)
    figure.update_yaxes(y, row=row, col=column)
