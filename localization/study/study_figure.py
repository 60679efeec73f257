"""A study's chart: curves along one axis, maps over two."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from ...simulator.arrays import Real
from ...simulator.chart_style import COLOURS, chart, plain_numbers, unit_axis
from .axis import Axis
from .report import AS_GOOD, as_good, axis_label, best_index, named

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

CONTOURS = {0.7: ":", 0.8: "--", 0.9: "-"}
NOISE = 1.0
CONTOURED = 3
"""Minimum number of values of an axis for contours."""
TITLE_WIDTH = 70


def draw_study(findings: xr.Dataset, axes: Sequence[Axis], title: str, path: Path) -> None:
    """Write the chart: accuracy, separation and, along one axis, the best band.

    An axis of one value is not drawn as an axis: the title names its value.
    """
    varied = [axis for axis in axes if len(axis.values) > 1] or list(axes[:1])
    alone = [axis for axis in axes if axis not in varied]
    if len(varied) > 1:
        return _draw_maps(findings, varied, title, path)
    full_title = "; ".join([title, *(named(axis.key, axis.values[0]) for axis in alone)])
    along = findings.isel({axis.key.name: 0 for axis in alone})
    return _draw_curves(along, varied[0], full_title, path)


def _draw_curves(findings: xr.Dataset, axis: Axis, title: str, path: Path) -> None:
    x = np.array(axis.values, dtype=float)
    with chart(path, 6.5, 7.2) as figure:
        accuracy, separation, band = figure.subplots(3, 1, sharex=True)
        _draw_accuracy(accuracy, x, findings)
        _draw_separation(separation, x, findings)
        _draw_band(band, x, findings)
        _scale(band, "x", axis)
        figure.suptitle("\n".join(textwrap.wrap(title, TITLE_WIDTH)))


def _draw_accuracy(axes: Axes, x: Real, findings: xr.Dataset) -> None:
    accuracy, spread = (100 * findings[name].values for name in ("accuracy", "accuracy_sd"))
    axes.errorbar(x, accuracy, spread, marker="o", markersize=3, capsize=2, color=COLOURS[0])
    axes.set_ylim(0, 103)
    axes.set_ylabel(_right(findings))


def _draw_separation(axes: Axes, x: Real, findings: xr.Dataset) -> None:
    for name, colour, style in (
        ("median_separation", COLOURS[2], "--"),
        ("least_separation", COLOURS[1], "-"),
    ):
        values = findings[name].values
        axes.plot(x, np.where(values > 0, values, np.nan), style, color=colour, label=name[:-11])
    axes.axhline(NOISE, color="0.4", linewidth=0.8)
    axes.set_yscale("log")
    plain_numbers(axes.yaxis)
    axes.set_ylabel("Separation\n(meter's errors)")
    axes.legend()


def _draw_band(axes: Axes, x: Real, findings: xr.Dataset) -> None:
    start, stop = (findings[name].values / 1e3 for name in ("band_start", "band_stop"))
    axes.fill_between(x, start, stop, color=COLOURS[5], alpha=0.5, linewidth=0)
    for edge in (start, stop):
        axes.plot(x, edge, color=COLOURS[0])
    axes.set_yscale("log")
    plain_numbers(axes.yaxis)
    axes.set_ylabel("Best band (kHz)")


def _draw_maps(findings: xr.Dataset, axes: Sequence[Axis], title: str, path: Path) -> None:
    with chart(path, 11, 4.6) as figure:
        left, right = figure.subplots(1, 2, sharey=True)
        _map_accuracy(left, findings, axes)
        _map_separation(right, findings, axes)
        _scale(left, "y", axes[1])
        figure.suptitle(title)


def _map_accuracy(panel: Axes, findings: xr.Dataset, axes: Sequence[Axis]) -> None:
    from matplotlib.patheffects import withStroke

    accuracy = findings["accuracy"].transpose(axes[1].key.name, axes[0].key.name).values
    _map(panel, 100 * accuracy, axes, _right(findings), vmin=0, vmax=100)
    x, y = (np.array(axis.values, dtype=float) for axis in axes)
    if min(accuracy.shape) >= CONTOURED:
        lines = panel.contour(
            x, y, accuracy, list(CONTOURS), colors="black", linestyles=list(CONTOURS.values())
        )
        panel.clabel(lines, fmt=lambda level: f"{100 * level:.0f} %", fontsize=8)
    outlined = {"color": "white", "path_effects": [withStroke(linewidth=3, foreground="black")]}
    for value in y:
        along = findings.sel({axes[1].key.name: value})
        panel.plot(x[list(as_good(along))], [value, value], **outlined)
        panel.plot(x[best_index(along)], value, "o", markersize=5, **outlined)
    panel.set_title(f"White: the best, and what is within {100 * AS_GOOD:.0f} points of it")


def _map_separation(panel: Axes, findings: xr.Dataset, axes: Sequence[Axis]) -> None:
    from matplotlib.colors import LogNorm

    least = findings["least_separation"].transpose(axes[1].key.name, axes[0].key.name).values
    shown = np.ma.masked_less_equal(least, 0)
    norm = LogNorm(shown.min(), shown.max()) if shown.count() else None
    _map(panel, shown, axes, "Distance (meter's errors)", norm=norm)
    x, y = (np.array(axis.values, dtype=float) for axis in axes)
    if min(least.shape) >= CONTOURED and least.min() < NOISE < least.max():
        lines = panel.contour(x, y, least, [NOISE], colors="black")
        panel.clabel(lines, fmt=lambda level: f"{level:g}", fontsize=8)
    panel.set_title(f"Separation of the nearest two {findings.attrs['target']}s")


def _map(panel: Axes, values: Real, axes: Sequence[Axis], label: str, **colours: object) -> None:
    edges = [_edges(axis) for axis in axes]
    mesh = panel.pcolormesh(*edges, values, cmap="viridis", **colours)  # pyright: ignore
    bar = panel.figure.colorbar(mesh, ax=panel, label=label, pad=0.02)
    if colours.get("norm"):
        plain_numbers(bar.ax.yaxis)
    panel.grid(False)
    _scale(panel, "x", axes[0])


def _edges(axis: Axis) -> Real:
    """Limits of the cells around each value."""
    values = np.array(axis.values, dtype=float)
    if values.size == 1:
        return values * (0.9, 1.1) if values[0] else np.array([-0.5, 0.5])
    along = np.log(values) if axis.logarithmic else values
    middles = (along[1:] + along[:-1]) / 2
    edges = np.array([2 * along[0] - middles[0], *middles, 2 * along[-1] - middles[-1]])
    return np.exp(edges) if axis.logarithmic else edges


def _scale(panel: Axes, name: Literal["x", "y"], axis: Axis) -> None:
    """Ticks, label and spacing of a chart's axis."""
    from matplotlib.ticker import MaxNLocator

    ruler = panel.xaxis if name == "x" else panel.yaxis
    ruler.set_major_formatter("{x:g}")
    if axis.logarithmic:
        panel.set(**{f"{name}scale": "log"})
        plain_numbers(ruler)
    if axis.key.whole:
        ruler.set_major_locator(MaxNLocator(integer=True))
    label = axis_label(axis.key)
    if axis.key.unit:
        unit_axis(ruler, label, axis.key.unit)
    else:
        ruler.set_label_text(label)


def _right(findings: xr.Dataset) -> str:
    return f"{findings.attrs['target'].capitalize()}s right (%)"
