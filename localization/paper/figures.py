"""The paper's figures, drawn from simulated sweeps, and further ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...simulator.arrays import Real
from ...simulator.chart_style import COLOURS, LINE_STYLES, UNPRESSED_COLOUR, chart, frequency_axis
from ...simulator.measure.simulate import simulate
from ...simulator.models.line import HALF_POWER, attenuation, open_line_amplitude
from ...simulator.models.solver import DEFAULT_RTOL, Solver
from ...simulator.press.press import every_press
from ...simulator.report.findings import Cell, DataTable, Finding, Findings, Heading, Items
from ...simulator.scene.parts import Skin
from ...simulator.scene.scene import Scene
from ..evaluation.confusion import Confusion
from ..evaluation.confusion_chart import draw_confusion
from .claims import RULES, Claim
from .paper_quantities import paper_frequencies, totals
from .studies import DRAWS, SimulatedExperiment, crossed_cap

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

PAPER = (
    "H. A. Sonar, M. C. Yuen, R. Kramer-Bottiglio, J. Paik, “An Any-Resolution Distributed "
    "Pressure Localization Scheme Using a Capacitive Soft Sensor Skin”"
)
ASSUMED = (
    "The paper states neither the meter's noise nor how equal its presses were. The scenes assume "
    "the noise that is given with each number; the chart of accuracy against noise shows what that "
    "choice does. Each experiment is one draw of six presses a pixel, as in the paper; the studies "
    f"are means of {DRAWS} draws of the noise."
)


def report_of(
    claims: Sequence[Claim],
    charts: Sequence[Finding],
    software: str,
    files: Mapping[str, Callable[[Path], object]],
) -> Findings:
    """The page, its charts and further files. software: name and version of the simulator."""
    introduction = (
        f"{PAPER}. Every sweep below is simulated: the two electrode sheets and the foam as a "
        f"distributed RC sheet, solved to a relative tolerance of {DEFAULT_RTOL:g} of Rs and of "
        f"Cp, then read out by a meter with the noise of the scene. {software}."
    )
    agreeing = sum(claim.agrees for claim in claims)
    compared = (
        f"{agreeing} of {len(claims)} statements agree; those that differ stand first. Each is "
        "judged on the device as the paper describes it, foils included, at the noise that is "
        "given with it. A statement agrees, by the rule that is given with it, if"
    )
    rules = Items([f"{rule}." for rule in RULES.values()], list(RULES))
    rows = [_row(claim) for claim in sorted(claims, key=lambda claim: claim.agrees)]
    numbers = DataTable(
        "statements", ["Statement", "Paper", "Simulation", "Noise", "", "Why"], rows
    )
    heading = Heading("Every number of the paper next to ours")
    parts = [introduction, heading, compared, rules, numbers, *charts]
    parts += [Heading("What is assumed"), ASSUMED]
    return Findings("The paper, reproduced by physics", parts, files=files)


def _row(claim: Claim) -> list[str | Cell]:
    verdict = "✓ agrees" if claim.agrees else "✗ differs"
    return [
        Cell(claim.topic, claim.source),
        claim.paper,
        claim.ours,
        claim.noise,
        Cell(verdict, claim.rule, claim.agrees),
        claim.why,
    ]


CURVE_POINTS = 60
UNITS = {"Cp": (1e12, "Cp (pF)"), "Rs": (1e-3, "Rs (kohm)")}


def attenuation_figure(path: Path, strips: Sequence[Scene]) -> None:
    """Figure 2(c): amplitude at each pixel's end on the infinite and on the finite open line."""
    frequency = np.geomspace(50, 1e5, 300)
    with chart(path, 10, 3.4) as figure:
        for axes, strip in zip(figure.subplots(1, len(strips), sharey=True), strips, strict=True):
            _draw_attenuation(axes, strip.parts.skin, frequency)
        figure.axes[0].set_ylabel("Amplitude over that at the interface (dB)")
        figure.suptitle("Solid: infinite line, Eq 5; dots: Eq 6; dashed: the finite open line")


def experiment_figure(path: Path, experiment: SimulatedExperiment, confusion: Confusion) -> None:
    """Cp, Rs and the change of Cp against frequency for every pressed pixel; confusion matrix.

    Lines are noise-free, at the nominal press; dots are the meter's readings.
    """
    curves = _curves(experiment.scene)
    with chart(path, 10, 7.6) as figure:
        top, bottom = figure.subplots(2, 2)
        for axes, quantity in zip(top, UNITS, strict=True):
            _draw_quantity(axes, quantity, curves, experiment.measured)
        _draw_changes(bottom[0], curves, experiment)
        draw_confusion(bottom[1], confusion)
        handles, labels = bottom[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 8))
        figure.suptitle(_caption(experiment.scene))


def frequency_figure(path: Path, study: xr.DataArray) -> None:
    """Draw the accuracy from 10 and 20 frequencies, with Cp alone and with Rs and Cp."""
    names, choices = study["quantities"].values, study["frequencies"].values
    with chart(path, 9, 3.4) as figure:
        panels = figure.subplots(1, len(names), sharey=True)
        for axes, quantities in zip(panels, names, strict=True):
            places = np.arange(study.sizes["scene"])
            for index, choice in enumerate(choices):
                accuracy = 100 * study.sel(frequencies=choice, quantities=quantities).values
                at, colour = places + 0.27 * (index - 1), COLOURS[index]
                bars = axes.bar(at, accuracy, 0.25, color=colour, label=f"{choice} frequencies")
                axes.bar_label(bars, [f"{value:.0f}" for value in accuracy], fontsize=8)
            axes.set_xticks(places, list(study["scene"].values))
            axes.set_title(quantities)
            axes.grid(False, axis="x")
            axes.set_axisbelow(True)
        panels[0].set_ylabel("Columns right (%)")
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)


