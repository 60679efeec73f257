"""Sweeps as curves: Rs, Cp and their changes from rest, phase, and the Nyquist plot."""

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
from ..sweeps import UNPRESSED, InputError
from ..sweeps.schema import read_at

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D
    from numpy.typing import NDArray

WIDTH = 1.4
"""Of lines of the first rows, points."""
FEW = 40
"""Sweeps whose curves are drawn opaque."""
MAX_DRAWN = 400
"""Sweeps of a recording that are drawn; of more, so many evenly spread."""
MAX_NAMED = len(COLOURS)
"""Presses with a colour and a name of their own; more are coloured by their column."""


class CurveQuantity(NamedTuple):
    """A quantity of a sweep: its name, its unit, and how it follows from Z and the frequency."""

    name: str
    unit: str
    of: Callable[[NDArray[np.complex128], NDArray[np.float64]], NDArray[np.float64]]
    change: bool = False


def _capacitance(Z: NDArray[np.complex128], frequency: NDArray[np.float64]) -> NDArray[np.float64]:
    return (1 / Z).imag / (2 * np.pi * frequency)


QUANTITIES = {
    "Rs": CurveQuantity("Rs", "ohm", lambda Z, f: Z.real),
    "Cp": CurveQuantity("Cp", "F", _capacitance),
    "change-Rs": CurveQuantity("change of Rs", "%", lambda Z, f: Z.real, change=True),
    "change-Cp": CurveQuantity("change of Cp", "%", _capacitance, change=True),
    "phase": CurveQuantity("phase", "°", lambda Z, f: np.degrees(np.angle(Z))),
    "nyquist": CurveQuantity("-X", "ohm", lambda Z, f: -Z.imag),
}
Quantity = Literal["Rs", "Cp", "change-Rs", "change-Cp", "phase", "nyquist"]
"""Of QUANTITIES."""
DEFAULT = ("Rs", "Cp", "change-Rs", "change-Cp")


def checked_quantities(names: Sequence[str]) -> tuple[str, ...]:
    """The same names; raises InputError for one that is no quantity."""
    for name in names:
        if name not in QUANTITIES:
            raise InputError(f"--what must be of {', '.join(QUANTITIES)}, got {name!r}")
    return tuple(names) or DEFAULT


def draw_curves(
    recordings: Sequence[xr.Dataset],
    path: str | Path,
    what: Sequence[str] = (),
    names: Sequence[str] = (),
) -> Path:
    """A picture of sweeps; a panel for each quantity, at each interface of the first.

    recordings: drawn over each other, each in a line style of its own. what: of QUANTITIES, by
    default those that can be had; changes are from the mean of the sweeps at rest of the same
    session. names: of the recordings. path: .png, .svg or .pdf; given back. Raises InputError for
    another ending, an absent folder or another quantity, and for changes without rest.
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
            for number, sweeps in enumerate(recordings):
                alpha = 1.0 if sweeps.sizes["sweep"] <= FEW else 0.5
                for press, x, y in curves_of(sweeps, interface, shown):
                    look = _look(rows.get(press, number + 1))
                    axes.plot(x, y, color=of_press[press], alpha=alpha, **look)
            _dress(axes, shown, interface if several else "")
        for axes in each[len(panels) :]:
            axes.remove()
        told = names or [f"row {row}" for row in range(1, max(rows.values(), default=0) + 1)]
        figure.legend(*_legend(colours, labels.values(), told), loc="outside right upper")
    return path


def panels_of(
    recordings: Sequence[xr.Dataset], what: Sequence[str]
) -> tuple[list[tuple[CurveQuantity, str]], int]:
    """Quantity and interface of each panel, and how many stand side by side."""
    chosen = checked_quantities(what)
    if not what and not all(_has_rest(each) for each in recordings):
        chosen = tuple(name for name in chosen if not QUANTITIES[name].change)
    interfaces = [str(name) for name in recordings[0]["interface"].values]
    panels = [(QUANTITIES[name], interface) for interface in interfaces for name in chosen]
    return panels, min(len(chosen), 2) if len(interfaces) == 1 else len(chosen)


def curves_of(
    sweeps: xr.Dataset, interface: str, shown: CurveQuantity
) -> Iterator[tuple[str, NDArray[np.float64], NDArray[np.float64]]]:
    """Press, x and y of each curve: x in kHz, or ohm in Nyquist's plot; at most MOST_DRAWN."""
    if interface not in sweeps["interface"].values:
        return
    own = read_at(sweeps, interface).isel(interface=0)
    f = own["frequency"].values.astype(np.float64)
    Z = own["Rs"].values.astype(np.float64) + 1j * own["X"].values
    values = shown.of(Z, f)
    if shown.change:
        values = 100 * (values / _at_rest(values, own) - 1)
    x = Z.real if shown is QUANTITIES["nyquist"] else np.broadcast_to(f / 1e3, Z.shape)
    presses = own["press"].values.astype(str)
    drawn = min(len(Z), MAX_DRAWN)
    for k in np.linspace(0, len(Z) - 1, drawn).round().astype(int):
        yield str(presses[k]), x[k], values[k]


