"""One resistor and one capacitor: the low-frequency limit of any press on any skin.

Z(s) = 1/(s C) + R_lf + z_1 s + z_2 s² + ..., of which the first two terms are the model. Z is a sum
of poles on s <= 0 with residues >= 0, so the next terms bound the truncation error.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Complex, Integer, Real
from ..fem.error_estimate import ROUNDING, UNIFORM, relative_difference
from ..fem.galerkin import Galerkin
from ..fem.terminals import Excitation, allowed_potentials
from ..method_cache import cached_method
from ..press.press import Press
from ..scene.frequency import laplace_variable
from ..scene.parts import Skin
from ..sweeps import InputError, parallel_capacitance
from .model import DEFAULT_RTOL, Presses, UniformModel
from .sheet_model import SheetModel, UniformSheets
from .solution import Answer, ModelResult

GRIDS_KEPT = 256
LUMPED = "one R and one C"


@dataclass(frozen=True)
class Series:
    """Z(s) = 1/(s C) + R + first s + second s² + ... of one interface; F, ohm, ohm s, ohm s²."""

    C: float
    R: float
    first: float
    second: float


class OneRC:
    """One R and one C at each interface, of one mesh, with a bound on the truncation error."""

    def __init__(self, sheet: SheetModel, space: Galerkin | None = None) -> None:
        """space: space of the sheet that gives R and C, by default its finest one.

        `series` raises InputError if an interface is no capacitor at zero frequency.
        """
        self._skin, self._sheet, self._space = sheet.skin, sheet, space or sheet.space
        self._series: dict[Press, list[Series]] = {}

    def impedance(self, press: Press, frequency: Real) -> Complex:
        """Z in ohm, shape (interface, frequency); frequency in Hz."""
        s = laplace_variable(frequency, self._skin.foam.loss)
        return np.stack([1 / (s * term.C) + term.R for term in self.series(press)])

    def bounds(self, press: Press, frequency: Real) -> tuple[Real, Real]:
        """Bounds on the error of Rs in ohm and Cp in F, shapes (interface, frequency).

        They cover the truncation; the discretisation of R and C is not part of them.
        """
        s = laplace_variable(frequency, self._skin.foam.loss)
        Rs, Cp = zip(*(_bounds(term, s, frequency) for term in self.series(press)), strict=True)
        return np.stack(Rs), np.stack(Cp)

    def truncation_error(self, press: Press, frequency: Real) -> Real:
        """Bounds as fractions of Rs and Cp, shape (2, interface, frequency)."""
        Z = self.impedance(press, frequency)
        Rs, Cp = self.bounds(press, frequency)
        return np.stack([Rs / Z.real, Cp / parallel_capacitance(Z, frequency)])

    def series(self, press: Press) -> list[Series]:
        """Expansion at low frequency, one for each interface."""
        if press not in self._series:
            moments = self._space.moments(self._sheet.mass(press), 4)
            field, excitations = self._space.terminal_field, self._sheet.circuit.excitations
            self._series = {
                press: [_series(moments, field, excitation) for excitation in excitations]
            }
        return self._series[press]


class Lumped(UniformModel):
    """One R and one C, of elements.

    trial: True if it is tried only where it suffices for the unpressed skin.
    """

    name, seconds = "lumped", 2e-5

    def __init__(self, sheets: UniformSheets, trial: bool = False) -> None:
        self._sheets, self._trial = sheets, trial
        self.skin, self.setup = sheets.skin, sheets.setup

    def solve(self, press: Presses, frequency: Real, rtol: float = DEFAULT_RTOL) -> Answer:
        """See `Model`."""
        given, sheets = self._given(press, rtol), self._sheets
        uniform, progress = self._uniform(given), self._progress(given, frequency, rtol)
        unpressed = self._unpressed_error(tuple(frequency), rtol) if self._trial else 0.0
        if unpressed > rtol:
            progress.reject(
                f"{LUMPED}: error of the unpressed skin is {unpressed:.1e} of Rs or Cp or more"
            )
            return progress.answer()
        sheet = sheets.of(sheets.first(rtol), uniform, frequency[-1])
        lumped, finer = OneRC(sheet, sheet.nested), OneRC(sheet)
        Z = lumped.impedance(uniform, frequency)
        resolved = UNIFORM * relative_difference(Z, finer.impedance(uniform, frequency))
        error = resolved + lumped.truncation_error(uniform, frequency) + ROUNDING
        progress.offer(ModelResult(LUMPED, sheet.nested.inner, Z, error))
        return progress.answer()

    @cached_method(GRIDS_KEPT)
    def _unpressed_error(self, frequency: tuple[float, ...], rtol: float) -> float:
        """Largest relative error of Rs and Cp by one R and one C for the unpressed skin.

        If even the short line with the smallest error exceeds the tolerance, the skin is not
        solved.
        """
        least = min_truncation_error(self.skin, frequency[-1])
        if least > rtol:
            return least
        sheet = self._sheets.of(self._sheets.first(rtol), Press(), frequency[-1])
        left_out = OneRC(sheet, sheet.nested).truncation_error(Press(), np.array(frequency))
        return float(left_out.max())


def min_truncation_error(skin: Skin, frequency: float) -> float:
    """Lower bound of the relative error of Cp by one R and one C, at a frequency in Hz.

    It is the error of a skin fed at both ends of its shorter side: two lines of u = omega R c (side
    / 2)². Such a line has Cp = C (1 - 2 u² / 15), and R = R_line / 3 and C in series C (1 - u² /
    9).
    """
    u = 2 * (min(skin.sides) / 2 / skin.depth(frequency)) ** 2
    return min(1.0, u**2 / 45)


def _bounds(term: Series, s: Complex, frequency: Real) -> tuple[Real, Real]:
    """Next terms of the series, or the range of Rs in [0, R] and Cp in [0, C]."""
    size = np.abs(s)
    Z = 1 / (s * term.C) + term.R
    Rs_error = np.minimum(abs(term.first) * s.real + term.second * size**2, term.R)
    Z_error = abs(term.first) * size
    Y_error = np.divide(
        Z_error,
        np.abs(Z) * (np.abs(Z) - Z_error),
        out=np.full(size.shape, np.inf),
        where=np.abs(Z) > Z_error,
    )
    Cp = parallel_capacitance(Z, frequency)
    Cp_error = np.minimum(Y_error / (2 * np.pi * frequency), np.maximum(term.C - Cp, Cp))
    return Rs_error, Cp_error


def _series(moments: Real, field: Integer, excitation: Excitation) -> Series:
    modes, common = allowed_potentials(tuple(field.tolist()), excitation)
    if not common[0] or common[1:].any():
        raise InputError("the lumped model needs an interface between the two sheets, both driven")
    Y = modes.T @ moments @ modes
    y = _without_floating(Y)
    C = y[1]
    R = -y[2] / C**2
    first = (y[2] ** 2 / C - y[3]) / C**2
    second = (-(y[2] ** 3) / C**2 + 2 * y[2] * y[3] / C - y[4]) / C**2
    return Series(C, R, first, second)


def _without_floating(Y: Real) -> Real:
    """Coefficients of Y_00 - Y_0f Y_ff^-1 Y_f0 from those of Y, shape (power of s,)."""
    orders = len(Y)
    X = np.zeros((orders, Y.shape[1] - 1))
    for k in range(1, orders):
        known = Y[k, 1:, 0] - sum(Y[i, 1:, 1:] @ X[k - i] for i in range(1, k))
        X[k] = np.linalg.solve(Y[0, 1:, 1:], known)
    return np.array(
        [Y[k, 0, 0] - sum(Y[i, 0, 1:] @ X[k - i] for i in range(1, k)) for k in range(orders)]
    )
