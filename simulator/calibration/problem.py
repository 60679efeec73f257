"""The least-squares problem: residuals in units of the meter's error, and their exact slopes.

Unknowns are parameters, strengths of presses, and the meter's fixed errors of each session and
interface, each counted in deviations of its prior from its center; every prior is one more residual
that is the unknown itself. With the meter's fixed errors as unknowns of known spread, independent
residuals are the same as residuals whitened by the covariance of `ErrorModel` over a session.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..measure.readout import ErrorModel, observed, observed_slope
from ..models.parameters import FACTORS, KNOWN
from ..press.press import pressed_factor
from ..scene.meter import Readout
from .measured import Measured, Reading
from .model import Around
from .prior import Prior

LEAST_RISE = -0.9


@dataclass(frozen=True)
class Asked:
    """What is fitted to what.

    fitted: priors of the parameters that are fitted. fixed: values of the others. strengths:
    whether those of presses are unknown.
    """

    measured: Measured
    readout: Readout
    fitted: Mapping[str, Prior]
    fixed: Mapping[str, float]
    strengths: bool = True

    @property
    def names(self) -> tuple[str, ...]:
        """Of the parameters that are fitted."""
        return tuple(self.fitted)

    def values(self, u: NDArray[np.float64]) -> dict[str, float]:
        """All parameters. u: unknowns, shape (unknown,)."""
        found = {
            name: float(np.clip(prior.center + prior.deviation * each, prior.low, prior.high))
            for (name, prior), each in zip(self.fitted.items(), u, strict=False)
        }
        both = {**self.fixed, **found}
        return {name: both[name] for name in KNOWN if name in both}

    def unknowns(self, values: Mapping[str, float]) -> NDArray[np.float64]:
        """From values of parameters; all else at its center."""
        u = np.zeros(len(self.fitted) + self.touches + self.errors)
        for k, (name, prior) in enumerate(self.fitted.items()):
            u[k] = (values[name] - prior.center) / prior.deviation
        return u

    @property
    def touches(self) -> int:
        """Unknown strengths."""
        return sum(map(len, self.spreads))

    @property
    def errors(self) -> int:
        """Fixed errors of the meter: of |Z| and phase, for each session and interface."""
        return len(self.accuracy) * len(self.measured.sessions) * self.interfaces

    @property
    def interfaces(self) -> int:
        """How many ways the meter was connected."""
        return len(self.measured.scene.interfaces)

    @cached_property
    def accuracy(self) -> dict[int, float]:
        """Spread of the meter's fixed errors: 0 of |Z|, 1 of the phase, where there is any."""
        both = self.readout.magnitude_accuracy, self.readout.phase_accuracy
        return {half: spread for half, spread in enumerate(both) if spread > 0}

    @cached_property
    def spreads(self) -> list[list[float]]:
        """Standard deviation of the rise of each touch of each reading that is unknown."""
        scene = self.measured.scene
        relative = scene.press.factor_spread
        if not (self.strengths and relative > 0):
            return [[] for _ in self.measured.readings]
        return [
            [relative * max(abs(pressed_factor(scene, touch) - 1), 1e-3) for touch in press.touches]
            for press in (reading.press for reading in self.measured.readings)
        ]


