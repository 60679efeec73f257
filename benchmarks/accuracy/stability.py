"""Where each way to Rs and Cp keeps its digits and where it loses them: a measured map.

True errors over dimensionless frequency, contact length, contrast of the sheets and pixel count.

Run: python benchmarks/accuracy/stability.py [--quick]
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.scenes import AXES, Axis, Case
from rcskin.benchmarks.bench import Run, launch
from rcskin.benchmarks.rivals import bilinear, finite_elements, lines, ngspice_grid, rational_fit
from rcskin.benchmarks.rivals.finite_elements import Elements
from rcskin.simulator.chart_style import chart
from rcskin.simulator.models.solver import ModelName, Solver
from rcskin.simulator.sweeps import ToleranceError, parallel_capacitance

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.image import AxesImage

FAILED, REFUSED = np.inf, -np.inf
"""In place of an error: an answer that is no number, and none where none was promised."""
BEST, WORST = -12, 0
OURS = "rcskin"
NO_ANSWER = "0.88"


def draw(path: Path, ways: list[str], maps: dict[str, pd.DataFrame], wrong: float) -> None:
    """Write the chart. maps: way, value, Rs, Cp by the label of what is varied.

    Errors from `wrong` on are hatched, FAILED as the worst; NaN is left grey, REFUSED dotted.
    """
    columns = [len(np.unique(rows["value"])) for rows in maps.values()]
    with chart(path, 11, 7.2) as figure:
        panels = figure.subplots(2, len(maps), sharey=True, width_ratios=[8 + n for n in columns])
        for name, row in zip(("Rs", "Cp"), panels, strict=True):
            for axes, (label, rows) in zip(row, maps.items(), strict=True):
                errors = rows.pivot(index="way", columns="value", values=name).loc[ways]
                image = _heat_map(axes, errors, wrong)
                axes.set_xlabel(label)
            row[0].set_title(f"Error of {name}", loc="left", fontweight="bold")
            row[0].set_yticks(range(len(ways)), ways)
            for label in row[0].get_yticklabels():
                label.set_fontweight("bold" if label.get_text().startswith(OURS) else "normal")
        bar = figure.colorbar(image, ax=panels, shrink=0.5, aspect=30)
        bar.set_label("log10 of the relative error")
        figure.suptitle(
            f"Hatched: wrong by more than {wrong:.0%}, or no number.   Dotted: refused to answer."
            "   Grey: for lines only.",
            fontsize=9,
        )


def _heat_map(axes: Axes, errors: pd.DataFrame, wrong: float) -> AxesImage:
    values = errors.to_numpy()
    with np.errstate(divide="ignore", invalid="ignore"):
        exponents = np.where(values == REFUSED, np.nan, np.log10(values))
    image = axes.imshow(
        np.clip(exponents, BEST, WORST), cmap="YlOrRd", vmin=BEST, vmax=WORST, aspect="auto"
    )
    axes.set_facecolor(NO_ANSWER)
    axes.grid(False)
    axes.set_yticks(np.arange(len(errors)))
    for hatch, where in (("////", values >= wrong), ("....", values == REFUSED)):
        for row, column in np.argwhere(where):
            sides = [column - 0.5, column + 0.5]
            axes.fill_between(sides, row - 0.5, row + 0.5, hatch=hatch, fc="none", lw=0)
    for line in np.arange(len(errors) - 1) + 0.5:
        axes.axhline(line, color="white", lw=0.8)
    _value_ticks(axes, errors.columns.to_numpy(dtype=float))
    return image


def _value_ticks(axes: Axes, values: np.ndarray) -> None:
    """Every second value is listed, or of powers of ten every third."""
    exponents = np.log10(values)
    if values.max() / values.min() > 1e4:
        shown = np.flatnonzero(np.isclose(exponents % 3, 0))
        labels = [f"1e{exponent:.0f}" for exponent in exponents[shown]]
    else:
        shown = np.arange(0, len(values), 2)
        labels = [f"{value:g}" for value in values[shown]]
    axes.set_xticks(shown, labels)


RTOL = 1e-6
DIGITS_OF_A_METER = 6
WRONG = 0.1
"""Relative error from which on an answer counts as none."""

Way = Callable[[Case], NDArray[np.complex128]]


class ForLinesError(Exception):
    """A way is not meant for such a skin, or tells nothing new about it."""


def for_lines(way: Way) -> Way:
    """The same way, refusing what is no line."""

    def of_line(case: Case) -> NDArray:
        if not case.line:
            raise ForLinesError
        return way(case)

    return of_line


def shipped(case: Case, model: ModelName) -> NDArray:
    """Z of this project's solver."""
    return Solver(case.scene.parts, RTOL, model).solve(case.press).Z[0]


