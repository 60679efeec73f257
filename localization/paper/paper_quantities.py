"""Quantities that follow from the paper's statements of resistance, contacts and cut-offs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from ...simulator.arrays import Real
from ...simulator.models.line import HALF_POWER, Line, interrogation_frequency, open_line_amplitude
from ...simulator.models.solver import Solver
from ...simulator.press.press import Press
from ...simulator.press.touch import Touch
from ...simulator.scene.parts import Pressing, SceneParts, Setup, Skin
from ...simulator.sweeps import parallel_capacitance

STATED_SHEET_RESISTANCE = 50e3
NEARLY_ZERO = 1e-3
SEPARATION_GRID = np.geomspace(100, 2e6, 60)


@dataclass(frozen=True)
class Totals:
    """A device fed along one edge as a line: loop resistance in ohm, capacitance in F."""

    R: float
    C: float


def totals(skin: Skin) -> Totals:
    """Both sheets in series from the left edge to the right, and the unpressed capacitance."""
    R = skin.both_sheets * skin.length / skin.width
    return Totals(R, skin.foam.unpressed_capacitance_per_area * (skin.length * skin.width))


def capacitance_changes(parts: SceneParts, frequency: float) -> Real:
    """Relative change of Cp by a press of each column of row 1, at one frequency in Hz."""
    solver = Solver(parts)
    Cp = [
        parallel_capacitance(solver.solve(press, frequency).Z, np.array([frequency])).item()
        for press in [Press(), *_row_of_presses(parts.skin, parts.plan.press, 1)]
    ]
    return np.array(Cp[1:]) / Cp[0] - 1


def unpressed_resistance(parts: SceneParts) -> float:
    """Rs in ohm of the first interface of the unpressed skin, in the limit of zero frequency."""
    answer = Solver(parts).solve(Press(), NEARLY_ZERO)
    return float(answer.Z[0, 0].real)


def paper_frequencies(skin: Skin) -> Real:
    """f_i of Eq 6 in Hz for the end of each pixel, with the device's R and C, shape (column,)."""
    device, length = totals(skin), skin.length
    ends = length * np.arange(1, skin.pixels.columns + 1) / skin.pixels.columns
    return interrogation_frequency(ends, device.R / length, device.C / length)


def open_line_frequencies(skin: Skin) -> Real:
    """Half-power frequency at the end of each pixel of the finite open line, Hz."""
    device, length = totals(skin), skin.length
    R, C = device.R / length, device.C / length

    def excess(logarithm: float, x: float) -> float:
        return float(open_line_amplitude(np.exp(logarithm), x, length, R, C)) - HALF_POWER

    around = [
        (f, length * (i + 1) / skin.pixels.columns) for i, f in enumerate(paper_frequencies(skin))
    ]
    roots = [brentq(excess, np.log(f / 100), np.log(f * 100), args=(x,)) for f, x in around]
    return np.exp(np.array(roots, dtype=float))


def separation_peaks(parts: SceneParts) -> Real:
    """Frequencies in Hz where neighbouring columns differ most in Z, shape (column - 1,).

    The presses are in the middle row; differences are relative to Z.
    """
    solver = Solver(parts)
    presses = _row_of_presses(parts.skin, parts.plan.press, (parts.skin.pixels.rows + 1) // 2)
    Z = np.log(np.array([solver.solve(press, SEPARATION_GRID).Z[0] for press in presses]))
    return SEPARATION_GRID[np.abs(np.diff(Z, axis=0)).argmax(axis=1)]


def low_frequency_resistances(skin: Skin, setup: Setup, pressing: Pressing) -> Real:
    """Rs in ohm of a line at 1 mHz: unpressed, then each pixel pressed; shape (1 + column,)."""
    line = Line(skin, setup)
    presses = [Press(), *_row_of_presses(skin, pressing, 1)]
    return np.array([line.solve(press, np.array([1e-3])).Z.real.item() for press in presses])


def row_contrast(parts: SceneParts) -> float:
    """Largest relative difference of Z at the first interface between the outermost rows."""
    solver = Solver(parts, rtol=1e-3)
    column, factor = (parts.skin.pixels.columns + 1) // 2, parts.plan.press.capacitance_factor
    first, last = (
        solver.solve(Press((Touch(row, column, factor),))).Z[0]
        for row in (1, parts.skin.pixels.rows)
    )
    return float(np.abs(first / last - 1).max())


def _row_of_presses(skin: Skin, pressing: Pressing, row: int) -> list[Press]:
    factor = pressing.capacitance_factor
    return [Press((Touch(row, j + 1, factor),)) for j in range(skin.pixels.columns)]
