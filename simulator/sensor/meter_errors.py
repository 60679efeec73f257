"""Meters of a batch of skins: one, with its own errors, for each skin."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy, deepcopy
from typing import Self

import numpy as np

from ..arrays import Complex, Real
from ..measure.skins import METER, stream
from ..scene.parts import Meter, Setup
from ..sweeps.reading_quantities import KINDS


class MeterErrors:
    """Meters in their sessions: fixed errors of each, the noise of each reading, and the display.

    Noise is drawn for whole sweeps, so that it does not depend on how steps are divided. Deviations
    are kept for each slot of a sweep, for readings that stay the same.
    """

    def __init__(
        self, setup: Setup, meter: Meter, seed: int, numbers: Sequence[int], noise: bool
    ) -> None:
        """numbers: of the sessions. noise: False for meters without errors and rounding."""
        from .readout_kernel import shown_quantities

        self._kernel = shown_quantities
        self._readout, self._shape, count = meter.readout, setup.shape, len(numbers)
        self._frequency, self._noisy = setup.frequency, noise
        self._kind, self._digits = KINDS.index(setup.kind), 0
        self._fixed, self._sweep = np.zeros((2, count, self._shape[0])), -1
        self._noise = np.zeros((2, count, *self._shape))
        self._uniform = np.zeros((4, 1, 1)) if meter.readout.uniform or not noise else None
        self._randoms = []
        self._latest: dict[tuple[int, int], tuple[Complex, Real]] = {}
        if noise:
            self._digits = meter.readout.display_digits
            self._randoms = [stream(seed, number, METER) for number in numbers]
            fixed = [random.standard_normal((2, self._shape[0], 1)) for random in self._randoms]
            self._fixed = np.stack(fixed, axis=1)[..., 0]
            if self._uniform is not None:
                self._uniform = self._deviation(np.ones((1, 1), dtype=complex), np.ones(1))

    def copy(self) -> Self:
        """Independent meters in the same state."""
        other = copy(self)
        other._randoms, other._noise = deepcopy(self._randoms), self._noise.copy()
        other._latest = {**self._latest}
        return other

    def shown(self, reading: Complex, sweep: int, interface: int, frequencies: slice) -> Real:
        """Quantities as displayed, shape (quantity, skin, frequency).

        reading: shape (skin, frequency). sweep: its number, ascending from call to call.
        frequencies: range of their numbers.
        """
        while self._noisy and self._sweep < sweep:
            self._draw()
        frequency, deviation = self._frequency[frequencies], self._uniform
        if deviation is None:
            slot = interface, frequencies.start
            latest = self._latest.get(slot)
            if latest is None or not np.array_equal(latest[0], reading):
                latest = self._latest[slot] = reading.copy(), self._deviation(reading, frequency)
            deviation = latest[1]
        noise = np.ascontiguousarray(self._noise[:, :, interface, frequencies])
        fixed = np.ascontiguousarray(self._fixed[:, :, interface])
        reading = np.ascontiguousarray(reading)
        return self._kernel(reading, deviation, fixed, noise, frequency, self._digits, self._kind)

    def _deviation(self, reading: Complex, frequency: Real) -> Real:
        """Deviations of the fixed errors, then of the noise, shape (4, skin, frequency)."""
        each = self._readout.accuracy(reading, frequency), self._readout.noise(reading, frequency)
        return np.concatenate(each)

    def _draw(self) -> None:
        self._sweep += 1
        for k, random in enumerate(self._randoms):
            self._noise[:, k] = random.standard_normal((2, *self._shape))
