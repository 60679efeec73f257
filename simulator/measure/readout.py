"""Display of an impedance by a meter, and the statistics of its errors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..scene.meter import Readout
from ..scene.reading_setup import ReadingSetup
from ..sweeps import InputError, build, impedance, parallel_capacitance
from ..sweeps.schema import taken_of

if TYPE_CHECKING:
    import xarray as xr

    from ..scene.scene import Scene


class Meter:
    """A meter in one session: its fixed errors are drawn once, at each interface.

    gain: factor on |Z|, turn: added to the phase [rad], both of shape (interface, 1).
    """

    def __init__(self, readout: Readout, interfaces: int, random: np.random.Generator) -> None:
        self._readout, self._random = readout, random
        magnitude, phase = random.standard_normal((2, interfaces, 1))
        self.gain = 1 + readout.magnitude_accuracy * magnitude
        self.turn = readout.phase_accuracy * phase

    def measure(self, Z: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Z in ohm with errors, one reading for each; shape (sweep, interface, frequency)."""
        magnitude, phase = self._random.standard_normal((2, *Z.shape))
        gain = self.gain * (1 + self._readout.magnitude_noise * magnitude)
        return Z * gain * np.exp(1j * (self.turn + self._readout.phase_noise * phase))


def displayed(value: NDArray[np.float64], digits: int) -> NDArray[np.float64]:
    """Values rounded to that many significant digits, as on a meter's display."""
    some = np.isfinite(value) & (value != 0)
    exponent = np.floor(np.log10(np.abs(value), out=np.zeros(value.shape), where=some))
    low, high = exponent.min(initial=0.0), exponent.max(initial=0.0)
    powers = 10.0 ** (np.arange(low, high + 1) + 1 - digits)
    step = powers[(exponent - low).astype(np.int64)]
    return np.round(value / step) * step


def read_out(
    sweeps: xr.Dataset, readout: Readout, random: np.random.Generator, session: int = 0
) -> xr.Dataset:
    """Sweeps as measured by a meter in one session, without numerical errors."""
    frequency = sweeps["frequency"].values
    Z = Meter(readout, sweeps.sizes["interface"], random).measure(impedance(sweeps))
    Rs, X, Cp = (
        displayed(value, readout.display_digits)
        for value in (Z.real, Z.imag, parallel_capacitance(Z, frequency))
    )
    kept = ("interface", "press", "row", "column")
    labels: Any = {name: list(sweeps[name].values) for name in kept}
    return build(
        Rs + 1j * X,
        frequency,
        **labels,
        session=[session] * sweeps.sizes["sweep"],
        Cp=Cp,
        taken=taken_of(sweeps),
        attributes={**sweeps.attrs, "readout": readout.model_dump_json()},
    )


def observed(
    Z: NDArray[np.complex128], taken: NDArray[np.bool_] | None = None
) -> NDArray[np.float64]:
    """ln |Z / ohm| of all readings taken, then their phases in rad; shape (..., 2 * readings).

    Z: ohm, shape (..., interface, frequency). taken: which of these, all for None.
    """
    flat = _readings(Z, taken)
    return np.concatenate([np.log(np.abs(flat)), np.angle(flat)], axis=-1)


def observed_slope(
    Z: NDArray[np.complex128], dZ: NDArray[np.complex128], taken: NDArray[np.bool_] | None = None
) -> NDArray[np.float64]:
    """Derivative of `observed` from that of Z, of the same shape as Z."""
    ratio = _readings(dZ / Z, taken)
    return np.concatenate([ratio.real, ratio.imag], axis=-1)


def _readings(Z: NDArray[np.complex128], taken: NDArray[np.bool_] | None) -> NDArray[np.complex128]:
    return Z.reshape(*Z.shape[:-2], -1) if taken is None else Z[..., taken]


@dataclass(frozen=True)
class ErrorModel:
    """Standard deviations of the `observed` values of one sweep.

    readout: of the meter. read: mask of the readings, shape (interface, frequency). averaged:
    number of averaged sweeps. against_rest: number of baseline sweeps whose average is subtracted;
    0 for values without a baseline, which have the errors of the session.
    """

    readout: Readout
    read: NDArray[np.bool_]
    averaged: int = 1
    against_rest: int = 0

    def __post_init__(self) -> None:
        """Raises InputError for a meter without noise."""
        readout = self.readout
        if not (readout.magnitude_noise > 0 and readout.phase_noise > 0):
            raise InputError(
                "`readout.magnitude_noise` and `readout.phase_noise` must be > 0 for errors to be "
                "counted in units of the meter's"
            )

    @property
    def deviation(self) -> NDArray[np.float64]:
        """Standard deviation of each value by the noise of readings, shape (2 * readings
        taken,)."""
        return np.repeat(self.noise, self.read.sum())

    @property
    def noise(self) -> NDArray[np.float64]:
        """Standard deviations of one ln |Z| and one phase by the noise of readings, shape (2,)."""
        rest = 1 / self.against_rest if self.against_rest else 0.0
        both = np.array([self.readout.magnitude_noise, self.readout.phase_noise])
        return both * np.sqrt(1 / self.averaged + rest)

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Covariance of all values, shape (2 * readings taken, 2 * readings taken)."""
        C = np.diag(self.deviation**2)
        if self.against_rest:
            return C
        interface = np.nonzero(self.read)[0]
        shared = (interface[:, None] == interface).astype(np.float64)
        accuracy = self.readout.magnitude_accuracy, self.readout.phase_accuracy
        return C + np.kron(np.diag(np.square(accuracy)), shared)

    def whitened(self, numbers: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values of the readings taken, transformed to independent errors of deviation 1.

        numbers: of all readings, see `observed`, shape (..., 2 * readings). Returns shape (..., 2
        * readings taken).
        """
        numbers = numbers[..., np.tile(self.read.ravel(), 2)]
        factor = np.linalg.cholesky(self.covariance)
        flat = np.linalg.solve(factor, numbers.reshape(-1, numbers.shape[-1]).T)
        return flat.T.reshape(numbers.shape).astype(np.float64)


def errors_of(
    scene: Scene, against_rest: int = 0, averaged: int = 1, reading: ReadingSetup | None = None
) -> ErrorModel:
    """Error model of a scene's meter. Raises InputError without noise.

    reading: all readings of the scene for None. The other arguments: see `ErrorModel`.
    """
    read = scene.reading if reading is None else reading
    return ErrorModel(scene.readout, read.read, averaged, against_rest)
