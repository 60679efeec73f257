"""Laws of passive RC networks, which hold for any press on any RC sheet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..reading_quantities import parallel_capacitance, series_capacitance
from ..schema import impedance

if TYPE_CHECKING:
    import xarray as xr

    from ...arrays import Complex, Mask, Real


@dataclass(frozen=True)
class Violation:
    """One law broken by one sweep at some frequencies, Hz. text: a sentence that says so."""

    sweep: int
    interface: str
    law: str
    frequency: tuple[float, ...]
    text: str = ""

    def __str__(self) -> str:
        where = f"sweep {self.sweep}, interface {self.interface}"
        broken = f"{self.law} is broken at {frequencies_text(self.frequency)}"
        return f"{where}: {self.text or broken}"


def violations_of(
    sweep: int, interface: str, frequency: Real, laws: Mapping[str, Mask]
) -> tuple[Violation, ...]:
    """The laws that one spectrum breaks. laws: masks of the frequencies [Hz] at which, by name."""
    return tuple(
        Violation(sweep, interface, law, tuple(frequency[broken].tolist()))
        for law, broken in laws.items()
        if broken.any()
    )


def frequencies_text(frequency: Sequence[float] | Real) -> str:
    """Frequencies [Hz] in words: a single one, or their number and range."""
    low, high = min(frequency), max(frequency)
    if len(frequency) == 1:
        return f"{low:.6g} Hz"
    return f"{len(frequency)} frequencies from {low:.6g} to {high:.6g} Hz"


@dataclass(frozen=True)
class ErrorBounds:
    """Error bounds at each frequency: relative error of |Z|, and error of the phase in rad."""

    size: Real
    phase: Real

    def times(self, factor: float) -> ErrorBounds:
        """The bounds multiplied by a factor."""
        return ErrorBounds(factor * self.size, factor * self.phase)


def violations(sweeps: xr.Dataset, tolerance: float | ErrorBounds = 1e-9) -> list[Violation]:
    """All violations of the laws of passive RC networks in the sweeps.

    Poles on s <= 0 with residues >= 0 (a Foster form) imply: the phase stays within [-90, 0]
    degrees, and Rs, Cp and Cs do not increase with frequency. A break means error in the data, or
    inductance, which an RC network cannot have.

    tolerance: allowance for a meter's noise and rounding: a relative value for all quantities, or
    error bounds for each reading.
    """
    frequency = sweeps["frequency"].values
    return [
        violation
        for sweep, by_interface in enumerate(impedance(sweeps))
        for name, Z in zip(sweeps["interface"].values, by_interface, strict=True)
        for violation in violations_of(
            sweep, str(name), frequency, broken_laws(Z, frequency, tolerance)
        )
    ]


def broken_laws(
    Z: Complex, frequency: Real, tolerance: float | ErrorBounds = 1e-9
) -> dict[str, Mask]:
    """The laws that one spectrum breaks, with a mask of the frequencies; see `violations`."""
    masks = _broken_masks(Z, frequency, tolerance).items()
    return {law: broken for law, broken in masks if broken.any()}


def _broken_masks(Z: Complex, frequency: Real, tolerance: float | ErrorBounds) -> dict[str, Mask]:
    capacitive = Z.imag < 0
    Cs = np.full(frequency.shape, np.nan)
    Cs[capacitive] = series_capacitance(Z[capacitive], frequency[capacitive])
    Cp = parallel_capacitance(Z, frequency)
    of_Rs, of_X, of_Cp, of_Cs = _slacks(Z, Cp, Cs, tolerance)
    return {
        "Re Z >= 0": Z.real < -of_Rs,
        "Im Z <= 0": Z.imag > of_X,
        "Rs not increasing": _increases(Z.real, of_Rs),
        "Cp not increasing": _increases(Cp, of_Cp),
        "Cs not increasing": _increases(Cs, of_Cs),
    }


def _slacks(Z: Complex, Cp: Real, Cs: Real, tolerance: float | ErrorBounds) -> tuple[Real, ...]:
    """Tolerances of Rs and X in ohm, Cp and Cs in F, at each frequency.

    With bounds s of ln|Z| and p of the phase, Rs = Re Z is off by at most s |Rs| + p |X| and X by
    s |X| + p |Rs|; the relative errors of Cp ~ X / |Z|^2 and Cs ~ 1 / X are at most s + p |Rs / X|.
    """
    if not isinstance(tolerance, ErrorBounds):
        return tolerance * np.abs(Z), tolerance * np.abs(Z), tolerance * abs(Cp), tolerance * Cs
    Rs, X = np.abs(Z.real), np.abs(Z.imag)
    s, p = tolerance.size, tolerance.phase
    part = s + p * Rs / np.maximum(X, np.finfo(float).tiny)
    return s * Rs + p * X, s * X + p * Rs, part * np.abs(Cp), part * Cs


def _increases(values: Real, slack: Real) -> Mask:
    return np.append(False, np.diff(values) > (slack[1:] + slack[:-1]) / 2)
