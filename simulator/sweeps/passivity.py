"""Does a sweep look like a passive RC network? Laws that hold for any press on any RC sheet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .impedance import parallel_capacitance, series_capacitance
from .schema import impedance

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Violation:
    """One law broken by one sweep at some frequencies."""

    sweep: int
    interface: str
    law: str
    frequency: tuple[float, ...]

    def __str__(self) -> str:
        where = f"sweep {self.sweep}, interface {self.interface}"
        return f"{where}: {self.law} is broken at {listed(self.frequency)}"


def listed(frequency: Sequence[float] | NDArray[np.float64]) -> str:
    """Frequencies in Hz in words: the one, or how many and from where to where."""
    low, high = min(frequency), max(frequency)
    if len(frequency) == 1:
        return f"{low:.6g} Hz"
    return f"{len(frequency)} frequencies from {low:.6g} to {high:.6g} Hz"


def violations(sweeps: xr.Dataset, tolerance: float = 1e-9) -> list[Violation]:
    """Every law of passive RC networks that the sweeps break, worst case by case.

    Poles on s <= 0 with residues >= 0 (a Foster form) imply: the phase stays within [-90, 0]
    degrees, and Rs, Cp and Cs do not increase with frequency. A break means error in the data, or
    inductance, which an RC network cannot have.

    tolerance: relative slack, for what a meter's noise and rounding may do.
    """
    frequency = sweeps["frequency"].values
    return [
        Violation(sweep, str(name), law, tuple(float(f) for f in frequency[broken]))
        for sweep, by_interface in enumerate(impedance(sweeps))
        for name, Z in zip(sweeps["interface"].values, by_interface, strict=True)
        for law, broken in _broken_laws(Z, frequency, tolerance).items()
        if broken.any()
    ]


def _broken_laws(
    Z: NDArray[np.complex128], frequency: NDArray[np.float64], tolerance: float
) -> dict[str, NDArray[np.bool_]]:
    slack = tolerance * np.abs(Z)
    capacitive = Z.imag < 0
    Cs = np.full(frequency.shape, np.nan)
    Cs[capacitive] = series_capacitance(Z[capacitive], frequency[capacitive])
    return {
        "Re Z >= 0": Z.real < -slack,
        "Im Z <= 0": Z.imag > slack,
        "Rs not increasing": _increases(Z.real, tolerance),
        "Cp not increasing": _increases(parallel_capacitance(Z, frequency), tolerance),
        "Cs not increasing": _increases(Cs, tolerance),
    }


def _increases(values: NDArray[np.float64], tolerance: float) -> NDArray[np.bool_]:
    step = np.diff(values)
    return np.append(False, step > tolerance * np.abs(values[1:]))
