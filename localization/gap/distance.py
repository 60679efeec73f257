"""How far the mean sweeps of the same presses are apart, in the units that matter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...simulator.measure.simulate import ReadingError
from ...simulator.sweeps import impedance
from ...simulator.sweeps.laws.noise import repeatability
from ...simulator.sweeps.reading_subset import read_mask
from ..inputs.targets import labels
from .pair import pixel_of

if TYPE_CHECKING:
    import xarray as xr

QUANTITIES = {"Rs": "ohm", "Cp": "F"}
TOGETHER = 1e-3
"""Of the largest distance of classes at any frequency: below it, where Cp is the same for all
pixels, the error of the simulation decides how far they are apart."""
MIN_FREQUENCIES = 3
"""That a roughness, and so a repeatability, can be told from."""


@dataclass(frozen=True, eq=False)
class ReadingDeviation:
    """Standard deviation of one reading at each frequency: of |Z|, and of the phase in rad.

    Both of shape (frequency,). source: where they are from.
    """

    magnitude: NDArray[np.float64]
    phase: NDArray[np.float64]
    source: str


@dataclass(frozen=True, eq=False)
class Distance:
    """Other side minus simulation of one quantity, each of shape (interface, frequency).

    All are NaN where nothing was read. simulated: mean over the pixels, SI. mean, rms: over the
    pixels, SI. meter_error: of one reading of it, SI; None where unknown. separation: root mean
    square distance of neighbouring classes, SI.
    """

    simulated: NDArray[np.float64]
    mean: NDArray[np.float64]
    rms: NDArray[np.float64]
    meter_error: NDArray[np.float64] | None
    separation: NDArray[np.float64]

    @property
    def percent(self) -> NDArray[np.float64]:
        """Of the simulated mean."""
        return 100 * self.mean / np.abs(self.simulated)

    @property
    def meter_errors(self) -> NDArray[np.float64] | None:
        """In errors of one reading."""
        return None if self.meter_error is None else self.mean / self.meter_error

    @property
    def separations(self) -> NDArray[np.float64]:
        """In distances of neighbouring classes; NaN where these lie together, by TOGETHER."""
        known = self.separation[np.isfinite(self.separation)]
        least = TOGETHER * known.max(initial=0.0)
        apart = np.where(self.separation > least, self.separation, np.nan)
        return self.mean / apart


def meter_error(other: xr.Dataset, given: ReadingError | None) -> ReadingDeviation | None:
    """Of the meter as the scene has it, or told from repeated sweeps; None where neither can.

    From repeats, the noise is that of real and imaginary part over |Z|: what differs from one
    frequency to the next, so that unequal presses hardly count.
    """
    count = other.sizes["frequency"]
    if given is not None:
        even = np.ones(count)
        return ReadingDeviation(given.magnitude * even, given.phase * even, "the scene's [readout]")
    if count < MIN_FREQUENCIES:
        return None
    found = _from_repeats(other)
    source = "the repeatability of the sweeps, for no scene tells the meter's"
    return ReadingDeviation(found, found, source) if found is not None and found.all() else None


def distances(
    simulated: xr.Dataset,
    other: xr.Dataset,
    error: ReadingDeviation | None,
    target: str,
    pressed: bool,
) -> dict[str, Distance] | None:
    """Of Rs and Cp, over the pixels pressed on both sides, or at rest; None where there are none.

    target: whose classes count as separated.
    """
    pixels = np.intersect1d(pixel_of(simulated), pixel_of(other))
    pixels = pixels[(pixels > 0) == pressed]
    if not pixels.size:
        return None
    return {name: _distance(name, simulated, other, error, target, pixels) for name in QUANTITIES}


def _distance(
    name: str,
    simulated: xr.Dataset,
    other: xr.Dataset,
    error: ReadingDeviation | None,
    target: str,
    pixels: NDArray[np.int64],
) -> Distance:
    ours, theirs = (_means(part, name, pixels) for part in (simulated, other))
    Z = np.mean([impedance(simulated)[pixel_of(simulated) == each].mean(0) for each in pixels], 0)
    frequency = simulated["frequency"].values
    return Distance(
        simulated=ours.mean(axis=0),
        mean=(theirs - ours).mean(axis=0),
        rms=np.sqrt(np.mean((theirs - ours) ** 2, axis=0)),
        meter_error=None if error is None else _errors(Z, frequency, error)[name],
        separation=_separation(simulated, name, target),
    )


def _means(sweeps: xr.Dataset, name: str, pixels: NDArray[np.int64]) -> NDArray[np.float64]:
    """Of all sweeps of each pixel, shape (pixel, interface, frequency)."""
    values, pixel = _values(sweeps, name), pixel_of(sweeps)
    return np.stack([values[pixel == each].mean(axis=0) for each in pixels])


def _values(sweeps: xr.Dataset, name: str) -> NDArray[np.float64]:
    return sweeps[name].transpose("sweep", "interface", "frequency").values


def _errors(
    Z: NDArray[np.complex128], frequency: NDArray[np.float64], error: ReadingDeviation
) -> dict[str, NDArray[np.float64]]:
    """Of Rs = |Z| cos(phase) and Cp = -sin(phase)/(omega |Z|), by those of |Z| and phase."""
    Y, omega = 1 / Z, 2 * np.pi * frequency
    return {
        "Rs": np.hypot(Z.real * error.magnitude, Z.imag * error.phase),
        "Cp": np.hypot(Y.imag * error.magnitude, Y.real * error.phase) / omega,
    }


def _separation(sweeps: xr.Dataset, name: str, target: str) -> NDArray[np.float64]:
    """Root mean square over neighbouring classes of the distance of their means."""
    values, classes = _values(sweeps, name), labels(sweeps, target)
    apart = [
        values[classes == one].mean(axis=0) - values[classes == other].mean(axis=0)
        for one, other in neighbours(classes)
    ]
    return np.sqrt(np.mean(np.square(apart), axis=0)) if apart else np.zeros(values.shape[1:])


def neighbours(classes: NDArray) -> list[tuple[int | str, int | str]]:
    """Pairs of classes next to each other on the skin: k and k + 1, or pixels that share a side."""
    places = {tuple(map(int, str(each).split(","))): each for each in np.unique(classes).tolist()}
    pressed = {place: each for place, each in places.items() if all(place)}
    steps = np.eye(len(next(iter(places))), dtype=int)
    return [
        (each, pressed[beside])
        for place, each in pressed.items()
        for step in steps
        if (beside := tuple((np.array(place) + step).tolist())) in pressed
    ]


def _from_repeats(other: xr.Dataset) -> NDArray[np.float64] | None:
    """Relative noise, root mean square over the interfaces, shape (frequency,).

    None where it is not known at all frequencies.
    """
    groups = list(zip(other["session"].values.tolist(), pixel_of(other).tolist(), strict=True))
    Z, read = impedance(other), read_mask(other)
    square, count = np.zeros(Z.shape[2]), np.zeros(Z.shape[2])
    for interface, own in enumerate(read):
        if own.sum() < MIN_FREQUENCIES:
            continue
        found = repeatability(Z[:, interface, own], groups)
        if found is not None:
            square[own] += found**2
            count[own] += 1
    return np.sqrt(square / count) if count.all() else None
