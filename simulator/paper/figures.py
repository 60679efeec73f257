"""The paper's figures, drawn from simulated sweeps, and those it would have needed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from simulator.analytic import HALF_POWER, attenuation, open_line_amplitude
from simulator.fidelity import Solver
from simulator.paper.localizer import Confusion, Localizer
from simulator.paper.reading import paper_frequencies, totals
from simulator.paper.rehearsal import Rehearsal, at_frequencies
from simulator.paper.studies import crossed_cap
from simulator.plot import AT_REST, COLOURS, LINE_STYLES, chart
from simulator.scene import Scene
from simulator.simulate import simulate

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

CURVE_POINTS = 60
UNITS = {"Cp": (1e12, "Cp (pF)"), "Rs": (1e-3, "Rs (kohm)")}


def attenuation_figure(path: Path, strips: Sequence[Scene]) -> None:
    """Figure 2(c): amplitude at each pixel's end on the infinite and on the finite open line."""
    frequency = np.geomspace(50, 1e5, 300)
    with chart(path, 10, 3.4) as figure:
        for axes, strip in zip(figure.subplots(1, len(strips), sharey=True), strips, strict=True):
            _draw_attenuation(axes, strip, frequency)
        figure.axes[0].set_ylabel("Amplitude over that at the interface (dB)")
        figure.axes[0].legend(loc="lower left")


def experiment_figure(
    path: Path, rehearsal: Rehearsal, confusion: Confusion, localizer: Localizer
) -> None:
    """Cp, Rs and the change of Cp against frequency for every pressed pixel; confusion matrix.

    Lines are noise-free, at the nominal press; dots are what the meter showed.
    """
    curves = _curves(rehearsal.scene)
    with chart(path, 10, 7.6) as figure:
        top, bottom = figure.subplots(2, 2)
        for axes, quantity in zip(top, UNITS, strict=True):
            _draw_quantity(axes, quantity, curves, rehearsal.measured)
        _draw_changes(bottom[0], curves, rehearsal)
        bottom[1].grid(False)
        localizer.draw(bottom[1], confusion)
        handles, labels = bottom[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 8))
        figure.suptitle(_caption(rehearsal.scene))


def frequency_figure(path: Path, study: xr.DataArray) -> None:
    """Accuracy from 10 and 20 frequencies, of Cp alone and of Rs and Cp."""
    with chart(path, 6.5, 3.4) as figure:
        axes = figure.subplots()
        cases = [(points, names) for names in study["quantities"].values for points in (10, 20)]
        places = np.arange(study.sizes["scene"])
        for index, (points, names) in enumerate(cases):
            accuracy = 100 * study.sel(frequencies=points, quantities=names).values
            bars = axes.bar(
                places + 0.2 * (index - 1.5),
                accuracy,
                0.18,
                color=COLOURS[index],
                label=f"{points} frequencies, {names}",
            )
            axes.bar_label(bars, [f"{value:.0f}" for value in accuracy], fontsize=7)
        axes.set_xticks(places, list(study["scene"].values))
        axes.set_ylabel("Columns right (%)")
        axes.set_ylim(0, 112)
        axes.grid(False, axis="x")
        figure.legend(loc="outside lower center", ncols=2)


def noise_figure(path: Path, study: xr.DataArray, scenes: Mapping[str, Scene]) -> None:
    """Accuracy against the meter's noise for the strips and the sheets."""
    with chart(path, 6.5, 3.8) as figure:
        axes = figure.subplots()
        for name in study["scene"].values:
            scene = scenes[name]
            accuracy = 100 * study.sel(scene=name).values
            percent = 100 * study["multiple"].values * scene.readout.magnitude_noise
            axes.semilogx(
                percent,
                accuracy,
                marker="os"[scene.pixels.rows > 1],
                color=COLOURS[scene.pixels.columns - 3],
                linestyle="-" if scene.pixels.rows > 1 else "--",
                label=name,
            )
            axes.axhline(100 / _classes(scene), color="0.7", linewidth=0.6, zorder=0)
        axes.set_xlabel("Noise of each reading: % of |Z|, and half as many degrees of phase")
        axes.set_ylabel("Columns right (%)")
        axes.set_ylim(0, 103)
        axes.legend(ncols=2)


