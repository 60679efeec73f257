"""Checks every spectrum against the laws of passive RC networks, given its noise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Complex, Mask, Real
from .errors import InputError
from .passivity import RESOLUTION, Violation, fit_passive, violations_of
from .reading_noise import NEIGHBOURS, Allowance, local_scale, repeatability, roughness, scaled_by
from .reading_quantities import contradicting
from .reading_subset import read_at
from .schema import DIMENSIONS, impedance

if TYPE_CHECKING:
    import xarray as xr


MIN_FREQUENCIES = 6
LAWS = 6
"""Number of laws that noise may appear to break."""
KRAMERS_KRONIG = "Kramers-Kronig"
CP_CONSISTENCY = "Cp = Im(1/Z)/omega"
DISPLAY_ROUNDING = 1e-3
"""Tolerance of Cp over |1/Z|/omega: the rounding of a display with four digits."""
TOLERANCE = 0.02
NO_PROFILES: Mapping[str, Real] = MappingProxyType({})


@dataclass(frozen=True)
class Spectrum:
    """One sweep at one interface, compared with the nearest passive network.

    Z: ohm. frequency: Hz. residual: (Z - network)/|Z|. inductive: mask of the readings with Im Z >
    0 up to the highest frequency; the fit ignores them. inductance: of the network, H. parameters:
    number of terms of the network. Arrays have the shape (frequency,).
    """

    Z: Complex
    frequency: Real
    residual: Complex
    inductive: Mask
    inductance: float
    parameters: int

    @property
    def misfit(self) -> float:
        """Root mean square of the residual where the network was fitted."""
        return float(np.sqrt(np.mean(np.abs(self.residual[~self.inductive]) ** 2)))


@dataclass(frozen=True)
class Verdict:
    """Result of the check of one sweep at one interface.

    phase: lowest and highest, degrees. noise: standard deviation of Re Z and of Im Z over |Z|,
    shape (frequency,). noise_from: `given`, `repeats` or `fit`. allowed: largest absolute real and
    imaginary part of the residual, shape (frequency,); Kramers-Kronig is broken exactly where
    either exceeds it.
    """

    sweep: int
    interface: str
    press: str
    spectrum: Spectrum
    phase: tuple[float, float]
    noise: Real
    noise_from: str
    allowed: Real
    broken: tuple[Violation, ...]


@dataclass(frozen=True)
class _Limits:
    """Relative noise and spread of the residuals, both (frequency,), and the limits from them."""

    noise: Real
    spread: Real
    limit: float
    tolerance: float
    origin: str


def examine(
    sweeps: xr.Dataset,
    noise: float | None = None,
    tolerance: float = TOLERANCE,
    *,
    two_terminal: bool = True,
    profiles: Mapping[str, Real] = NO_PROFILES,
) -> list[Verdict]:
    """Checks every spectrum of the sweeps.

    two_terminal: True if all current that enters the skin leaves it through the meter; otherwise Z
    is a transfer impedance, no law of passive networks applies, and each reading is checked alone.
    noise: relative standard deviation of a reading, if known; otherwise it is estimated from
    repeated sweeps of one press, or from the residuals. tolerance: largest rms residual of the
    Kramers-Kronig fit. profiles: noise at the frequencies of an interface up to a factor, > 0, by
    name of the interface; an estimate of noise follows it. Raises InputError if `noise` or
    `tolerance` is out of range, or if there are too few frequencies to distinguish noise from a
    broken law.
    """
    names = [str(name) for name in sweeps["interface"].values]
    parts = {name: read_at(sweeps, name) for name in names}
    check_limits(noise, tolerance, min(part.sizes["frequency"] for part in parts.values()))
    readings = sum(part["Rs"].size for part in parts.values())
    return [
        judgement
        for name, part in parts.items()
        for judgement in _examine_interface(
            part, name, noise, tolerance, readings, two_terminal, profiles.get(name)
        )
    ]


def with_faults(verdict: Verdict, faults: Sequence[Violation]) -> Verdict:
    """The verdict with those of the faults that are of its sweep and interface."""
    place = verdict.sweep, verdict.interface
    own = [each for each in faults if (each.sweep, each.interface) == place]
    return replace(verdict, broken=(*verdict.broken, *own))


def check_limits(noise: float | None, tolerance: float, frequencies: int) -> None:
    """Raises InputError for values out of range, and for too few frequencies."""
    for name, value in (("noise", noise), ("tolerance", tolerance)):
        if value is not None and not (np.isfinite(value) and value > 0):
            raise InputError(f"`{name}` must be finite and > 0, got {value}")
    if noise is None and frequencies < MIN_FREQUENCIES:
        raise InputError(
            f"noise cannot be estimated from {frequencies} frequencies: at least "
            f"{MIN_FREQUENCIES} are needed; give the relative noise of a reading by --noise "
            "(0.001 is 0.1 %)"
        )


def _examine_interface(
    sweeps: xr.Dataset,
    name: str,
    noise: float | None,
    tolerance: float,
    readings: int,
    two_terminal: bool,
    profile: Real | None,
) -> list[Verdict]:
    Z, frequency = impedance(sweeps)[:, 0], sweeps["frequency"].values
    Cp = sweeps["Cp"].transpose(*DIMENSIONS).values[:, 0]
    if not np.abs(Z).all():
        raise InputError(f"interface {name}: Z is 0 ohm at some frequency, which no reading is")
    groups = list(zip(sweeps["press"].values, sweeps["session"].values, strict=True))
    spectra = [fitted_spectrum(each, frequency, _inductive_end(each)) for each in Z]
    limits = _limits(spectra, groups, noise, tolerance, readings, profile)
    spectra = [_without_chance_sign(each, limits) for each in spectra]
    return [
        Verdict(
            sweep,
            name,
            str(sweeps["press"].values[sweep]),
            spectrum,
            _range(np.degrees(np.angle(spectrum.Z))),
            limits.noise,
            limits.origin,
            _allowed(spectrum, limits),
            _violations(sweep, name, spectrum, limits, Cp[sweep], two_terminal),
        )
        for sweep, spectrum in enumerate(spectra)
    ]


def fitted_spectrum(Z: Complex, frequency: Real, inductive: Mask) -> Spectrum:
    """Fits the nearest passive network to the part of the spectrum that is not inductive."""
    if (~inductive).sum() < MIN_FREQUENCIES:
        inductive = np.zeros_like(inductive)
    network = fit_passive(Z[~inductive], frequency[~inductive])
    residual = network.residual(Z, frequency)
    return Spectrum(Z, frequency, residual, inductive, network.inductance, network.parameters)


def _inductive_end(Z: Complex) -> Mask:
    """Mask of the readings with Im Z > 0 without interruption up to the highest frequency."""
    return np.logical_and.accumulate((Z.imag > 0)[::-1])[::-1]


def _without_chance_sign(spectrum: Spectrum, limits: _Limits) -> Spectrum:
    """Refits all readings if noise alone can explain the positive sign of the highest ones."""
    slack = limits.limit * limits.noise * np.abs(spectrum.Z)
    beyond_noise = spectrum.Z.imag > slack
    if not spectrum.inductive.any() or (spectrum.inductive & beyond_noise).any():
        return spectrum
    return fitted_spectrum(spectrum.Z, spectrum.frequency, np.zeros_like(spectrum.inductive))


def _limits(
    spectra: list[Spectrum],
    groups: list[tuple[str, int]],
    noise: float | None,
    tolerance: float,
    readings: int,
    profile: Real | None,
) -> _Limits:
    points = spectra[0].frequency.size
    tests = 2 * LAWS * readings
    if noise is not None:
        known = np.full(points, max(noise, RESOLUTION))
        return _Limits(known, known, Allowance(tests, np.inf).limit, tolerance, "given")
    residuals = np.array([_unbiased_residual(each) for each in spectra])
    repeated = repeatability(np.array([each.Z for each in spectra]), groups, profile)
    rough = scaled_by(roughness, residuals, profile) if repeated is None else repeated
    observed = np.maximum(rough, RESOLUTION)
    limit = Allowance(tests, 2 * len(spectra) * min(points, NEIGHBOURS)).limit
    spread = np.maximum(scaled_by(local_scale, residuals, profile), observed)
    return _Limits(observed, spread, limit, tolerance, "fit" if repeated is None else "repeats")


def _unbiased_residual(spectrum: Spectrum) -> Complex:
    """Residual, corrected for the fit's degrees of freedom; NaN where not fitted."""
    values = 2 * (~spectrum.inductive).sum()
    freedom = max(values - spectrum.parameters, 1)
    residual = spectrum.residual * np.sqrt(values / freedom)
    residual[spectrum.inductive] = np.nan + 1j * np.nan
    return residual


