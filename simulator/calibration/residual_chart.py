"""Residuals of a calibration, and their chart."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Real
from ..chart_style import COLOURS, UNPRESSED_COLOUR, chart, frequency_axis
from ..notebook_display import CLOSE_LEGEND, SmallChart
from ..sweeps import parallel_capacitance
from .fit import Fit
from .measurements import SessionSweep

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .run import Calibration


def residuals(fit: Fit) -> dict[str, Real]:
    """Measured minus fitted values over the noise of a reading, by quantity.

    Quantities are |Z|, phase, Rs and Cp, or those of gains, each of shape (sweep, interface,
    frequency). The meter's fixed errors of the session are part of the fit. Residuals are 0 where
    nothing was read.
    """
    spec = fit.spec
    Z = np.stack([reading.Z for reading in spec.measurements.sweeps])
    averaged = np.sqrt([reading.averaged for reading in spec.measurements.sweeps])[:, None, None]
    frequency = spec.measurements.parts.setup.frequency
    magnitude, phase = spec.readout.noise(Z, frequency) / averaged
    residual = fit.problem.residuals(fit.u)[: 2 * Z.size].reshape(len(Z), 2, *Z.shape[1:])
    if spec.measurements.parts.setup.gain:
        own = {"gain": -residual[:, 0], "phase of the gain": -residual[:, 1]}
        return dict(list(own.items())[: spec.measurements.per_reading])
    fitted = Z * np.exp(residual[:, 0] * magnitude + 1j * residual[:, 1] * phase)
    omega, Y = 2 * np.pi * frequency, 1 / fitted
    of_Rs = np.hypot(fitted.real * magnitude, fitted.imag * phase)
    of_Cp = np.hypot(Y.imag * magnitude, Y.real * phase) / omega
    Cp, fitted_Cp = (parallel_capacitance(each, frequency) for each in (Z, fitted))
    return {
        "|Z|": -residual[:, 0],
        "phase": -residual[:, 1],
        "Rs": (Z.real - fitted.real) / of_Rs,
        "Cp": (Cp - fitted_Cp) / of_Cp,
    }


LIKELY = 2.0
MAX_NAMED = 6
FAINT = 0.35
SEVERAL_COLOUR = "0.5"
"""Grey of sweeps of several touches."""
SMALL = (4.8, 2.6)
"""Size of the small chart, inches."""


def draw_residuals(calibration: Calibration, interface: int, path: Path) -> None:
    """Residuals of all quantities at one interface against frequency, as a PNG."""
    measured = calibration.fit.spec.measurements
    read = measured.read[interface]
    frequency = measured.parts.setup.frequency[read]
    with chart(path, 9, 6.2) as figure:
        found = residuals(calibration.fit)
        grid = figure.subplots(
            (len(found) + 1) // 2, min(len(found), 2), sharex=True, squeeze=False
        )
        for axes, (name, values) in zip(grid.flat, found.items(), strict=True):
            _draw(axes, frequency, values[:, interface, read], measured.sweeps)
            axes.set_title(name)
        for axes in grid[-1]:
            frequency_axis(axes)
        for axes in grid[:, 0]:
            axes.set_ylabel("(measured - fitted) / error")
        handles, labels = grid[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 4))
        name = measured.parts.setup.interfaces[interface].name
        figure.suptitle(
            f"{measured.parts.skin.name}, interface {name}\nResiduals of the fit in units of the "
            f"meter's error; chi-squared per degree of freedom {calibration.chi_squared:.3g}"
        )


def small_residual_chart(calibration: Calibration) -> SmallChart:
    """Residuals of amplitude and phase at the first interface, for a notebook."""
    return SmallChart(lambda figure: _draw_small(figure, calibration), *SMALL, top=0.6)


def _draw_small(figure: Figure, calibration: Calibration) -> None:
    measured = calibration.fit.spec.measurements
    read = measured.read[0]
    found = list(residuals(calibration.fit).items())[:2]
    panels = figure.subplots(1, len(found), sharey=True, squeeze=False)[0]
    for axes, (name, values) in zip(panels, found, strict=True):
        frequency = measured.parts.setup.frequency[read]
        _draw(axes, frequency, values[:, 0, read], measured.sweeps, marker="")
        axes.set_title(name)
        frequency_axis(axes)
    panels[0].set_ylabel("(measured - fitted) / error")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper center", ncols=4, **CLOSE_LEGEND)


def _draw(
    axes: Axes,
    frequency: Real,
    values: Real,
    readings: tuple[SessionSweep, ...],
    marker: str = ".",
) -> None:
    """Draws baseline sweeps black and presses in colours, each as a line while they are few.

    With more sweeps, those of a column are faint, and their mean is a line. marker: "" draws lines
    alone.
    """
    kHz, few = frequency / 1e3, len(readings) <= MAX_NAMED + 1
    axes.axhspan(-LIKELY, LIKELY, color="0.93", label="within 2 errors")
    labels = [_label_and_colour(reading, few) for reading in readings]
    ordered = sorted(range(len(readings)), key=lambda k: _place(readings[k]))
    for label, colour in dict.fromkeys(labels[k] for k in ordered):
        group = values[[each == (label, colour) for each in labels]]
        if len(group) > 1:
            faint = {"alpha": FAINT, "markersize": 3, "linewidth": 0.5, "label": "_"}
            axes.plot(kHz, group.T, marker or "-", color=colour, **faint)
            label = f"{label}, mean"
        axes.plot(kHz, group.mean(axis=0), marker=marker, linewidth=1, color=colour, label=label)


def _place(reading: SessionSweep) -> tuple[int, ...]:
    """Place among the lines: unpressed, then by column and row, then several pressed."""
    row, column = reading.press.pixel
    return (2,) if row < 0 or column < 0 else (int(bool(reading.press.touches)), column, row)


def _label_and_colour(reading: SessionSweep, few: bool) -> tuple[str, str]:
    """Label and colour of a sweep, or of all sweeps that are drawn together."""
    if not reading.press.touches:
        return "unpressed", UNPRESSED_COLOUR
    row, column = reading.press.pixel
    colour = COLOURS[(max(column, 1) - 1) % len(COLOURS)]
    if few:
        return f"pressed {row},{column}" if row > 0 else f"pressed {reading.press}", colour
    return (f"column {column}", colour) if column > 0 else ("several pressed", SEVERAL_COLOUR)
