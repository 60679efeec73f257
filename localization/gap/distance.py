"""Distances between the mean sweeps of both sides for the same presses, in several units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Complex, Integer, Real
from ...simulator.measure.simulate import ReadingError
from ...simulator.sweeps.reading_noise import repeatability
from ...simulator.sweeps.reading_quantities import IMPEDANCE, kind_of
from ...simulator.sweeps.reading_subset import read_mask
from ...simulator.sweeps.schema import complex_readings
from ..inputs.targets import labels
from .pair import pixel_of

if TYPE_CHECKING:
    import xarray as xr

UNITS = {"Rs": "ohm", "Cp": "F", "gain": "1", "gain_phase": "rad"}
"""Units of the compared quantities: of impedances, and of gains."""
MIN_SEPARATION_SHARE = 1e-3
"""Share of the largest class separation at any frequency below which a separation is ignored.

There Cp is the same for all pixels, and the simulation's error dominates the separation.
"""
MIN_FREQUENCIES = 3
"""Minimum number of frequencies for an estimate of the repeatability."""


@dataclass(frozen=True, eq=False)
class ReadingDeviation:
    """Standard deviation of one reading at each frequency: of its modulus, and of its phase in rad.

    Both of shape (frequency,). source: origin of the numbers.
    """

    magnitude: Real
    phase: Real
    source: str


@dataclass(frozen=True, eq=False)
class Distance:
    """Other side minus simulation of one quantity, each of shape (interface, frequency).

    All are NaN where nothing was read. simulated: mean over the pixels, SI. mean, rms: over the
    pixels, SI. meter_error: standard deviation of one reading, SI; None if unknown. separation:
    root mean square distance of neighbouring classes, SI.
    """

    simulated: Real
    mean: Real
    rms: Real
    meter_error: Real | None
    separation: Real

    @property
    def percent(self) -> Real:
        """Mean distance in percent of the simulated mean."""
        return 100 * self.mean / np.abs(self.simulated)

    @property
    def meter_errors(self) -> Real | None:
        """Mean distance divided by the meter's error of one reading."""
        return None if self.meter_error is None else self.mean / self.meter_error

    @property
    def separations(self) -> Real:
        """Mean distance over the class separation; NaN where classes coincide."""
        known = self.separation[np.isfinite(self.separation)]
        least = MIN_SEPARATION_SHARE * known.max(initial=0.0)
        separation = np.where(self.separation > least, self.separation, np.nan)
        return self.mean / separation


def meter_error(other: xr.Dataset, given: ReadingError | None) -> ReadingDeviation | None:
    """Error of the meter, from the scene or from repeated sweeps; None if neither gives it.

    From repeated sweeps it is the noise of real and imaginary part over the modulus. The noise is
    the difference between neighbouring frequencies, on which unequal presses have little effect.
    """
    count = other.sizes["frequency"]
    if given is not None:
        even = np.ones(count)
        return ReadingDeviation(given.magnitude * even, given.phase * even, "the scene's [readout]")
    if count < MIN_FREQUENCIES:
        return None
    found = _from_repeats(other)
    source = "the repeatability of the sweeps, because no scene states it"
    return ReadingDeviation(found, found, source) if found is not None and found.all() else None


def distances(
    simulated: xr.Dataset,
    other: xr.Dataset,
    error: ReadingDeviation | None,
    target: str,
    pressed: bool,
) -> dict[str, Distance] | None:
    """Distances over the pixels that both sides have, of Rs and Cp, or of gains; None without any.

    pressed: True for the pressed pixels, False for the unpressed skin. target: whose classes are
    separated.
    """
    pixels = np.intersect1d(pixel_of(simulated), pixel_of(other))
    pixels = pixels[(pixels > 0) == pressed]
    if not pixels.size:
        return None
    names = [name for name in kind_of(simulated.variables).names if name in UNITS]
    return {name: _distance(name, simulated, other, error, target, pixels) for name in names}


