"""Plots of sweeps: Rs, Cp, gains, their changes from the baseline, phase, and Nyquist plot."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from ..chart_style import (
    COLOURS,
    LINE_STYLES,
    UNPRESSED_COLOUR,
    chart,
    checked_chart,
    frequency_axis,
    unit_axis,
)
from ..safe_text import plotly_text
from ..sweeps import UNPRESSED, InputError, checked_output, require_packages, whole_file
from ..sweeps.errors import named
from ..sweeps.press_text import displayed_press
from ..sweeps.reading_quantities import GAIN, IMPEDANCE, MAGNITUDE, kind_of
from ..sweeps.reading_subset import read_at
from ..sweeps.schema import complex_readings

if TYPE_CHECKING:
    import plotly.graph_objects as go
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

    from ..arrays import Complex, Real

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
        _dressed_page(figure, shown, row, column)
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


def _dressed_page(figure: go.Figure, shown: CurveQuantity, row: int, column: int) -> None:
    x = {"type": "log", "title": "Frequency (kHz)"}
    y = {"title": f"{shown.name} ({shown.unit})"}
    if shown.unit in ("ohm", "F"):
        y |= {"exponentformat": "SI"}
    if shown is QUANTITIES["nyquist"]:
        x, y = {"title": "Rs (ohm)", "exponentformat": "SI"}, y | {"type": "log"}
    figure.update_xaxes(x, row=row, col=column)
    figure.update_yaxes(y, row=row, col=column)


WIDTH = 1.4
"""Width of the lines of the first rows, points."""
FEW = 40
"""Largest number of sweeps with opaque curves."""
MAX_DRAWN = 400
"""Largest number of drawn sweeps of a recording, chosen at even intervals."""
MAX_NAMED = len(COLOURS)
"""Largest number of presses with individual colours; more are coloured by column."""


class CurveQuantity(NamedTuple):
    """A quantity of a sweep: name, unit, and function of Z and frequency.

    change: True if the relative change from the baseline is plotted.
    """

    name: str
    unit: str
    of: Callable[[Complex, Real], Real]
    change: bool = False


def _capacitance(Z: Complex, frequency: Real) -> Real:
    return (1 / Z).imag / (2 * np.pi * frequency)


QUANTITIES = {
    "Rs": CurveQuantity("Rs", "ohm", lambda Z, f: Z.real),
    "Cp": CurveQuantity("Cp", "F", _capacitance),
    "change-Rs": CurveQuantity("change of Rs", "%", lambda Z, f: Z.real, change=True),
    "change-Cp": CurveQuantity("change of Cp", "%", _capacitance, change=True),
    "phase": CurveQuantity("phase", "°", lambda Z, f: np.degrees(np.angle(Z))),
    "nyquist": CurveQuantity("-X", "ohm", lambda Z, f: -Z.imag),
    "gain": CurveQuantity("|V / V_s|", "V/V", lambda G, f: np.abs(G)),
    "change-gain": CurveQuantity("change of |V / V_s|", "%", lambda G, f: np.abs(G), change=True),
}
Quantity = Literal["Rs", "Cp", "change-Rs", "change-Cp", "phase", "nyquist", "gain", "change-gain"]
"""A key of QUANTITIES."""
DEFAULTS = {
    IMPEDANCE.name: ("Rs", "Cp", "change-Rs", "change-Cp"),
    GAIN.name: ("gain", "phase", "change-gain"),
    MAGNITUDE.name: ("gain", "change-gain"),
}
"""Quantities that are drawn by default, by kind of the readings."""
CHOICES = {**DEFAULTS, IMPEDANCE.name: (*DEFAULTS[IMPEDANCE.name], "phase", "nyquist")}
"""Quantities that can be drawn."""


def checked_quantities(names: Sequence[str]) -> None:
    """Raises InputError for a name that is no quantity."""
    for name in names:
        if name not in QUANTITIES:
            raise InputError(f"{named('what')} must be of {', '.join(QUANTITIES)}, got {name!r}")


def _chosen(recordings: Sequence[xr.Dataset], what: Sequence[str]) -> tuple[str, ...]:
    """The quantities to draw; raises InputError if the readings are of another kind."""
    checked_quantities(what)
    kinds = list(dict.fromkeys(kind_of(each.variables).name for each in recordings))
    if len(kinds) > 1:
        raise InputError(f"recordings of {kinds[0]} and of {kinds[1]} cannot share a chart")
    for name in what:
        if name not in CHOICES[kinds[0]]:
            allowed = ", ".join(CHOICES[kinds[0]])
            raise InputError(f"{named('what')} of {kinds[0]} must be of {allowed}, got {name!r}")
    return tuple(what) or DEFAULTS[kinds[0]]


def draw_curves(
    recordings: Sequence[xr.Dataset],
    path: str | Path,
    what: Sequence[str] = (),
    names: Sequence[str] = (),
) -> Path:
    """Plots sweeps: a panel for each quantity at each interface of the first recording.

    recordings: drawn in the same panels, each with its own line style. what: keys of QUANTITIES; by
    default those available; changes refer to the mean baseline sweep of the same session. names: of
    the recordings. path: .png, .svg or .pdf; returned. Raises InputError for another ending, a
    missing folder, an unknown quantity, and for changes without a baseline sweep.
    """
    path = checked_chart(path)
    panels, across = panels_of(recordings, what)
    labels = labels_of(recordings)
    colours = colours_of(labels.values())
    of_press = {press: colours[label] for press, label in labels.items()}
    rows = rows_of(recordings, labels)
    several = len({interface for _, interface in panels}) > 1
    down = -(-len(panels) // across)
    with chart(path, 1.6 + 3.3 * across, 0.6 + 2.5 * down) as figure:
        each = figure.subplots(down, across, squeeze=False).ravel()
        for axes, (shown, interface) in zip(each, panels, strict=False):
            draw_panel(axes, recordings, shown, interface, of_press, rows)
            axes.set_title(interface if several else "")
        for axes in each[len(panels) :]:
            axes.remove()
        line_names = names or [f"row {row}" for row in range(1, max(rows.values(), default=0) + 1)]
        figure.legend(
            *legend_entries(colours, labels.values(), line_names), loc="outside right upper"
        )
    return path


def draw_panel(
    axes: Axes,
    recordings: Sequence[xr.Dataset],
    shown: CurveQuantity,
    interface: str,
    colours: Mapping[str, str],
    rows: Mapping[str, int],
) -> None:
    """Draws a quantity of all sweeps at an interface. colours: by press. rows: see `rows_of`."""
    for number, sweeps in enumerate(recordings):
        alpha = 1.0 if sweeps.sizes["sweep"] <= FEW else 0.5
        for press, x, y in curves_of(sweeps, interface, shown):
            look = _look(rows.get(press, number + 1))
            axes.plot(x, y, color=colours[press], alpha=alpha, **look)
    _dress(axes, shown)


def panels_of(
    recordings: Sequence[xr.Dataset], what: Sequence[str]
) -> tuple[list[tuple[CurveQuantity, str]], int]:
    """Quantity and interface of each panel, and the number of panels per row."""
    chosen = _chosen(recordings, what)
    if not what and not all(_has_baseline(each) for each in recordings):
        chosen = tuple(name for name in chosen if not QUANTITIES[name].change)
    interfaces = [str(name) for name in recordings[0]["interface"].values]
    panels = [(QUANTITIES[name], interface) for interface in interfaces for name in chosen]
    return panels, min(len(chosen), 2) if len(interfaces) == 1 else len(chosen)


def curves_of(
    sweeps: xr.Dataset, interface: str, shown: CurveQuantity
) -> Iterator[tuple[str, Real, Real]]:
    """Press, x and y of each curve: x in kHz, or ohm in Nyquist's plot; at most MAX_DRAWN."""
    if interface not in sweeps["interface"].values:
        return
    own = read_at(sweeps, interface)
    f = own["frequency"].values.astype(np.float64)
    Z = complex_readings(own)[:, 0]
    values = shown.of(Z, f)
    if shown.change:
        values = 100 * (values / _baseline(values, own) - 1)
    x = Z.real if shown is QUANTITIES["nyquist"] else np.broadcast_to(f / 1e3, Z.shape)
    presses = own["press"].values.astype(str)
    drawn = min(len(Z), MAX_DRAWN)
    for k in np.linspace(0, len(Z) - 1, drawn).round().astype(int):
        yield str(presses[k]), x[k], values[k]


