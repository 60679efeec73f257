"""Sweeps in a notebook: `sweeps.rcskin` shows a table, and the curves of a few presses.

The import adds the attribute `rcskin` to every `xarray.Dataset`, in the documented way of xarray.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import xarray as xr

from ..notebook_display import CLOSE_LEGEND, SmallChart
from ..report.findings import DataTable, Findings, Result
from ..sweeps import UNPRESSED, check
from ..sweeps.reading_quantities import kind_of
from ..sweeps.units import prefixed
from .sweep_curves import DEFAULTS, QUANTITIES, colours_of, draw_panel, labels_of, legend_entries

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

SHOWN = 5
"""Number of presses with curves, besides the unpressed skin."""
PANEL, HEIGHT = 2.5, 1.8
"""Width of a panel, and its height with the labels below, inches."""
LINE = 0.16
"""Height of a line of text, inches."""
LETTERS, SHORT = 12, 6
"""Largest number of letters of a press in the legend, and number of letters of a short one."""
SHORT_COLUMNS, LONG_COLUMNS = 3, 2
"""Columns of the legend for each panel, of short presses and of others."""


@xr.register_dataset_accessor("rcskin")
class SweepsView(Result):
    """Sweeps of a skin for a notebook: their number, origin and frequencies; curves of a few."""

    def __init__(self, sweeps: xr.Dataset) -> None:
        self._sweeps = sweeps

    @property
    def report(self) -> Findings:
        """Number, origin and frequencies; curves of a few presses."""
        sweeps = _few(self._sweeps)
        f = sweeps["frequency"].values
        interfaces = sweeps["interface"].values.astype(str)
        ends = (prefixed(float(each), "Hz") for each in f[[0, -1]])
        frequencies = f"{f.size}, from {' to '.join(ends)}" if f.size > 1 else next(ends)
        kind = kind_of(sweeps.variables)
        rows = [
            ("sweeps", _counts(self._sweeps)),
            ("made by", _origin(sweeps)),
            ("frequencies", frequencies),
            ("interfaces", ", ".join(interfaces)),
            ("readings", f"{kind.name}: {', '.join(kind.names)}"),
        ]
        table = DataTable("sweeps", ("about", "value"), rows)
        return Findings(f"Sweeps of {_scene_name(sweeps)}", [table], small=lambda: _chart(sweeps))


def _chart(sweeps: xr.Dataset) -> SmallChart:
    names = [name for name in DEFAULTS[kind_of(sweeps.variables).name] if "change" not in name]
    legend = _Legend.of(sweeps, len(names))
    title = LINE if sweeps.sizes["interface"] > 1 else 0.0
    top = legend.rows * LINE + title + 0.1
    return SmallChart(
        lambda figure: _draw(figure, sweeps, names, legend),
        PANEL * len(names),
        HEIGHT + top,
        top,
    )


class _Legend(NamedTuple):
    """Labels of presses, their colours, and the number of columns of the legend."""

    labels: Mapping[str, str]
    colours: Mapping[str, str]
    columns: int

    @classmethod
    def of(cls, sweeps: xr.Dataset, panels: int) -> _Legend:
        labels = {press: _brief(label) for press, label in labels_of([sweeps]).items()}
        longest = max((len(each) for each in labels.values() if each != "unpressed"), default=0)
        columns = panels * (SHORT_COLUMNS if longest <= SHORT else LONG_COLUMNS)
        return cls(labels, colours_of(labels.values()), columns)

    @property
    def rows(self) -> int:
        """Number of lines of the legend."""
        return -(-len(set(self.labels.values())) // self.columns)


def _brief(label: str) -> str:
    return label if len(label) <= LETTERS else f"{label[:LETTERS]}…"


def _few(sweeps: xr.Dataset) -> xr.Dataset:
    """The first unpressed sweep and those of a few presses. Raises InputError as `check`."""
    check(sweeps.isel({"sweep": slice(1)}, missing_dims="ignore"))
    return check(sweeps.isel(sweep=_chosen(sweeps)))


def _chosen(sweeps: xr.Dataset) -> NDArray[np.intp]:
    """Numbers of the first unpressed sweep and of a few presses, pixels rather than others."""
    press = sweeps["press"].values.astype(str)
    unpressed, alone = press == UNPRESSED, sweeps["row"].values > 0
    if alone.any():
        places = np.stack([sweeps["row"].values, sweeps["column"].values])
        _, first = np.unique(np.where(alone, places, 0), axis=1, return_index=True)
        first = first[alone[first]]
    else:
        _, first = np.unique(press, return_index=True)
        first = first[~unpressed[first]]
    few = np.linspace(0, first.size - 1, min(SHOWN, first.size)).round().astype(int)
    return np.concatenate([np.flatnonzero(unpressed)[:1], first[few]])


def _counts(sweeps: xr.Dataset) -> str:
    """Number of sweeps, and numbers of those of each kind of press and of sessions."""
    unpressed = int((sweeps["press"].values == UNPRESSED).sum())
    alone = int((sweeps["row"].values > 0).sum())
    total, sessions = sweeps.sizes["sweep"], np.unique(sweeps["session"].values).size
    kinds = (
        (unpressed, "unpressed"),
        (alone, "of one pixel"),
        (total - unpressed - alone, "of other presses"),
    )
    parts = [f"{number} {name}" for number, name in kinds if number]
    if sessions > 1:
        parts.append(f"in {sessions} sessions")
    return f"{total}: {', '.join(parts)}" if parts else str(total)


def _scene_name(sweeps: xr.Dataset) -> str:
    try:
        return str(tomllib.loads(str(sweeps.attrs["scene"]))["name"])
    except (KeyError, tomllib.TOMLDecodeError):
        return "an unknown scene"


def _origin(sweeps: xr.Dataset) -> str:
    """Model or meter of the sweeps, and the tolerance of simulated ones."""
    made = str(sweeps.attrs.get("model", "unknown"))
    return f"{made}, rtol {sweeps.attrs['rtol']:g}" if "rtol" in sweeps.attrs else made


def _draw(figure: Figure, sweeps: xr.Dataset, names: Sequence[str], legend: _Legend) -> None:
    """Draws quantities at the first interface, with a legend above them."""
    interface = str(sweeps["interface"].values[0])
    colours = {press: legend.colours[label] for press, label in legend.labels.items()}
    for axes, name in zip(figure.subplots(1, len(names), squeeze=False)[0], names, strict=True):
        draw_panel(axes, [sweeps], QUANTITIES[name], interface, colours, {})
        if sweeps.sizes["interface"] > 1:
            axes.set_title(f"at {_brief(interface)}")
    lines, texts = legend_entries(legend.colours, legend.labels.values())
    figure.legend(lines, texts, loc="upper center", ncols=legend.columns, **CLOSE_LEGEND)