def contact_figure(path: Path, study: xr.DataArray) -> None:
    """Accuracy with both sheets fed at one edge and with crossed edges, and the crossed cap."""
    n = study["n"].values
    with chart(path, 6, 3.8) as figure:
        axes = figure.subplots()
        for layout, colour in zip(study["layout"].values, COLOURS, strict=False):
            for multiple, style in zip(study["multiple"].values, ("-", "--"), strict=True):
                accuracy = 100 * study.sel(layout=layout, multiple=multiple).values
                label = f"{layout}, {multiple:g} of the noise"
                axes.plot(n, accuracy, style, marker="o", color=colour, label=label)
        caps = [100 * crossed_cap(int(pixels)) for pixels in n]
        axes.plot(n, caps, ":", color=AT_REST, label="(n + 1) / 2n")
        axes.set_xticks(n, [f"{pixels}x{pixels}" for pixels in n])
        axes.set_xlabel("Pixels")
        axes.set_ylabel("Columns right (%)")
        axes.set_ylim(0, 103)
        axes.legend()


def _draw_attenuation(axes: Axes, strip: Scene, frequency: NDArray[np.float64]) -> None:
    device, length = totals(strip), strip.skin.length
    R, C = device.R / length, device.C / length
    for index, cutoff in enumerate(paper_frequencies(strip)):
        x, colour = length * (index + 1) / strip.pixels.columns, COLOURS[index]
        infinite = attenuation(frequency, x, R, C)
        finite = open_line_amplitude(frequency, x, length, R, C)
        axes.semilogx(frequency, _decibel(infinite), color=colour, label=f"x = {1e3 * x:.0f} mm")
        axes.semilogx(frequency, _decibel(finite), color=colour, linestyle="--")
        axes.plot(cutoff, _decibel(HALF_POWER), "o", color=colour)
    axes.axhline(float(_decibel(HALF_POWER)), color=AT_REST, linewidth=1)
    axes.annotate("-3 dB", (frequency[-1], -3), ha="right", va="bottom", fontsize=8)
    axes.set_ylim(-24, 1)
    axes.set_title(f"1x{strip.pixels.columns}: infinite line (Eq 5) —, finite open line - -")
    axes.set_xlabel("Frequency (Hz)")


def _decibel(amplitude: NDArray[np.float64] | float) -> NDArray[np.float64]:
    return 20 * np.log10(amplitude)


def _curves(scene: Scene) -> xr.Dataset:
    band = scene.frequencies
    dense = at_frequencies(scene, np.geomspace(band[0], band[-1], CURVE_POINTS))
    return simulate(Solver(dense), dense.every_press())


def _draw_quantity(axes: Axes, quantity: str, curves: xr.Dataset, measured: xr.Dataset) -> None:
    scale, label = UNITS[quantity]
    frequency = curves["frequency"].values
    for sweep, style in zip(curves[quantity].values[:, 0], _styles(curves), strict=True):
        axes.loglog(frequency, scale * sweep, **style)
    for sweep, style in zip(measured[quantity].values[:, 0], _styles(measured), strict=True):
        colour = style["color"]
        axes.plot(measured["frequency"].values, scale * sweep, ".", color=colour, markersize=2.5)
    axes.set_xlabel("Frequency (Hz)")
    axes.set_ylabel(label)


def _draw_changes(axes: Axes, curves: xr.Dataset, rehearsal: Rehearsal) -> None:
    Cp, frequency = curves["Cp"].values[:, 0], curves["frequency"].values
    at_rest = int(np.flatnonzero(curves["row"].values == 0)[0])
    for sweep, style in zip(Cp, _styles(curves), strict=True):
        axes.semilogx(frequency, 100 * (sweep / Cp[at_rest] - 1), **style)
    reference = rehearsal.at_rest["Cp"].values[0, 0]
    measured = rehearsal.measured
    for sweep, style in zip(measured["Cp"].values[:, 0], _styles(measured), strict=True):
        change = 100 * (sweep / reference - 1)
        axes.plot(measured["frequency"].values, change, ".", color=style["color"], markersize=2.5)
    axes.set_xlabel("Frequency (Hz)")
    axes.set_ylabel("Change of Cp by the press (%)")


def _styles(sweeps: xr.Dataset) -> list[dict[str, object]]:
    """A colour for each column, a line style for each row; black at rest."""
    return [
        {"color": AT_REST, "linestyle": "-", "label": "nothing pressed"}
        if row == 0
        else {
            "color": COLOURS[column - 1],
            "linestyle": LINE_STYLES[row - 1],
            "label": f"column {column}" if row == 1 else None,
        }
        for row, column in zip(sweeps["row"].values, sweeps["column"].values, strict=True)
    ]


def _caption(scene: Scene) -> str:
    rows = f"; line styles are rows 1 to {scene.pixels.rows}" if scene.pixels.rows > 1 else ""
    return f"{scene.description}{rows}"


def _classes(scene: Scene) -> int:
    return scene.pixels.columns + int(scene.experiment.unpressed)
