"""Laws of passive RC networks, which hold for any press, and a fit of the nearest such network.

Every linear, causal and stable system obeys the Kramers-Kronig relations, and so does every sum of
such networks. A fit by such a sum therefore tests the data: no network explains what it cannot
follow (P. Agarwal, M. E. Orazem, L. H. Garcia-Rubio, J. Electrochem. Soc. 139, 1917, 1992;
B. A. Boukamp, J. Electrochem. Soc. 142, 1885, 1995). Residues >= 0 make the network passive too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Complex, Mask, Real
from .errors import ToleranceError
from .reading_quantities import parallel_capacitance, series_capacitance
from .schema import impedance

if TYPE_CHECKING:
    import xarray as xr


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


INDUCTANCE = 1
"""Place of L among the terms of a network."""
PER_DECADE = 20
MARGIN = 100.0
"""Factor by which the time constants extend beyond those of the lowest and highest frequency."""
REFINEMENT = 8
"""Number of parts of each grid step next to a pole in the second fit."""
RESOLUTION = 3e-5
"""Relative error of Z by the grid of time constants, for an exact spectrum."""


@dataclass(frozen=True)
class MeasurementModel:
    """Z(s) = R + s L + 1/(s C) + sum of r/(1 + s tau), every term >= 0.

    resistance: ohm. inductance: H. elastance: 1/C in 1/F. residues: ohm, one for each of `tau`.
    tau: s, ascending.
    """

    resistance: float
    inductance: float
    elastance: float
    residues: Real
    tau: Real

    @property
    def parameters(self) -> int:
        """Number of non-zero terms."""
        terms = [self.resistance, self.inductance, self.elastance, *self.residues]
        return int(np.count_nonzero(terms))

    def impedance(self, frequency: Real) -> Complex:
        """Z in ohm. frequency: Hz."""
        terms = [self.resistance, self.inductance, self.elastance, *self.residues]
        return _basis(frequency, self.tau) @ np.array(terms)

    def residual(self, Z: Complex, frequency: Real) -> Complex:
        """(Z - model)/|Z|. Z: ohm. frequency: Hz."""
        return (Z - self.impedance(frequency)) / np.abs(Z)


def fit_passive(Z: Complex, frequency: Real) -> MeasurementModel:
    """The passive network nearest to a spectrum, by least squares of the relative error of Z.

    Z: ohm, nowhere 0, shape (frequency,). frequency: Hz, ascending.
    Raises ToleranceError if the least squares do not converge.
    """
    coarse = _time_constants(frequency)
    poles = _fit_on(coarse, Z, frequency).residues > 0
    return _fit_on(_refined(coarse, poles), Z, frequency)


def distance_from_rc(Z: Complex, frequency: Real) -> float:
    """Root mean square relative distance of Z from the nearest passive RC network, to about 1e-4.

    Inductance is left out, which would hide that a spectrum is not causal. Z, frequency, errors: as
    for `fit_passive`.
    """
    network = _fit_on(_time_constants(frequency), Z, frequency, inductive=False)
    return float(np.sqrt(np.mean(np.abs(network.residual(Z, frequency)) ** 2)))


def _fit_on(tau: Real, Z: Complex, frequency: Real, *, inductive: bool = True) -> MeasurementModel:
    from scipy.optimize import nnls

    relative = _basis(frequency, tau) / np.abs(Z)[:, None]
    relative[:, INDUCTANCE] *= inductive
    columns, wanted = _stacked(relative), _stacked(Z / np.abs(Z))
    lengths = np.maximum(np.linalg.norm(columns, axis=0), np.finfo(float).tiny)
    try:
        scaled, _ = nnls(columns / lengths, wanted)
    except RuntimeError as error:
        raise ToleranceError(f"the nearest passive network was not found: {error}") from error
    resistance, inductance, elastance, *residues = (scaled / lengths).tolist()
    return MeasurementModel(resistance, inductance, elastance, np.array(residues), tau)


def _time_constants(frequency: Real) -> Real:
    shortest = 1 / (2 * np.pi * frequency[-1] * MARGIN)
    longest = MARGIN / (2 * np.pi * frequency[0])
    points = 1 + int(np.ceil(PER_DECADE * np.log10(longest / shortest)))
    return np.geomspace(shortest, longest, points)


def _refined(tau: Real, poles: Mask) -> Real:
    """The grid with additional points around every pole, up to its neighbours."""
    fractions = np.arange(1 - REFINEMENT, REFINEMENT) / REFINEMENT
    around = tau[poles, None] * (tau[1] / tau[0]) ** fractions
    return np.unique(np.concatenate([tau[~poles], around.ravel()]))


def _basis(frequency: Real, tau: Real) -> Complex:
    """R, L, 1/C and every pole at unit strength; shape (frequency, 3 + tau)."""
    s = 2j * np.pi * frequency[:, None]
    return np.hstack([np.ones_like(s), s, 1 / s, 1 / (1 + s * tau)]).astype(np.complex128)


def _stacked(values: Complex) -> Real:
    return np.concatenate([values.real, values.imag])
