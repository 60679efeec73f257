"""How noisy the readings are: as the scene states, as repeats tell, or as the fit leaves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from simulator.calibration.measured import Measured
from simulator.scene import Readout

LEAST_FREEDOM = 10
"""Numbers beyond the mean from which repeats tell the noise."""
FIRST_GUESS = 0.01


@dataclass(frozen=True)
class Noise:
    """The meter's errors, and where they are known from.

    freedom: how many numbers they were estimated from beyond those estimated, infinite where they
    are stated. guessed: whether the fit's own residuals are to tell them.
    """

    readout: Readout
    source: str
    freedom: float = np.inf
    guessed: bool = False


def noise_of(measured: Measured) -> Noise:
    """Of the scene's readout, else of repeats of the skin at rest, else a first guess."""
    readout = measured.scene.readout
    if readout.magnitude_noise > 0 and readout.phase_noise > 0:
        return Noise(readout, "the scene's readout")
    repeated = [each for each in measured.readings if each.deviation is not None]
    freedom = sum((each.averaged - 1) * each.Z.size for each in repeated)
    if freedom < LEAST_FREEDOM:
        return Noise(with_noise(readout, FIRST_GUESS, FIRST_GUESS), "a guess", guessed=True)
    squares = sum((each.averaged - 1) * _squares(each.deviation) for each in repeated)
    magnitude, phase = np.sqrt(squares / freedom)
    sweeps = sum(each.averaged for each in repeated)
    source = f"{sweeps} sweeps of the skin at rest"
    return Noise(with_noise(readout, float(magnitude), float(phase)), source, freedom)


def with_noise(readout: Readout, magnitude: float, phase: float) -> Readout:
    """The meter with so much noise of |Z| and phase [rad]."""
    least = 10.0 ** (1 - readout.display_digits)
    return readout.model_copy(
        update={"magnitude_noise": max(magnitude, least), "phase_noise": max(phase, least)}
    )


def _squares(deviation: np.ndarray | None) -> np.ndarray:
    """Sums of squares of ln |Z| and of phase."""
    assert deviation is not None
    return (deviation.reshape(2, -1) ** 2).sum(axis=1)