class Problem:
    """Residuals and Jacobian at any unknowns, by one model."""

    def __init__(self, asked: Asked, around: Around) -> None:
        self.asked, self.around = asked, around
        self.cells = [around.model.cells(each.press) for each in asked.measured.readings]
        self._last: tuple[bytes, NDArray[np.float64], NDArray[np.float64]] | None = None

    def residuals(self, u: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of all readings, then of all priors; shape (residual,)."""
        return self._evaluated(u)[0]

    def jacobian(self, u: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of the residuals, exact; shape (residual, unknown)."""
        return self._evaluated(u)[1]

    def bounds(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Of the unknowns: what makes sense, and what the model reaches."""
        low = np.full(len(self.asked.unknowns(self._centers)), -np.inf)
        high, reach = -low, self.around.reach
        for k, (name, prior) in enumerate(self.asked.fitted.items()):
            limits = prior.low, prior.high
            if name in FACTORS:
                about = self.around.about[name]
                limits = about - reach, about + reach
            low[k], high[k] = (np.array(limits) - prior.center) / prior.deviation
        rises, spreads = self._all_rises()
        of_touches = slice(len(self.asked.fitted), len(self.asked.fitted) + len(rises))
        least = LEAST_RISE if self.asked.measured.scene.press.plain else 0.0
        low[of_touches] = np.minimum((least - rises) / spreads, -1e-3)
        return low, high

    def rises(self, u: NDArray[np.float64], k: int) -> NDArray[np.float64]:
        """Of the touches of one reading."""
        rises, spreads = self.cells[k][1], self.asked.spreads[k]
        if not spreads:
            return rises
        first = len(self.asked.fitted) + sum(map(len, self.asked.spreads[:k]))
        return rises + np.array(spreads) * u[first : first + len(spreads)]

    def fitted(self, u: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Z in ohm of each reading without the meter's errors, (reading, interface, frequency)."""
        values = self.asked.values(u)
        return np.stack(
            [
                self.around.respond(cells, self.rises(u, k), values).Z
                for k, (cells, _) in enumerate(self.cells)
            ]
        )

    @property
    def _centers(self) -> dict[str, float]:
        return {name: prior.center for name, prior in self.asked.fitted.items()}

    def _all_rises(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Of the touches of unknown strength, and their spreads."""
        known = [self.cells[k][1] for k, own in enumerate(self.asked.spreads) if own]
        rises = np.concatenate([np.zeros(0), *known])
        return rises, np.array([each for own in self.asked.spreads for each in own])

    def _evaluated(self, u: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        if self._last is None or self._last[0] != u.tobytes():
            rows = [self._reading(u, k) for k in range(len(self.cells))]
            residuals, slopes = zip(*rows, strict=True)
            self._last = (
                u.tobytes(),
                np.concatenate([*residuals, u]),
                np.vstack([*slopes, np.eye(len(u))]),
            )
        return self._last[1:]

    def _reading(
        self, u: NDArray[np.float64], k: int
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Residuals of one reading, and their slopes, over its own deviations."""
        asked, reading = self.asked, self.asked.measured.readings[k]
        cells, rises = self.cells[k][0], self.rises(u, k)
        response = self.around.respond(cells, rises, asked.values(u))
        slopes = np.zeros((2 * reading.Z.size, len(u)))
        for column, (name, prior) in enumerate(asked.fitted.items()):
            slope = observed_slope(response.Z, response.by_parameter[name])
            slopes[:, column] = prior.deviation * slope
        first = len(asked.fitted) + sum(map(len, asked.spreads[:k]))
        for touch, spread in enumerate(asked.spreads[k]):
            slope = observed_slope(response.Z, response.by_cell[..., cells[touch]])
            slopes[:, first + touch] = spread * slope
        self._add_errors(slopes, reading)
        fixed = np.s_[len(u) - asked.errors :]
        off = difference(response.Z, reading.Z) + slopes[:, fixed] @ u[fixed]
        deviation = deviation_of(asked, reading)
        return off / deviation, slopes / deviation[:, None]

    def _add_errors(self, slopes: NDArray[np.float64], reading: Reading) -> None:
        """The meter's fixed errors of the reading's session enter as they are."""
        asked, frequencies = self.asked, reading.Z.shape[1]
        column = slopes.shape[1] - asked.errors
        column += asked.measured.sessions.index(reading.session) * (
            len(asked.accuracy) * asked.interfaces
        )
        for half, spread in asked.accuracy.items():
            for interface in range(asked.interfaces):
                row = (half * asked.interfaces + interface) * frequencies
                slopes[row : row + frequencies, column] = spread
                column += 1


def deviation_of(asked: Asked, reading: Reading) -> NDArray[np.float64]:
    """Of each number of a reading by the noise, shape (2 * Z.size,); infinite where none was
    read, which then counts for nothing."""
    own = ErrorModel(asked.readout, *reading.Z.shape, averaged=reading.averaged).deviation
    return np.where(np.tile(asked.measured.read.ravel(), 2), own, np.inf)


def difference(Z: NDArray[np.complex128], other: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Of ln |Z| and of phase, the latter within half a turn; shape (..., 2 * readings)."""
    return observed(Z / other)
