"""Errors of the meters of a batch of skins: one meter, with its own errors, for each skin."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..measure.readout import with_errors
from ..measure.streams import METER, stream
from ..scene.scene import Scene


class MeterErrors:
    """Meters in their sessions: fixed errors of each, and the noise of each reading.

    Noise is drawn for whole sweeps, so that it does not depend on how steps are divided.
    """

    def __init__(self, scene: Scene, seed: int, numbers: Sequence[int]) -> None:
        self._readout, self._shape = scene.readout, scene.reading.shape
        self._randoms = [stream(seed, number, METER) for number in numbers]
        interfaces = self._shape[0]
        fixed = [random.standard_normal((2, interfaces, 1)) for random in self._randoms]
        self._fixed, self._sweep = np.stack(fixed, axis=1), -1
        self._noise = np.zeros((2, len(numbers), *self._shape))

    def measured(
        self,
        reading: NDArray[np.complex128],
        frequency: NDArray[np.float64],
        sweep: int,
        interface: int,
        frequencies: slice,
    ) -> NDArray[np.complex128]:
        """Readings with errors. reading: shape (skin, frequency), at frequencies in Hz.

        sweep: its number, ascending from call to call. frequencies: range of numbers.
        """
        while self._sweep < sweep:
            self._draw()
        noise = self._noise[:, :, interface, frequencies]
        fixed = self._fixed[:, :, interface]
        return with_errors(self._readout, reading, frequency, fixed, noise)

    def _draw(self) -> None:
        self._sweep += 1
        for k, random in enumerate(self._randoms):
            self._noise[:, k] = random.standard_normal((2, *self._shape))
