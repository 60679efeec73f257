"""Likelihood of presses by one sweep: what the meter observes of them, in units of its errors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

from ..arrays import Complex, Mask, Real
from ..measure.readout import ErrorModel, errors_of, observed, require_noise
from ..press.batch import NOTHING, PressBatch
from ..scene.parts import Meter, Setup

Solve = Callable[[PressBatch], Complex]
"""Function from presses to Z in ohm at the contacts, shape (press, interface, frequency)."""


class Likelihood:
    """Normal likelihood of the sweep of any press of one skin.

    Errors are those at the reading of the unpressed skin: one covariance holds for all presses, so
    that distances of readings are defined. Errors of the session are marginalized.
    """

    def __init__(self, solve: Solve, setup: Setup, meter: Meter, against_rest: int = 0) -> None:
        """against_rest: number of averaged baseline sweeps that are subtracted, 0 for none.

        Raises InputError for a meter without noise.
        """
        require_noise(meter.readout)
        self._solve, self.setup, self._meter = solve, setup, meter
        self._against_rest = against_rest

    @cached_property
    def errors(self) -> ErrorModel:
        """Errors of the meter."""
        own = self.setup, self._meter, self._against_rest
        return errors_of(*own, unpressed=lambda: self.impedances(PressBatch.of([NOTHING]))[0])

    def among(self, taken: Mask) -> ErrorModel:
        """Errors of some of the readings, True in a mask of shape (interface, frequency)."""
        return replace(self.errors, read=taken)

    def impedances(self, batch: PressBatch) -> Complex:
        """Readings in ohm or gains at the meter, shape (press, interface, frequency)."""
        return self.setup.at_meter(self._solve(batch))

    def observed(self, batch: PressBatch) -> Real:
        """ln |Z| and phase of all readings, shape (press, 2 * readings)."""
        return observed(self.impedances(batch))

    def whitened(self, batch: PressBatch) -> Real:
        """Readings with independent errors of deviation 1, shape (press, number)."""
        return self.errors.whitened(self.observed(batch))
