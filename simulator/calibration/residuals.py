"""What a fit leaves of the readings, in units of the meter's error."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simulator.calibration.fit import Fit
from simulator.sweeps import parallel_capacitance


def residuals(fit: Fit) -> dict[str, NDArray[np.float64]]:
    """Measured less fitted over the error of a reading by noise.

    Of |Z|, phase, Rs and Cp, each of shape (reading, interface, frequency); the meter's fixed
    errors of the session are part of what is fitted.
    """
    asked = fit.asked
    Z = np.stack([reading.Z for reading in asked.measured.readings])
    averaged = np.sqrt([reading.averaged for reading in asked.measured.readings])[:, None, None]
    magnitude = asked.readout.magnitude_noise / averaged
    phase = asked.readout.phase_noise / averaged
    off = fit.problem.residuals(fit.u)[: 2 * Z.size].reshape(len(Z), 2, *Z.shape[1:])
    fitted = Z * np.exp(off[:, 0] * magnitude + 1j * off[:, 1] * phase)
    frequency = asked.measured.scene.frequencies
    omega, Y = 2 * np.pi * frequency, 1 / fitted
    of_Rs = np.hypot(fitted.real * magnitude, fitted.imag * phase)
    of_Cp = np.hypot(Y.imag * magnitude, Y.real * phase) / omega
    Cp, fitted_Cp = (parallel_capacitance(each, frequency) for each in (Z, fitted))
    return {
        "|Z|": -off[:, 0],
        "phase": -off[:, 1],
        "Rs": (Z.real - fitted.real) / of_Rs,
        "Cp": (Cp - fitted_Cp) / of_Cp,
    }
