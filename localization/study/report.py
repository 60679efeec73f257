"""A study's findings as files, and as one line for each best value."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ...simulator.arrays import Real
from ...simulator.chart_style import COLOURS, chart, plain_numbers, unit_axis
from ...simulator.report.files import write_frame
from ...simulator.sweeps import whole_file
from ...simulator.sweeps.formats.netcdf import write_netcdf
from .axis import ALL_PIXELS, BOTH_SHEETS, Axis, Key, with_values

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


IN_HERTZ = {"band_start": "band_start_Hz", "band_stop": "band_stop_Hz"}
ENDINGS = (".csv", ".nc")
AS_GOOD = 0.05
MAX_LINES = 20
LABELS = {BOTH_SHEETS: "Sheet resistance of both sheets", ALL_PIXELS: "Pixels along each side"}


def write_table(findings: xr.Dataset, path: Path) -> None:
    """Write a study as NetCDF, or as CSV with a line for each point, by the path's ending."""
    if path.suffix == ".csv":
        return write_frame(path, findings.rename(IN_HERTZ).to_dataframe().reset_index())
    with whole_file(path) as unfinished:
        write_netcdf(findings, unfinished)


def answers(findings: xr.Dataset, axes: Sequence[Axis]) -> list[str]:
    """Lines with the best value of the first axis, one for each value of the second.

    The best value has the highest accuracy; among equals, the largest least separation. Values
    around it count as equally good if their accuracy is within AS_GOOD of it.
    """
    first, *others = (axis.key for axis in axes)
    if not others:
        return [_best(findings, first)]
    (second,) = others
    return [
        f"{named(second, float(value))}: {_best(findings.sel({second.name: value}), first)}"
        for value in findings[second.name].values
    ]


def spacing(axes: Sequence[Axis]) -> str:
    """Spacing of the values of each axis, in one line."""
    return "; ".join(_spaced(axis) for axis in axes)


def _spaced(axis: Axis) -> str:
    first, last, count = axis.values[0], axis.values[-1], len(axis.values)
    if count == 1:
        return f"{axis.key.name}: {first:.6g}"
    even = "logarithmic" if axis.logarithmic else "linear" if axis.linear else "as listed"
    return f"{axis.key.name}: {count} values from {first:.6g} to {last:.6g}, {even}"


def first_lines(lines: Sequence[str], output: Path) -> list[str]:
    """The first MAX_LINES lines; if there are more, a line that names the complete file."""
    left = len(lines) - MAX_LINES
    if left <= 0:
        return list(lines)
    return [*lines[:MAX_LINES], f"{left} more lines left out: all points are in {output}"]


def best_index(findings: xr.Dataset) -> int:
    """Index of the best finding along one axis, as defined in `answers`."""
    accuracy, least = (findings[name].values for name in ("accuracy", "least_separation"))
    return int(np.lexsort((least, accuracy))[-1])


def as_good(findings: xr.Dataset) -> tuple[int, int]:
    """First and last index of the run around the best that is within AS_GOOD of its accuracy."""
    accuracy, best = findings["accuracy"].values, best_index(findings)
    outside = np.flatnonzero(accuracy < accuracy[best] - AS_GOOD)
    before, after = outside[outside < best], outside[outside > best]
    first = int(before[-1]) + 1 if before.size else 0
    return first, int(after[0]) - 1 if after.size else len(accuracy) - 1


def written(key: Key, value: float) -> str:
    """Value as text: three digits, with an SI prefix if it has a unit."""
    from matplotlib.ticker import EngFormatter

    if key.name == ALL_PIXELS:
        return f"{value:.0f}x{value:.0f} pixels"
    return EngFormatter(unit=key.unit)(float(f"{value:.3g}")) if key.unit else f"{value:.6g}"


def named(key: Key, value: float) -> str:
    """Value as text, with the name of its key unless that key has a label of its own."""
    text = written(key, value)
    return text if key.name in LABELS else f"{key.name} = {text}"


def axis_label(key: Key) -> str:
    """Label of a chart's axis, without its unit."""
    return LABELS.get(key.name, key.name)


def describe_experiment(table: Mapping[str, Any], axes: Sequence[Axis], presses: str) -> str:
    """One line on the scene, its frequencies, noise and presses, without the parts that vary."""
    readout, f = table["readout"], with_values(table, {}).frequencies
    parts = {
        "sweep": f"{len(f)} frequencies, {f[0] / 1e3:.4g} to {f[-1] / 1e3:.4g} kHz",
        "readout": _noise(readout),
        "experiment": presses,
    }
    varied = {place[0] for axis in axes for place in axis.key.places}
    return "; ".join([table["name"], *(text for part, text in parts.items() if part not in varied)])


def _noise(readout: Mapping[str, Any]) -> str:
    if "spread" in readout:
        return "noise as measured, by |Z| and frequency"
    if "data_sheet" in readout:
        return f"noise by the accuracy of {readout['data_sheet']['accuracy']['name']}"
    return (
        f"noise {100 * readout['magnitude_noise']:.3g} % of |Z| and "
        f"{np.degrees(readout['phase_noise']):.2g}°"
    )


def _best(findings: xr.Dataset, key: Key) -> str:
    values, best = findings[key.name].values, best_index(findings)
    accuracy = float(findings["accuracy"].values[best])
    text = f"best accuracy {100 * accuracy:.0f} % at {named(key, float(values[best]))}"
    if best in (0, len(values) - 1) and len(values) > 1:
        text += ", where the range ends"
    low, high = as_good(findings)
    if low == high:
        return text
    ends = " to ".join(written(key, float(values[end])) for end in (low, high))
    return f"{text} ({100 * max(0.0, accuracy - AS_GOOD):.0f} % or more from {ends})"
