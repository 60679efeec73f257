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
from ...simulator.scene.scene import Scene
from ...simulator.sweeps import parallel_capacitance

STATED_SHEET_RESISTANCE = 50e3
NEARLY_ZERO = 1e-3
SEPARATION_GRID = np.geomspace(100, 2e6, 60)


@dataclass(frozen=True)
class Totals:
    """A device fed along one edge as a line: loop resistance in ohm, capacitance in F."""

    R: float
    C: float


def totals(scene: Scene) -> Totals:
    """Both sheets in series from the left edge to the right, and the unpressed capacitance."""
    skin = scene.skin
    R = skin.both_sheets * skin.length / skin.width
    return Totals(R, skin.foam.unpressed_capacitance_per_area * (skin.length * skin.width))


def capacitance_changes(scene: Scene, frequency: float) -> Real:
    """Relative change of Cp by a press of each column of row 1, at one frequency in Hz."""
    solver = Solver(scene.parts)
    Cp = [
        parallel_capacitance(solver.solve(press, frequency).Z, np.array([frequency])).item()
        for press in [Press(), *_row_of_presses(scene, 1)]
    ]
    return np.array(Cp[1:]) / Cp[0] - 1


def unpressed_resistance(scene: Scene) -> float:
    """Rs in ohm of the first interface of the unpressed skin, in the limit of zero frequency."""
    answer = Solver(scene.parts).solve(Press(), NEARLY_ZERO)
    return float(answer.Z[0, 0].real)


def paper_frequencies(scene: Scene) -> Real:
    """f_i of Eq 6 in Hz for the end of each pixel, with the device's R and C, shape (column,)."""
    device, length = totals(scene), scene.skin.length
    ends = length * np.arange(1, scene.pixels.columns + 1) / scene.pixels.columns
    return interrogation_frequency(ends, device.R / length, device.C / length)


def open_line_frequencies(scene: Scene) -> Real:
    """Half-power frequency at the end of each pixel of the finite open line, Hz."""
    device, length = totals(scene), scene.skin.length
    R, C = device.R / length, device.C / length

    def excess(logarithm: float, x: float) -> float:
        return float(open_line_amplitude(np.exp(logarithm), x, length, R, C)) - HALF_POWER

    around = [
        (f, length * (i + 1) / scene.pixels.columns) for i, f in enumerate(paper_frequencies(scene))
    ]
    roots = [brentq(excess, np.log(f / 100), np.log(f * 100), args=(x,)) for f, x in around]
    return np.exp(np.array(roots, dtype=float))


def separation_peaks(scene: Scene) -> Real:
    """Frequencies in Hz where neighbouring columns differ most in Z, shape (column - 1,).

    The presses are in the middle row; differences are relative to Z.
    """
    solver = Solver(scene.parts)
    presses = _row_of_presses(scene, (scene.pixels.rows + 1) // 2)
    Z = np.log(np.array([solver.solve(press, SEPARATION_GRID).Z[0] for press in presses]))
    return SEPARATION_GRID[np.abs(np.diff(Z, axis=0)).argmax(axis=1)]


def low_frequency_resistances(scene: Scene) -> Real:
    """Rs in ohm of a line at 1 mHz: unpressed, then each pixel pressed; shape (1 + column,)."""
    line = Line(scene.parts.skin, scene.parts.setup, scene.press)
    presses = [Press(), *_row_of_presses(scene, 1)]
    return np.array([line.impedance(press, np.array([1e-3])).real.item() for press in presses])


def row_contrast(scene: Scene) -> float:
    """Largest relative difference of Z at the first interface between the outermost rows."""
    solver = Solver(scene.parts, rtol=1e-3)
    column, factor = (scene.pixels.columns + 1) // 2, scene.press.capacitance_factor
    first, last = (
        solver.solve(Press((Touch(row, column, factor),))).Z[0] for row in (1, scene.pixels.rows)
    )
    return float(np.abs(first / last - 1).max())


def _row_of_presses(scene: Scene, row: int) -> list[Press]:
    factor = scene.press.capacitance_factor
    return [Press((Touch(row, j + 1, factor),)) for j in range(scene.pixels.columns)]