def noise_figure(path: Path, study: xr.DataArray, scenes: Mapping[str, Scene]) -> None:
    """Draw the accuracy against the meter's noise for the strips and the sheets."""
    with chart(path, 6.5, 3.8) as figure:
        axes = figure.subplots()
        for name in study["scene"].values:
            scene = scenes[name]
            is_sheet = scene.pixels.rows > 1
            axes.semilogx(
                100 * study["multiple"].values * scene.readout.magnitude_noise,
                100 * study.sel(scene=name).values,
                marker="s" if is_sheet else "o",
                color=COLOURS[scene.pixels.columns - 3],
                linestyle="-" if is_sheet else "--",
                label=name,
            )
        axes.xaxis.set_major_formatter("{x:g}")
        axes.set_xlabel("Noise of each reading (% of |Z|; half as many degrees of phase)")
        axes.set_ylabel("Columns right (%)")
        axes.set_ylim(0, 103)
        axes.legend(ncols=2)


def contact_figure(path: Path, study: xr.DataArray) -> None:
    """Draw the accuracy with terminals at one edge and at crossed edges, and the crossed cap."""
    n = study["n"].values
    with chart(path, 6, 3.8) as figure:
        axes = figure.subplots()
        for layout, colour in zip(study["layout"].values, COLOURS, strict=False):
            for multiple, style in zip(study["multiple"].values, ("-", "--"), strict=True):
                accuracy = 100 * study.sel(layout=layout, multiple=multiple).values
                label = f"{layout}, {multiple:g} of the noise"
                axes.plot(n, accuracy, style, marker="o", color=colour, label=label)
        caps = [100 * crossed_cap(int(pixels)) for pixels in n]
        axes.plot(n, caps, ":", color=UNPRESSED_COLOUR, label="(n + 1) / 2n")
        axes.set_xticks(n, [f"{pixels}x{pixels}" for pixels in n])
        axes.set_xlabel("Pixels")
        axes.set_ylabel("Columns right (%)")
        axes.set_ylim(0, 103)
        axes.legend()


def _draw_attenuation(axes: Axes, skin: Skin, frequency: Real) -> None:
    device, length = totals(skin), skin.length
    R, C = device.R / length, device.C / length
    for index, cutoff in enumerate(paper_frequencies(skin)):
        x, colour = length * (index + 1) / skin.pixels.columns, COLOURS[index]
        infinite = attenuation(frequency, x, R, C)
        finite = open_line_amplitude(frequency, x, length, R, C)
        axes.plot(frequency / 1e3, _decibel(infinite), color=colour, label=f"{1e3 * x:.0f} mm")
        axes.plot(frequency / 1e3, _decibel(finite), color=colour, linestyle="--")
        axes.plot(cutoff / 1e3, _decibel(HALF_POWER), "o", color=colour)
    axes.axhline(float(_decibel(HALF_POWER)), color=UNPRESSED_COLOUR, linewidth=1)
    axes.annotate("-3 dB", (frequency[-1] / 1e3, -3), ha="right", va="bottom", fontsize=8)
    axes.set_ylim(-24, 1)
    axes.set_title(f"1x{skin.pixels.columns}")
    axes.legend(title="distance x", loc="lower left")
    frequency_axis(axes)


def _decibel(amplitude: Real | float) -> Real:
    return 20 * np.log10(amplitude)


def _curves(scene: Scene) -> xr.Dataset:
    band = scene.frequencies
    points = np.geomspace(band[0], band[-1], CURVE_POINTS).tolist()
    dense = scene.with_({"sweep": {"frequencies": points}})
    return simulate(Solver(dense.parts), every_press(dense.parts.skin, dense.press))


def _draw_quantity(axes: Axes, quantity: str, curves: xr.Dataset, measured: xr.Dataset) -> None:
    scale, label = UNITS[quantity]
    _draw_sweeps(axes, curves, scale * curves[quantity].values[:, 0])
    _draw_readings(axes, measured, scale * measured[quantity].values[:, 0])
    axes.set_ylabel(label)


def _draw_changes(axes: Axes, curves: xr.Dataset, experiment: SimulatedExperiment) -> None:
    Cp, measured = curves["Cp"].values[:, 0], experiment.measured["Cp"].values[:, 0]
    unpressed = experiment.unpressed["Cp"].values[0, 0]
    (curve_at_rest,) = Cp[curves["row"].values == 0]
    _draw_sweeps(axes, curves, 100 * (Cp / curve_at_rest - 1))
    _draw_readings(axes, experiment.measured, 100 * (measured / unpressed - 1))
    axes.set_ylabel("Change of Cp by the press (%)")


def _draw_sweeps(axes: Axes, curves: xr.Dataset, values: Real) -> None:
    for sweep, style in zip(values, _styles(curves), strict=True):
        axes.plot(curves["frequency"].values / 1e3, sweep, **style)
    frequency_axis(axes)


def _draw_readings(axes: Axes, measured: xr.Dataset, values: Real) -> None:
    for sweep, style in zip(values, _styles(measured), strict=True):
        frequency, colour = measured["frequency"].values / 1e3, style["color"]
        axes.plot(frequency, sweep, ".", color=colour, markersize=2.5)


def _styles(sweeps: xr.Dataset) -> list[dict[str, Any]]:
    """A colour for each column, a line style for each row; black for the unpressed skin."""
    return [
        {"color": UNPRESSED_COLOUR, "linestyle": "-", "label": "nothing pressed"}
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
