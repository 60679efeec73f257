"""Fitting a few physical parameters to a measured sweep."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from simulator.frequency import laplace_variable
from simulator.line import tanh_ratio
from simulator.sweeps import InputError

STARTS = 5


@dataclass(frozen=True)
class LineFit:
    """An open RC line behind a series inductance and resistance.

    inductance: H. resistance: ohm. line_resistance: ohm, of the whole line. line_capacitance: F
    (F s^(exponent - 1) where the exponent is not 1), of the whole line. exponent: of the
    constant-phase capacitance, 1 for an ideal one. rms_error: of Z, relative to |Z|.
    """

    inductance: float
    resistance: float
    line_resistance: float
    line_capacitance: float
    exponent: float
    rms_error: float

    def impedance(self, frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Z in ohm: s L + R_s + R coth(q)/q with q² = R C s^a. frequency: Hz."""
        s = laplace_variable(frequency)
        charging = (self.line_capacitance * s**self.exponent).astype(np.complex128)
        line = 1 / (charging * tanh_ratio(self.line_resistance * charging))
        return s * self.inductance + self.resistance + line


def fit_line(
    Z: NDArray[np.complex128], frequency: NDArray[np.float64], constant_phase: bool = False
) -> LineFit:
    """The line that fits a sweep best, in the sense of least relative error of Z.

    Z: ohm, shape (frequency,). frequency: Hz. constant_phase: whether the line's capacitance may be
    a constant-phase element.
    Raises InputError where there are fewer readings than twice the parameters.
    """
    parameters = 5 if constant_phase else 4
    if frequency.size < 2 * parameters:
        raise InputError(f"a fit needs at least {2 * parameters} frequencies, got {frequency.size}")

    def residuals(logarithms: NDArray[np.float64]) -> NDArray[np.float64]:
        deviation = _fitted(logarithms).impedance(frequency) / Z - 1
        return np.concatenate([deviation.real, deviation.imag])

    fits = [
        least_squares(residuals, start, bounds=_bounds(start), x_scale="jac", max_nfev=2000)
        for start in _starts(Z, frequency, constant_phase)
    ]
    best = min(fits, key=lambda fit: float(fit.cost))
    return _fitted(best.x, float(np.sqrt(2 * best.cost / frequency.size)))


def _fitted(logarithms: NDArray[np.float64], rms_error: float = np.nan) -> LineFit:
    inductance, resistance, line_resistance, line_capacitance = np.exp(logarithms[:4])
    exponent = float(logarithms[4]) if logarithms.size > 4 else 1.0
    return LineFit(
        float(inductance),
        float(resistance),
        float(line_resistance),
        float(line_capacitance),
        exponent,
        rms_error,
    )


def _bounds(start: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A factor of 1e9 either way, and exponents from a diffusive 0.5 to an ideal 1."""
    decades = np.log(1e9)
    low, high = start - decades, start + decades
    low[4:], high[4:] = 0.5, 1.0
    return low, high


def _starts(
    Z: NDArray[np.complex128], frequency: NDArray[np.float64], constant_phase: bool
) -> list[NDArray[np.float64]]:
    """Points to start from: the line's share of the resistance from little to all of it."""
    omega = 2 * np.pi * frequency
    lowest, highest = np.argmin(omega), np.argmax(omega)
    capacitance = -1 / (omega[lowest] * Z.imag[lowest])
    inductance = max(
        float(Z.imag[highest] / omega[highest]), 1e-4 * abs(Z[highest]) / omega[highest]
    )
    total, floor = float(Z.real.max()), float(np.abs(Z.real).min())
    return [
        np.array(
            [
                np.log(inductance),
                np.log(floor),
                np.log(3 * total * share),
                np.log(abs(capacitance)),
                *([0.95] if constant_phase else []),
            ]
        )
        for share in np.geomspace(0.03, 1, STARTS)
    ]
