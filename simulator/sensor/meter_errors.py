"""Meters of a batch of skins: one, with its own errors, for each skin."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from copy import copy, deepcopy
from typing import Self

import numpy as np
from numpy.typing import NDArray

from ..arrays import Complex, Real
from ..compiled import compiled
from ..measure.skins import METER, stream
from ..scene.parts import Meter, Setup
from ..sweeps.reading_quantities import KINDS

IMPEDANCE, GAIN, MAGNITUDE = range(3)


@compiled()
def shown_quantities(
    reading: NDArray,
    deviation: NDArray,
    fixed: NDArray,
    noise: NDArray,
    frequency: NDArray,
    interface: int,
    first: int,
    digits: int,
    kind: int,
) -> NDArray:  # pragma: no cover
    """Quantities of readings as displayed, shape (quantity, skin, frequency).

    reading: shape (skin, frequency). deviation: of the fixed errors of magnitude and phase, then of
    their noise, shape (4, skin, frequency), or 1 where they are all equal. fixed, noise: standard
    normal numbers of all readings, shapes (2, skin, interface) and (2, skin, interface, frequency).
    frequency: of all readings, Hz. interface, first: numbers of the interface and of the first
    frequency of these readings. digits: 0 for no rounding. kind: IMPEDANCE for Rs, X, Cp; GAIN for
    magnitude and phase; MAGNITUDE.
    """
    skins, frequencies = reading.shape
    found = np.empty((3 - kind, skins, frequencies))
    for skin in range(skins):
        own = min(skin, deviation.shape[1] - 1)
        for k in range(frequencies):
            at, there = min(k, deviation.shape[2] - 1), first + k
            gain = 1 + deviation[0, own, at] * fixed[0, skin, interface]
            gain *= 1 + deviation[2, own, at] * noise[0, skin, interface, there]
            turn = deviation[1, own, at] * fixed[1, skin, interface]
            turn += deviation[3, own, at] * noise[1, skin, interface, there]
            value = reading[skin, k] * gain * complex(math.cos(turn), math.sin(turn))
            if kind == IMPEDANCE:
                found[0, skin, k] = value.real
                found[1, skin, k] = value.imag
                size = abs(value)
                omega = 2 * math.pi * frequency[there]
                found[2, skin, k] = -(value.imag / size) / size / omega
            else:
                found[0, skin, k] = abs(value)
                if kind == GAIN:
                    found[1, skin, k] = cmath.phase(value)
            if digits > 0:
                for quantity in range(len(found)):
                    found[quantity, skin, k] = _rounded(found[quantity, skin, k], digits)
    return found


@compiled()
def _rounded(value: float, digits: int) -> float:  # pragma: no cover
    """Value rounded to significant digits."""
    if value == 0.0 or not math.isfinite(value):
        return value
    step = 10.0 ** (math.floor(math.log10(abs(value))) + 1 - digits)
    return np.rint(value / step) * step


class MeterErrors:
    """Meters in their sessions: fixed errors of each, the noise of each reading, and the display.

    Noise is drawn for whole sweeps, so that it does not depend on how steps are divided. Deviations
    are kept for each slot of a sweep, for readings that stay the same.
    """

    def __init__(
        self, setup: Setup, meter: Meter, seed: int, numbers: Sequence[int], noise: bool
    ) -> None:
        """numbers: of the sessions. noise: False for meters without errors and rounding."""
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
            self._fixed = np.ascontiguousarray(np.stack(fixed, axis=1)[..., 0])
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
        deviation, first = self._uniform, frequencies.start
        if deviation is None:
            slot, frequency = (interface, first), self._frequency[frequencies]
            latest = self._latest.get(slot)
            if latest is None or not np.array_equal(latest[0], reading):
                latest = self._latest[slot] = reading.copy(), self._deviation(reading, frequency)
            deviation = latest[1]
        given = np.ascontiguousarray(reading), deviation, self._fixed, self._noise, self._frequency
        return shown_quantities(*given, interface, first, self._digits, self._kind)

    def _deviation(self, reading: Complex, frequency: Real) -> Real:
        """Deviations of the fixed errors, then of the noise, shape (4, skin, frequency)."""
        each = self._readout.accuracy(reading, frequency), self._readout.noise(reading, frequency)
        return np.concatenate(each)

    def _draw(self) -> None:
        self._sweep += 1
        for k, random in enumerate(self._randoms):
            self._noise[:, k] = random.standard_normal((2, *self._shape))