def _violations(
    sweep: int, interface: str, spectrum: Spectrum, limits: _Limits, Cp: Real, two_terminal: bool
) -> tuple[Violation, ...]:
    """Violated laws. Cp: stored with Rs and X, F, (frequency,). two_terminal: as in `examine`."""
    laws = {}
    if two_terminal:
        laws = _signs(spectrum, limits) | _monotony(spectrum, limits)
        laws[KRAMERS_KRONIG] = _inconsistent(spectrum, limits)
    slack = DISPLAY_ROUNDING + limits.limit * limits.noise
    Z, frequency = spectrum.Z, spectrum.frequency
    laws[CP_CONSISTENCY] = contradicting(Z.real, Z.imag, Cp, frequency, slack)
    return violations_of(sweep, interface, frequency, laws)


def _signs(spectrum: Spectrum, limits: _Limits) -> dict[str, Mask]:
    slack = limits.limit * limits.noise * np.abs(spectrum.Z)
    return {
        "Re Z >= 0": spectrum.Z.real < -slack,
        "Im Z <= 0": (spectrum.Z.imag > slack) | spectrum.inductive,
    }


def _monotony(spectrum: Spectrum, limits: _Limits) -> dict[str, Mask]:
    """Monotony of Rs, Cp and Cs below the inductive end, after removing the series inductance."""
    kept, omega = ~spectrum.inductive, 2 * np.pi * spectrum.frequency
    Z = spectrum.Z - 1j * omega * (spectrum.inductance if spectrum.inductive.any() else 0.0)
    error = limits.limit * limits.noise * np.abs(spectrum.Z)
    slope = {
        "Rs not increasing": (Z.real, error),
        "Cp not increasing": ((1 / Z).imag / omega, error / np.abs(Z) ** 2 / omega),
        "Cs not increasing": (omega * Z.imag, omega * error),
    }
    broken = {law: np.zeros(kept.shape, dtype=np.bool_) for law in slope}
    for law, (values, allowed) in slope.items():
        broken[law][kept] = deviates_from_decreasing(values[kept], allowed[kept])
    return broken