WAYS: dict[str, Way] = {
    "Q1, slope at the foil": lambda case: bilinear.by_slope(*case.given, case.cells),
    "Q1, current Y of the foil, 1/Y": lambda case: bilinear.by_current(*case.given, case.cells),
    "Q1, deviation form": lambda case: bilinear.by_deviation(*case.given, case.cells),
    "Q1, cells across pixel edges": lambda case: bilinear.by_deviation(*case.given, case.askew),
    "Q1, single precision": lambda case: bilinear.by_deviation(
        *case.given, case.cells, np.complex64
    ),
    "Q4, scikit-fem script": lambda case: finite_elements.script(*case.given, Elements(4, 2)),
    "ngspice, grid of R and C": lambda case: ngspice_grid.impedance(*case.given, case.cells),
    "ladder of R and C": for_lines(lambda case: lines.ladder(*case.given, case.cells.along)),
    "scikit-rf, cascaded lines": for_lines(lambda case: lines.cascade(*case.given)),
    "AAA fit of 20 exact samples": for_lines(lambda case: rational_fit.impedance(*case.given)),
    "AAA fit of 20 readings": for_lines(
        lambda case: rational_fit.impedance(*case.given, digits=DIGITS_OF_A_METER)
    ),
    "polynomial fit of 20 samples": for_lines(
        lambda case: rational_fit.impedance(*case.given, rational_fit.polynomials)
    ),
    "rcskin, elements at 1e-6": lambda case: shipped(case, "sheet"),
    "rcskin at 1e-6": lambda case: shipped(case, "auto"),
}
NEEDS = {"ngspice, grid of R and C": "ngspice", "scikit-rf, cascaded lines": "skrf"}
FITS = {
    "AAA fit of 20 exact samples": (rational_fit.aaa, None),
    "AAA fit of 20 readings": (rational_fit.aaa, DIGITS_OF_A_METER),
    "polynomial fit of 20 samples": (rational_fit.polynomials, None),
}


def errors(way: Way, case: Case) -> tuple[float, float]:
    """Largest relative errors of Rs and Cp; FAILED, REFUSED, or NaN where it is not applied."""
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            Z = way(case)
    except ForLinesError:
        return np.nan, np.nan
    except ToleranceError:
        return REFUSED, REFUSED
    except (RuntimeError, ArithmeticError):
        return FAILED, FAILED
    if not np.isfinite(Z).all():
        return FAILED, FAILED
    f = case.scene.frequencies
    Cp, true_Cp = (parallel_capacitance(each, f) for each in (Z, case.truth))
    Rs_off, Cp_off = Z.real / case.truth.real - 1, Cp / true_Cp - 1
    return float(abs(Rs_off).max()), float(abs(Cp_off).max())


def ways(run: Run) -> dict[str, Way]:
    """All that take part."""
    return {name: way for name, way in WAYS.items() if name not in NEEDS or run.has(NEEDS[name])}


def measured(axis: Axis, ways: dict[str, Way]) -> pd.DataFrame:
    """Every way along one axis: way, value, Rs, Cp."""
    rows = [
        (name, value, *errors(way, case))
        for value in axis.values
        for case in [axis.case(value)]
        for name, way in ways.items()
    ]
    return pd.DataFrame(rows, columns=["way", "value", "Rs", "Cp"])


def listed(error: float) -> str:
    """An error for the table."""
    if np.isnan(error):
        return ""
    if error == REFUSED:
        return "refuses"
    if error == 0:
        return "the truth"
    return "fails" if error >= WRONG else f"{error:.0e}"


def ends(axis: Axis) -> Axis:
    """The first and the last of the values that are listed."""
    few = tuple(dict.fromkeys((axis.listed[0], axis.listed[-1])))
    return replace(axis, values=few, listed=few)


def poles_off_axis(name: str, along: Axis) -> str:
    """Over all frequencies: poles of a fit elsewhere than on s <= 0, and how many there are."""
    if name not in FITS:
        return ""
    fit, digits = FITS[name]
    fits = [
        fit(*rational_fit.sampled(*case.given, digits)) for case in map(along.case, along.values)
    ]
    off, every = sum(each.poles_off_axis for each in fits), sum(len(each.poles) for each in fits)
    return f"{off} of {every}"


def summary(axes: Iterable[Axis], maps: dict[str, pd.DataFrame], names: list[str]) -> pd.DataFrame:
    """The worse of Rs and Cp of every way at some values of every axis."""
    table = pd.DataFrame({"way": names})
    for axis in axes:
        rows = maps[axis.label].assign(worst=lambda rows: rows[["Rs", "Cp"]].max(axis=1))
        worst = rows.pivot(index="way", columns="value", values="worst")
        for value in axis.listed:
            table[f"{axis.label} {value:g}"] = [listed(worst.loc[name, value]) for name in names]
    return table.assign(**{"poles off s <= 0": [poles_off_axis(name, axes[0]) for name in names]})


def main(run: Run) -> None:
    """Measure along every axis, publish and draw."""
    if not run.quick:
        ngspice_grid.ensure_ngspice()
    taking_part = ways(run)
    names = list(taking_part)
    axes = run.sized(AXES, tuple(map(ends, AXES)))
    maps = {axis.label: measured(axis, taking_part) for axis in axes}
    title = "Relative error, the worse of Rs and Cp"
    run.publish("stability", title, summary(axes, maps, names))
    draw(run.results / "stability.png", names, maps, WRONG)


if __name__ == "__main__":
    launch(main)