def _distance(
    name: str,
    simulated: xr.Dataset,
    other: xr.Dataset,
    error: ReadingDeviation | None,
    target: str,
    pixels: Integer,
) -> Distance:
    ours, theirs = (_means(part, name, pixels) for part in (simulated, other))
    readings, pixel = complex_readings(simulated), pixel_of(simulated)
    mean = np.mean([readings[pixel == each].mean(0) for each in pixels], 0)
    of = _errors_of_gains if kind_of(simulated.variables) is not IMPEDANCE else _errors
    frequency = simulated["frequency"].values
    return Distance(
        simulated=ours.mean(axis=0),
        mean=(theirs - ours).mean(axis=0),
        rms=np.sqrt(np.mean((theirs - ours) ** 2, axis=0)),
        meter_error=None if error is None else of(mean, frequency, error)[name],
        separation=_separation(simulated, name, target),
    )


def _means(sweeps: xr.Dataset, name: str, pixels: Integer) -> Real:
    """Mean of all sweeps of each pixel, shape (pixel, interface, frequency)."""
    values, pixel = _values(sweeps, name), pixel_of(sweeps)
    return np.stack([values[pixel == each].mean(axis=0) for each in pixels])


def _values(sweeps: xr.Dataset, name: str) -> Real:
    return sweeps[name].transpose("sweep", "interface", "frequency").values


def _errors(Z: Complex, frequency: Real, error: ReadingDeviation) -> dict[str, Real]:
    """Errors of Rs = |Z| cos(phase) and Cp = -sin(phase)/(omega |Z|) from |Z| and phase."""
    Y, omega = 1 / Z, 2 * np.pi * frequency
    return {
        "Rs": np.hypot(Z.real * error.magnitude, Z.imag * error.phase),
        "Cp": np.hypot(Y.imag * error.magnitude, Y.real * error.phase) / omega,
    }


def _errors_of_gains(G: Complex, _: Real, error: ReadingDeviation) -> dict[str, Real]:
    """Errors of modulus and phase of gains."""
    return {
        "gain": np.abs(G) * error.magnitude,
        "gain_phase": np.broadcast_to(error.phase, G.shape),
    }


def _separation(sweeps: xr.Dataset, name: str, target: str) -> Real:
    """Root mean square distance of the means of neighbouring classes."""
    values, classes = _values(sweeps, name), labels(sweeps, target)
    differences = [
        values[classes == one].mean(axis=0) - values[classes == other].mean(axis=0)
        for one, other in neighbours(classes)
    ]
    return (
        np.sqrt(np.mean(np.square(differences), axis=0))
        if differences
        else np.zeros(values.shape[1:])
    )


def neighbours(classes: NDArray) -> list[tuple[int | str, int | str]]:
    """Pairs of adjacent classes: numbers k and k + 1, or pixels that share a side."""
    places = {tuple(map(int, str(each).split(","))): each for each in np.unique(classes).tolist()}
    pressed = {place: each for place, each in places.items() if all(place)}
    steps = np.eye(len(next(iter(places))), dtype=int)
    return [
        (each, pressed[neighbour])
        for place, each in pressed.items()
        for step in steps
        if (neighbour := tuple((np.array(place) + step).tolist())) in pressed
    ]


def _from_repeats(other: xr.Dataset) -> Real | None:
    """Relative noise, root mean square over the interfaces, shape (frequency,).

    None if it is unknown at any frequency.
    """
    groups = list(zip(other["session"].values.tolist(), pixel_of(other).tolist(), strict=True))
    Z, read = complex_readings(other), read_mask(other)
    square, count = np.zeros(Z.shape[2]), np.zeros(Z.shape[2])
    for interface, own in enumerate(read):
        if own.sum() < MIN_FREQUENCIES:
            continue
        found = repeatability(Z[:, interface, own], groups)
        if found is not None:
            square[own] += found**2
            count[own] += 1
    return np.sqrt(square / count) if count.all() else None
