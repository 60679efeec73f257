"""Standard deviations of a meter's errors, for any reading: the interface of all readouts."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ...arrays import Complex, Real


class ReadoutErrors(Protocol):
    """Errors of readings: complex impedances in ohm, or whatever else a meter reads.

    Deviations have shape (2, ..., interface, frequency): of ln |reading|, then of its phase in rad.
    reading: shape (..., interface, frequency). frequency: Hz, shape (frequency,).
    """

    @property
    def uniform(self) -> bool:
        """True if the deviations are the same for all readings and frequencies."""
        ...

    @property
    def noisy(self) -> bool:
        """True if noise of magnitude and phase is > 0 for every reading."""
        ...

    @property
    def smallest_noise(self) -> float:
        """Smallest deviation of noise that a reading can have, of ln |reading| or phase."""
        ...

    def noise(self, reading: Complex, frequency: Real) -> Real:
        """Deviations of the error of each single reading; may be a read-only view."""
        ...

    def accuracy(self, reading: Complex, frequency: Real) -> Real:
        """Deviations of the error that is fixed during a session; may be a read-only view.

        One draw for each interface is multiplied by them, so that errors of one interface are fully
        correlated over frequency.
        """
        ...


def spread_over(values: tuple[float, float], reading: Complex) -> Real:
    """Deviations that are equal for all readings, as a read-only view."""
    both = np.array(values, dtype=np.float64).reshape(2, *(1,) * reading.ndim)
    return np.broadcast_to(both, (2, *reading.shape))
