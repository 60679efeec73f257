"""Where each way to Rs and Cp keeps its digits and where it loses them: a measured map.

True errors over dimensionless frequency, contact length, contrast of the sheets and pixel count.

Run: python benchmarks/accuracy/stability.py [--quick]
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.stability_parts.cases import AXES, Axis, Case
from rcskin.benchmarks.accuracy.stability_parts.map import FAILED, REFUSED, draw
from rcskin.benchmarks.bench import Run, launch, publish
from rcskin.benchmarks.rivals import (
    admittance_then_inverse,
    deviation_form,
    lumped_ladder,
    naive_flux,
    ngspice_grid,
    packaged_line,
    rational_fit,
    scikit_fem_script,
    single_precision,
)
from rcskin.benchmarks.rivals.scikit_fem_script import Elements
from rcskin.simulator.models.solver import ModelName, Solver
from rcskin.simulator.sweeps import ToleranceError, parallel_capacitance

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
    "Q1, slope at the foil": lambda case: naive_flux.impedance(*case.given, case.cells),
    "Q1, current Y of the foil, 1/Y": lambda case: admittance_then_inverse.impedance(
        *case.given, case.cells
    ),
    "Q1, deviation form": lambda case: deviation_form.impedance(*case.given, case.cells),
    "Q1, cells across pixel edges": lambda case: deviation_form.impedance(*case.given, case.askew),
    "Q1, single precision": lambda case: single_precision.impedance(*case.given, case.cells),
    "Q4, scikit-fem script": lambda case: scikit_fem_script.impedance(*case.given, Elements(4, 2)),
    "ngspice, grid of R and C": lambda case: ngspice_grid.impedance(*case.given, case.cells),
    "ladder of R and C": for_lines(
        lambda case: lumped_ladder.impedance(*case.given, case.cells.along)
    ),
    "scikit-rf, cascaded lines": for_lines(lambda case: packaged_line.impedance(*case.given)),
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
    publish(run.results, "stability", title, summary(axes, maps, names))
    draw(run.results / "stability.png", names, maps, WRONG)


if __name__ == "__main__":
    launch(main)
