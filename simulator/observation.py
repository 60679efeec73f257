"""What a meter tells of an impedance, and how surely: ln |Z| and the phase of every reading.

In these its errors are additive: a part that all readings of an interface share in a session, and a
part that is new with every reading (see `readout`). Against the skin at rest, read in the same
session, the shared part drops out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.scene import Readout
from simulator.sweeps import InputError


def observed(Z: NDArray[np.complex128]) -> NDArray[np.float64]:
    """ln |Z / ohm| of all readings, then their phases in rad; shape (..., 2 * readings).

    Z: ohm, shape (..., interface, frequency).
    """
    flat = Z.reshape(*Z.shape[:-2], -1)
    return np.concatenate([np.log(np.abs(flat)), np.angle(flat)], axis=-1)


def observed_slope(Z: NDArray[np.complex128], dZ: NDArray[np.complex128]) -> NDArray[np.float64]:
    """The derivative of `observed` from that of Z, of the same shape as Z."""
    ratio = (dZ / Z).reshape(*Z.shape[:-2], -1)
    return np.concatenate([ratio.real, ratio.imag], axis=-1)


@dataclass(frozen=True)
class ErrorModel:
    """Standard deviations of what `observed` tells of one sweep.

    readout: of the meter. interfaces, frequencies: how many. averaged: sweeps that are averaged.
    against_rest: of how many sweeps of the skin at rest, averaged, it is the difference; 0 tells
    it as it is, with the errors of the session.
    """

    readout: Readout
    interfaces: int
    frequencies: int
    averaged: int = 1
    against_rest: int = 0

    def __post_init__(self) -> None:
        """Raises InputError where the meter is without noise."""
        readout = self.readout
        if not (readout.magnitude_noise > 0 and readout.phase_noise > 0):
            raise InputError(
                "`readout.magnitude_noise` and `readout.phase_noise` must be > 0 for errors to be "
                "counted in units of the meter's"
            )

    @property
    def deviation(self) -> NDArray[np.float64]:
        """Of each number by the noise of readings, shape (2 * readings,)."""
        readings = self.interfaces * self.frequencies
        noise = np.repeat([self.readout.magnitude_noise, self.readout.phase_noise], readings)
        rest = 1 / self.against_rest if self.against_rest else 0.0
        return noise * np.sqrt(1 / self.averaged + rest)

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Of all numbers together, shape (2 * readings, 2 * readings)."""
        C = np.diag(self.deviation**2)
        if self.against_rest:
            return C
        shared = np.kron(np.eye(self.interfaces), np.ones((self.frequencies, self.frequencies)))
        accuracy = self.readout.magnitude_accuracy, self.readout.phase_accuracy
        return C + np.kron(np.diag(np.square(accuracy)), shared)

    def whitened(self, numbers: NDArray[np.float64]) -> NDArray[np.float64]:
        """The numbers turned so that each errs by 1 on its own; shape (..., 2 * readings)."""
        factor = np.linalg.cholesky(self.covariance)
        flat = np.linalg.solve(factor, numbers.reshape(-1, numbers.shape[-1]).T)
        return flat.T.reshape(numbers.shape).astype(np.float64)
