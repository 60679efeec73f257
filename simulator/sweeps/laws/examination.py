"""Is a sweep to be trusted? Every spectrum against the laws of RC networks and its noise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..impedance import contradicting
from ..schema import DIMENSIONS, impedance, read_at
from .kramers_kronig import RESOLUTION, fit_passive
from .noise import NEIGHBOURS, Allowance, local_scale, repeatability, roughness
from .passivity import Violation

if TYPE_CHECKING:
    import xarray as xr

FEWEST_FREQUENCIES = 6
LAWS = 6
"""That noise may break."""
KRAMERS_KRONIG = "Kramers-Kronig"
OF_ONE_READING = "Cp = Im(1/Z)/omega"
DISPLAYED = 1e-3
"""Of |1/Z|/omega: what a display of four digits leaves open of Cp beside Rs and X."""
TOLERANCE = 0.02


@dataclass(frozen=True)
class Spectrum:
    """One sweep at one interface beside the nearest passive network.

    Z: ohm. frequency: Hz. residual: (Z - network)/|Z|. inductive: where Im Z > 0 up to the highest
    frequency; those readings took no part in the fit. inductance: H, of the network. parameters:
    terms of the network. All arrays of shape (frequency,).
    """

    Z: NDArray[np.complex128]
    frequency: NDArray[np.float64]
    residual: NDArray[np.complex128]
    inductive: NDArray[np.bool_]
    inductance: float
    parameters: int

    @property
    def misfit(self) -> float:
        """Root mean square of the residual where the network was fitted."""
        return float(np.sqrt(np.mean(np.abs(self.residual[~self.inductive]) ** 2)))


@dataclass(frozen=True)
class Verdict:
    """What was found of one sweep at one interface.

    phase: lowest and highest, degrees. noise: standard deviation of Re Z and of Im Z over |Z|,
    shape (frequency,). noise_from: `given`, `repeats` or `fit`. allowed: how far the real and the
    imaginary part of the residual may be from 0; Kramers-Kronig is broken where either is further,
    and nowhere else. Shape (frequency,).
    """

    sweep: int
    interface: str
    press: str
    spectrum: Spectrum
    phase: tuple[float, float]
    noise: NDArray[np.float64]
    noise_from: str
    allowed: NDArray[np.float64]
    broken: tuple[Violation, ...]


@dataclass(frozen=True)
class _Yardstick:
    """Relative noise, the spread of the residuals, both (frequency,), and what they allow."""

    noise: NDArray[np.float64]
    spread: NDArray[np.float64]
    limit: float
    tolerance: float
    origin: str


def examine(
    sweeps: xr.Dataset,
    noise: float | None = None,
    tolerance: float = TOLERANCE,
    *,
    two_terminal: bool = True,
) -> list[Verdict]:
    """Every spectrum of the sweeps, judged.

    two_terminal: whether all current that enters the skin leaves it by the meter; else the laws of
    passive networks are those of no Z, and each reading is judged by itself alone.
    noise: relative standard deviation of a reading where it is known; else it is told from repeated
    sweeps of one press, or from the residuals. tolerance: largest rms residual of Kramers-Kronig.
    Raises InputError where `noise` or `tolerance` is out of range, or where there are too few
    frequencies to tell noise from a broken law.
    """
    names = [str(name) for name in sweeps["interface"].values]
    parts = {name: read_at(sweeps, name) for name in names}
    _check_limits(noise, tolerance, min(part.sizes["frequency"] for part in parts.values()))
    readings = sum(part["Rs"].size for part in parts.values())
    return [
        judgement
        for name, part in parts.items()
        for judgement in _examine_interface(part, name, noise, tolerance, readings, two_terminal)
    ]


def _check_limits(noise: float | None, tolerance: float, frequencies: int) -> None:
    for name, value in (("noise", noise), ("tolerance", tolerance)):
        if value is not None and not (np.isfinite(value) and value > 0):
            raise InputError(f"`{name}` must be finite and > 0, got {value}")
    if noise is None and frequencies < FEWEST_FREQUENCIES:
        raise InputError(
            f"noise cannot be told from {frequencies} frequencies: need at least "
            f"{FEWEST_FREQUENCIES}, or a given `noise`"
        )


def _examine_interface(
    sweeps: xr.Dataset,
    name: str,
    noise: float | None,
    tolerance: float,
    readings: int,
    two_terminal: bool,
) -> list[Verdict]:
    Z, frequency = impedance(sweeps)[:, 0], sweeps["frequency"].values
    Cp = sweeps["Cp"].transpose(*DIMENSIONS).values[:, 0]
    if not np.abs(Z).all():
        raise InputError(f"interface {name}: Z is 0 ohm at some frequency, which no reading is")
    groups = list(zip(sweeps["press"].values, sweeps["session"].values, strict=True))
    spectra = [fitted(each, frequency, _inductive_end(each)) for each in Z]
    yardstick = _yardstick(spectra, groups, noise, tolerance, readings)
    spectra = [_without_chance_sign(each, yardstick) for each in spectra]
    return [
        Verdict(
            sweep,
            name,
            str(sweeps["press"].values[sweep]),
            spectrum,
            _range(np.degrees(np.angle(spectrum.Z))),
            yardstick.noise,
            yardstick.origin,
            _allowed(spectrum, yardstick),
            _violations(sweep, name, spectrum, yardstick, Cp[sweep], two_terminal),
        )
        for sweep, spectrum in enumerate(spectra)
    ]


def fitted(
    Z: NDArray[np.complex128], frequency: NDArray[np.float64], inductive: NDArray[np.bool_]
) -> Spectrum:
    """The spectrum beside the passive network that is nearest to its part below the inductive."""
    if (~inductive).sum() < FEWEST_FREQUENCIES:
        inductive = np.zeros_like(inductive)
    network = fit_passive(Z[~inductive], frequency[~inductive])
    residual = network.residual(Z, frequency)
    return Spectrum(Z, frequency, residual, inductive, network.inductance, network.parameters)


def _inductive_end(Z: NDArray[np.complex128]) -> NDArray[np.bool_]:
    """Readings from where on Im Z > 0 up to the highest frequency."""
    return np.logical_and.accumulate((Z.imag > 0)[::-1])[::-1]


def _without_chance_sign(spectrum: Spectrum, yardstick: _Yardstick) -> Spectrum:
    """Fitted to all readings where noise alone may have turned the sign of the highest ones."""
    slack = yardstick.limit * yardstick.noise * np.abs(spectrum.Z)
    beyond_noise = spectrum.Z.imag > slack
    if not spectrum.inductive.any() or (spectrum.inductive & beyond_noise).any():
        return spectrum
    return fitted(spectrum.Z, spectrum.frequency, np.zeros_like(spectrum.inductive))


def _yardstick(
    spectra: list[Spectrum],
    groups: list[tuple[str, int]],
    noise: float | None,
    tolerance: float,
    readings: int,
) -> _Yardstick:
    points = spectra[0].frequency.size
    tests = 2 * LAWS * readings
    if noise is not None:
        known = np.full(points, max(noise, RESOLUTION))
        return _Yardstick(known, known, Allowance(tests, np.inf).limit, tolerance, "given")
    residuals = np.array([_unbiased_residual(each) for each in spectra])
    repeated = repeatability(np.array([each.Z for each in spectra]), groups)
    rough = roughness(residuals) if repeated is None else repeated
    seen = np.maximum(rough, RESOLUTION)
    limit = Allowance(tests, 2 * len(spectra) * min(points, NEIGHBOURS)).limit
    spread = np.maximum(local_scale(residuals), seen)
    return _Yardstick(seen, spread, limit, tolerance, "fit" if repeated is None else "repeats")


def _unbiased_residual(spectrum: Spectrum) -> NDArray[np.complex128]:
    """NaN where not fitted, and as large as it were had the fit cost no degrees of freedom."""
    values = 2 * (~spectrum.inductive).sum()
    freedom = max(values - spectrum.parameters, 1)
    residual = spectrum.residual * np.sqrt(values / freedom)
    residual[spectrum.inductive] = np.nan + 1j * np.nan
    return residual


def _violations(
    sweep: int,
    interface: str,
    spectrum: Spectrum,
    yardstick: _Yardstick,
    Cp: NDArray[np.float64],
    two_terminal: bool,
) -> tuple[Violation, ...]:
    """Cp: F, as it is stored beside Rs and X, shape (frequency,). two_terminal: as of `examine`."""
    laws = {}
    if two_terminal:
        laws = _signs(spectrum, yardstick) | _monotony(spectrum, yardstick)
        laws[KRAMERS_KRONIG] = _inconsistent(spectrum, yardstick)
    slack = DISPLAYED + yardstick.limit * yardstick.noise
    Z, frequency = spectrum.Z, spectrum.frequency
    laws[OF_ONE_READING] = contradicting(Z.real, Z.imag, Cp, frequency, slack)
    return tuple(
        Violation(sweep, interface, law, tuple(spectrum.frequency[broken].tolist()))
        for law, broken in laws.items()
        if broken.any()
    )


def _signs(spectrum: Spectrum, yardstick: _Yardstick) -> dict[str, NDArray[np.bool_]]:
    slack = yardstick.limit * yardstick.noise * np.abs(spectrum.Z)
    return {
        "Re Z >= 0": spectrum.Z.real < -slack,
        "Im Z <= 0": (spectrum.Z.imag > slack) | spectrum.inductive,
    }


def _monotony(spectrum: Spectrum, yardstick: _Yardstick) -> dict[str, NDArray[np.bool_]]:
    """Rs, Cp and 1/Cs = -omega X below the inductive end, behind the series inductance if any."""
    kept, omega = ~spectrum.inductive, 2 * np.pi * spectrum.frequency
    Z = spectrum.Z - 1j * omega * (spectrum.inductance if spectrum.inductive.any() else 0.0)
    error = yardstick.limit * yardstick.noise * np.abs(spectrum.Z)
    slope = {
        "Rs not increasing": (Z.real, error),
        "Cp not increasing": ((1 / Z).imag / omega, error / np.abs(Z) ** 2 / omega),
        "Cs not increasing": (omega * Z.imag, omega * error),
    }
    broken = {law: np.zeros(kept.shape, dtype=np.bool_) for law in slope}
    for law, (values, allowed) in slope.items():
        broken[law][kept] = _off_decreasing(values[kept], allowed[kept])
    return broken


def _off_decreasing(values: NDArray[np.float64], allowed: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Where values are further than allowed from the nearest curve that does not increase."""
    from scipy.optimize import isotonic_regression

    weights = (allowed.min() / allowed) ** 2
    nearest = isotonic_regression(values, weights=weights, increasing=False).x
    return np.abs(values - nearest) > allowed


def _allowed(spectrum: Spectrum, yardstick: _Yardstick) -> NDArray[np.float64]:
    """Of a part of the residual: what chance allows a single reading; the tolerance where the whole
    is beyond it, so divided between both parts that some reading is always further than allowed.
    """
    by_chance = yardstick.limit * yardstick.spread
    if spectrum.misfit <= yardstick.tolerance:
        return by_chance
    return np.minimum(by_chance, yardstick.tolerance / np.sqrt(2))


def _inconsistent(spectrum: Spectrum, yardstick: _Yardstick) -> NDArray[np.bool_]:
    """Readings off the nearest passive network by more than allowed."""
    largest = np.maximum(np.abs(spectrum.residual.real), np.abs(spectrum.residual.imag))
    return (largest > _allowed(spectrum, yardstick)) & ~spectrum.inductive


def _range(values: NDArray[np.float64]) -> tuple[float, float]:
    return float(values.min()), float(values.max())