def deviates_from_decreasing(values: Real, allowed: Real) -> Mask:
    """True where values deviate by more than allowed from the nearest non-increasing curve."""
    from scipy.optimize import isotonic_regression

    weights = (allowed.min() / allowed) ** 2
    nearest = isotonic_regression(values, weights=weights, increasing=False).x
    return np.abs(values - nearest) > allowed


def _allowed(spectrum: Spectrum, limits: _Limits) -> Real:
    """Largest absolute real or imaginary part of the residual.

    It is the limit by chance of a single reading. If the whole misfit exceeds the tolerance, the
    tolerance limits it as well, divided between both parts so that some reading always exceeds it.
    """
    by_chance = limits.limit * limits.spread
    if spectrum.misfit <= limits.tolerance:
        return by_chance
    return np.minimum(by_chance, limits.tolerance / np.sqrt(2))


def _inconsistent(spectrum: Spectrum, limits: _Limits) -> Mask:
    """True for readings that deviate from the nearest passive network by more than allowed."""
    largest = np.maximum(np.abs(spectrum.residual.real), np.abs(spectrum.residual.imag))
    return (largest > _allowed(spectrum, limits)) & ~spectrum.inductive


def _range(values: Real) -> tuple[float, float]:
    return float(values.min()), float(values.max())