def _baseline(values: Real, sweeps: xr.Dataset) -> Real:
    """Mean baseline of each sweep's session, in the shape of `values`."""
    sessions, unpressed = sweeps["session"].values, sweeps["press"].values == UNPRESSED
    baseline = np.full(values.shape, np.nan)
    for session in np.unique(sessions):
        own = sessions == session
        if not (own & unpressed).any():
            raise InputError(
                f"session {session} has no baseline sweep (press `none`), which changes need"
            )
        baseline[own] = values[own & unpressed].mean(axis=0)
    return baseline


def _has_baseline(sweeps: xr.Dataset) -> bool:
    unpressed = sweeps["press"].values == UNPRESSED
    sessions = sweeps["session"].values
    return set(sessions[unpressed]) == set(sessions) and not unpressed.all()


def labels_of(recordings: Sequence[xr.Dataset]) -> dict[str, str]:
    """Label of each press: the press itself or, if there are many, its column.

    A pixel's strength is omitted if it has one only, and all such pixels and other presses have the
    same: `2,3` and `2,3:2.0` have the same label.
    """
    columns: dict[str, int] = {}
    for each in recordings:
        texts, numbers = each["press"].values.astype(str), each["column"].values
        columns |= dict(zip(texts.tolist(), numbers.tolist(), strict=True))
    unpressed = {UNPRESSED: "unpressed"} if columns.pop(UNPRESSED, None) is not None else {}
    strengths: dict[str, set[str]] = {}
    for place, _, strength in (press.partition(":") for press in columns):
        strengths.setdefault(place, set()).update({strength} - {""})
    equal = len(set().union(*(each for each in strengths.values() if len(each) < 2))) < 2
    names = {}
    for press, column in columns.items():
        place = press.partition(":")[0]
        omitted = equal and column > 0 and len(strengths[place]) < 2
        names[press] = place if omitted else displayed_press(press)
    if len(set(names.values())) <= MAX_NAMED:
        return unpressed | names
    ordered = sorted(columns, key=lambda press: (columns[press] < 1, columns[press]))
    return unpressed | {
        press: f"column {columns[press]}" if columns[press] > 0 else "elsewhere"
        for press in ordered
    }