def _at_rest(values: NDArray[np.float64], sweeps: xr.Dataset) -> NDArray[np.float64]:
    """Mean at rest of each sweep's session, of the shape of values."""
    sessions, resting = sweeps["session"].values, sweeps["press"].values == UNPRESSED
    rest = np.full(values.shape, np.nan)
    for session in np.unique(sessions):
        own = sessions == session
        if not (own & resting).any():
            raise InputError(f"session {session} has no sweep at rest, which changes are from")
        rest[own] = values[own & resting].mean(axis=0)
    return rest


def _has_rest(sweeps: xr.Dataset) -> bool:
    resting = sweeps["press"].values == UNPRESSED
    sessions = sweeps["session"].values
    return set(sessions[resting]) == set(sessions) and not resting.all()


def labels_of(recordings: Sequence[xr.Dataset]) -> dict[str, str]:
    """What each press is told by: itself or, where presses are many, the column it is in.

    A pixel that is pressed with one strength alone is told without it: `2,3` and `2,3:2.0` are one.
    """
    columns: dict[str, int] = {}
    for each in recordings:
        texts, numbers = each["press"].values.astype(str), each["column"].values
        columns |= dict(zip(texts.tolist(), numbers.tolist(), strict=True))
    resting = {UNPRESSED: "at rest"} if columns.pop(UNPRESSED, None) is not None else {}
    strengths: dict[str, set[str]] = {}
    for pixel, _, strength in (press.partition(":") for press in columns):
        strengths.setdefault(pixel, set()).update({strength} - {""})
    names = {
        press: press.partition(":")[0]
        if columns[press] > 0 and len(strengths[press.partition(":")[0]]) < 2
        else press
        for press in columns
    }
    if len(set(names.values())) <= MAX_NAMED:
        return resting | names
    ordered = sorted(columns, key=lambda press: (columns[press] < 1, columns[press]))
    return resting | {
        press: f"column {columns[press]}" if columns[press] > 0 else "elsewhere"
        for press in ordered
    }


def rows_of(recordings: Sequence[xr.Dataset], labels: Mapping[str, str]) -> dict[str, int]:
    """The row of each press that only its column names, so that lines of a column differ.

    Empty for several recordings, whose lines differ by recording, and for a single row.
    """
    if len(recordings) > 1:
        return {}
    presses, rows = recordings[0]["press"].values.astype(str), recordings[0]["row"].values
    found = dict(zip(presses.tolist(), rows.tolist(), strict=True))
    found = {press: row for press, row in found.items() if labels[press].startswith("column ")}
    return found if len(set(found.values())) > 1 else {}


def colours_of(labels: Iterable[str]) -> dict[str, str]:
    """A colour for each label, at rest apart."""
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    told = [label for label in dict.fromkeys(labels) if label != "at rest"]
    if len(told) <= len(COLOURS):
        shades = list(COLOURS[: len(told)])
    else:
        shades = [to_hex(each) for each in colormaps["viridis"](np.linspace(0, 0.95, len(told)))]
    return {"at rest": UNPRESSED_COLOUR} | dict(zip(told, shades, strict=True))


def _dress(axes: Axes, shown: CurveQuantity, title: str) -> None:
    from matplotlib.ticker import MaxNLocator, NullFormatter

    axes.set_title(title)
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


def _legend(
    colours: dict[str, str], labels: Iterable[str], names: Sequence[str]
) -> tuple[list[Line2D], list[str]]:
    from matplotlib.lines import Line2D

    told = list(dict.fromkeys(labels))
    handles = [Line2D([], [], color=colours[label]) for label in told]
    styles = [Line2D([], [], color="0.4", **_look(k)) for k in range(1, len(names) + 1)]
    return handles + styles, [*told, *names]


def _look(number: int) -> dict[str, Any]:
    """Style of the lines of a row, or of a recording, counted from 1; beyond the styles thinner."""
    thinner, style = divmod(number - 1, len(LINE_STYLES))
    return {"linestyle": LINE_STYLES[style], "linewidth": WIDTH / (1 + thinner)}
