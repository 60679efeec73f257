"""From derivatives of impedance to derivatives of what a meter reads, over its noise.

What a meter gets wrong alike in all readings of an interface and session are two more unknowns for
each interface, a gain and a turn, known beforehand to its accuracy. Against the skin at rest they
drop out.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from simulator.observation import ErrorModel, observed_slope
from simulator.scene import Scene


def error_model(scene: Scene, frequencies: int, against_rest: int = 0) -> ErrorModel:
    """The errors of a sweep of a scene at so many frequencies. Raises InputError without noise."""
    return ErrorModel(scene.readout, len(scene.interfaces), frequencies, against_rest=against_rest)


def in_noise(
    Z: NDArray[np.complex128], slopes: Sequence[NDArray[np.complex128]], model: ErrorModel
) -> NDArray[np.float64]:
    """Slopes of ln |Z| and phase over the noise, shape (interface, frequency, 2, slope)."""
    shape = 2, model.interfaces, model.frequencies
    deviation = model.deviation.reshape(shape)
    columns = [observed_slope(Z, dZ).reshape(shape) / deviation for dZ in slopes]
    return np.moveaxis(np.stack(columns, axis=-1), 0, 2)


def session_errors(model: ErrorModel) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Slopes by gain and turn of each interface, shape (interface, frequency, 2, unknown), and
    1/deviation² of each unknown; none where they drop out."""
    accuracy = np.array([model.readout.magnitude_accuracy, model.readout.phase_accuracy])
    quantities = [] if model.against_rest else np.flatnonzero(accuracy > 0).tolist()
    unknown = [(i, q) for i in range(model.interfaces) for q in quantities]
    slopes = np.zeros((model.interfaces, model.frequencies, 2, len(unknown)))
    deviation = model.deviation.reshape(2, model.interfaces, model.frequencies)
    for number, (i, q) in enumerate(unknown):
        slopes[i, :, q, number] = 1 / deviation[q, i]
    return slopes, np.array([accuracy[q] ** -2 for _, q in unknown])