def rows_of(recordings: Sequence[xr.Dataset], labels: Mapping[str, str]) -> dict[str, int]:
    """Rows of presses that are labelled by column only, so that their line styles differ.

    Empty for several recordings, whose line styles differ by recording, and for a single row.
    """
    if len(recordings) > 1:
        return {}
    presses, rows = recordings[0]["press"].values.astype(str), recordings[0]["row"].values
    found = dict(zip(presses.tolist(), rows.tolist(), strict=True))
    found = {press: row for press, row in found.items() if labels[press].startswith("column ")}
    return found if len(set(found.values())) > 1 else {}


def colours_of(labels: Iterable[str]) -> dict[str, str]:
    """A colour for each label, with a special one for the baseline."""
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    pressed = [label for label in dict.fromkeys(labels) if label != "unpressed"]
    if len(pressed) <= len(COLOURS):
        shades = list(COLOURS[: len(pressed)])
    else:
        shades = [to_hex(each) for each in colormaps["viridis"](np.linspace(0, 0.95, len(pressed)))]
    return {"unpressed": UNPRESSED_COLOUR} | dict(zip(pressed, shades, strict=True))


def _dress(axes: Axes, shown: CurveQuantity) -> None:
    from matplotlib.ticker import MaxNLocator, NullFormatter

    if shown is QUANTITIES["nyquist"]:
        axes.set_yscale("log", nonpositive="mask")
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.xaxis.set_major_locator(MaxNLocator(4))
        unit_axis(axes.xaxis, "Rs", "ohm")
    else:
        frequency_axis(axes)
    if shown.unit in ("ohm", "F"):
        unit_axis(axes.yaxis, shown.name, shown.unit)
    else:
        axes.set_ylabel(f"{shown.name} ({shown.unit})")


def legend_entries(
    colours: Mapping[str, str], labels: Iterable[str], names: Sequence[str] = ()
) -> tuple[list[Line2D], list[str]]:
    """Lines and texts of a legend: each label once, then the names of line styles."""
    from matplotlib.lines import Line2D

    distinct = list(dict.fromkeys(labels))
    handles = [Line2D([], [], color=colours[label]) for label in distinct]
    styles = [Line2D([], [], color="0.4", **_look(k)) for k in range(1, len(names) + 1)]
    return handles + styles, [*distinct, *names]


def _look(number: int) -> dict[str, Any]:
    """Line style of row or recording number `number` (from 1); thinner beyond the styles."""
    thinner, style = divmod(number - 1, len(LINE_STYLES))
    return {"linestyle": LINE_STYLES[style], "linewidth": WIDTH / (1 + thinner)}
