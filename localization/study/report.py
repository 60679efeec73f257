"""A study's findings as files, and as one line for each best value."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...simulator.report.files import write_frame
from ...simulator.sweeps import whole_file
from ...simulator.sweeps.formats.netcdf import write_netcdf
from .axis import Axis
from .scene_keys import ALL_PIXELS, BOTH_SHEETS, Key, with_values

if TYPE_CHECKING:
    import xarray as xr

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
