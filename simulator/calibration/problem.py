"""The least-squares problem: residuals in units of the meter's error, and their exact slopes.

Unknowns are parameters, strengths of presses, and the meter's fixed errors of each session (one for
each range of a meter, or each interface), all counted in deviations of their priors from the
centers; every prior is one more residual that is the unknown itself. With the meter's fixed errors
as unknowns of known spread, independent residuals are the same as residuals whitened by the
covariance of `ErrorModel` over a session.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..measure.readout import ErrorModel, observed, observed_slope
from ..models.parameters import FACTORS, KNOWN, foam_parts
from ..press.press import pressed_factor
from ..scene.meter import Readout
from .centered_model import Around
from .likelihood.qr_reduction import Block, Condensed, condensed
from .measurements import MeasuredSweep, Measurements
from .prior import Prior

MIN_RISE = -0.9


@dataclass(frozen=True)
class FitSpec:
    """What is fitted to what.

    fitted: priors of the parameters that are fitted. fixed: values of the others. strengths:
    whether those of presses are unknown.
    """

    measurements: Measurements
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
        u = np.zeros(len(self.fitted) + self.touch_count + self.error_count)
        for k, (name, prior) in enumerate(self.fitted.items()):
            u[k] = (values[name] - prior.center) / prior.deviation
        return u

    @property
    def touch_count(self) -> int:
        """Unknown strengths."""
        return sum(map(len, self.spreads))

    @property
    def error_count(self) -> int:
        """Fixed errors of the meter: of |Z| and phase, for each session."""
        return len(self.accuracy) * len(self.measurements.sessions) * self.measurements.fixed

    @cached_property
    def accuracy(self) -> dict[int, float]:
        """Spread of the meter's fixed errors: 0 of |Z|, 1 of the phase, where there is any."""
        both = self.readout.magnitude_accuracy, self.readout.phase_accuracy
        return {half: spread for half, spread in enumerate(both) if spread > 0}

    @cached_property
    def spreads(self) -> list[list[float]]:
        """Standard deviation of the rise of each touch of each reading that is unknown."""
        scene = self.measurements.scene
        relative = scene.press.factor_spread
        if not (self.strengths and relative > 0):
            return [[] for _ in self.measurements.sweeps]
        pressed = [reading.press.touches for reading in self.measurements.sweeps]
        rises = [[pressed_factor(scene, touch) - 1 for touch in each] for each in pressed]
        return [[relative * max(abs(own), 1e-3) for own in each if own] for each in rises]


class LeastSquaresProblem:
    """Residuals and Jacobian at any unknowns, by one model."""

    def __init__(self, spec: FitSpec, around: Around) -> None:
        self.spec, self.around = spec, around
        self.cells = [around.model.cells(each.press) for each in spec.measurements.sweeps]
        self._deviation = np.stack([deviation_of(spec, each) for each in spec.measurements.sweeps])
        self._last: tuple[bytes, list[Block]] | None = None
        self._turned: tuple[bytes, float, Condensed] | None = None

    def residuals(self, u: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of all readings, then of all priors; shape (residual,)."""
        found = np.empty(self._deviation.shape)
        for block in self._blocks(u):
            found[block.readings] = block.off
        return np.concatenate([found.ravel(), u])

    def jacobian(self, u: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of the residuals, exact; shape (residual, unknown)."""
        slopes = np.zeros((*self._deviation.shape, len(u)))
        for block in self._blocks(u):
            slopes[block.readings[:, None], :, block.columns] = block.slopes.transpose(0, 2, 1)
        return np.vstack([slopes.reshape(-1, len(u)), np.eye(len(u))])

    def condensed(self, u: NDArray[np.float64], scale: float = 1.0) -> Condensed:
        """Residuals and Jacobian turned to few more rows than unknowns: all their products are
        those of the whole ones. scale: that chi-squared is over, but not priors of parameters."""
        if self._turned is None or self._turned[:2] != (u.tobytes(), scale):
            found = condensed(self._blocks(u), u, len(self.spec.fitted), scale)
            self._turned = u.tobytes(), scale, found
        return self._turned[2]

    def bounds(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Of the unknowns: what makes sense, and what the model reaches."""
        low = np.full(len(self.spec.unknowns(self._centers)), -np.inf)
        high = -low
        for k, (name, prior) in enumerate(self.spec.fitted.items()):
            limits = prior.low, prior.high
            if name in FACTORS:
                about, reach = self.around.about[name], self.around.reach(name)
                limits = about - reach, about + reach
            low[k], high[k] = (np.array(limits) - prior.center) / prior.deviation
        rises, spreads = self._all_rises()
        of_touches = slice(len(self.spec.fitted), len(self.spec.fitted) + len(rises))
        least = MIN_RISE if self.spec.measurements.scene.press.by_factor else 0.0
        low[of_touches] = np.minimum((least - rises) / spreads, -1e-3)
        return low, high

    def rises(self, u: NDArray[np.float64], k: int) -> NDArray[np.float64]:
        """Of what the touches of one reading change: of c by their strengths first, then fingers,
        F."""
        rises, spreads = self.cells[k][1].copy(), self.spec.spreads[k]
        unknown = u[self._firsts[k] : self._firsts[k] + len(spreads)]
        rises[: len(spreads)] += np.array(spreads) * unknown
        return rises

    def strengths(self, u: NDArray[np.float64], k: int) -> NDArray[np.float64]:
        """Rises of c under the touches of one reading."""
        return self.rises(u, k)[self.cells[k][0] < foam_parts(self.spec.measurements.scene)]

    def fitted(self, u: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Z in ohm of each reading without the meter's errors, (reading, interface, frequency)."""
        found = np.empty(
            (len(self.cells), *self.spec.measurements.sweeps[0].Z.shape), dtype=complex
        )
        for block in self._blocks(u):
            found[block.readings] = block.Z
        return found

    @property
    def _centers(self) -> dict[str, float]:
        return {name: prior.center for name, prior in self.spec.fitted.items()}

    def _all_rises(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Of the touches of unknown strength, and their spreads."""
        known = [self.cells[k][1][: len(own)] for k, own in enumerate(self.spec.spreads)]
        rises = np.concatenate([np.zeros(0), *known])
        return rises, np.array([each for own in self.spec.spreads for each in own])

    def _blocks(self, u: NDArray[np.float64]) -> list[Block]:
        if self._last is None or self._last[0] != u.tobytes():
            self._last = u.tobytes(), [self._block(u, group) for group in self._groups]
        return self._last[1]

    @cached_property
    def _firsts(self) -> list[int]:
        """Of each reading, the first unknown that is the strength of one of its touches."""
        counts = np.cumsum([0, *map(len, self.spec.spreads[:-1])])
        return (len(self.spec.fitted) + counts).tolist()

    @cached_property
    def _groups(self) -> list[NDArray[np.int64]]:
        """Readings by how many touches they are of, and how many of these are unknown."""
        own = [(len(c), len(s)) for (c, _), s in zip(self.cells, self.spec.spreads, strict=True)]
        return [np.flatnonzero([each == kind for each in own]) for kind in sorted(set(own))]

    def _block(self, u: NDArray[np.float64], group: NDArray[np.int64]) -> Block:
        """Of readings of one group, over their own deviations."""
        asked, readings = self.spec, [self.spec.measurements.sweeps[k] for k in group]
        cells = np.stack([self.cells[k][0] for k in group])
        rises = np.stack([self.rises(u, int(k)) for k in group])
        response = self.around.respond_together(cells, rises, asked.values(u))
        parameters = [
            prior.deviation * observed_slope(response.Z, response.by_parameter[name])
            for name, prior in asked.fitted.items()
        ]
        spreads = np.array([asked.spreads[k] for k in group])
        touches = [
            spread[:, None] * observed_slope(response.Z, response.by_cell[..., touch])
            for touch, spread in enumerate(spreads.T)
        ]
        errors = self._errors[group]
        stacked = [np.stack(each, axis=2) for each in (touches, parameters) if each]
        slopes = np.concatenate([*stacked, errors], axis=2)
        columns = self._columns(group, readings)
        of_errors = columns[:, columns.shape[1] - errors.shape[2] :]
        measured = np.stack([reading.Z for reading in readings])
        off = difference(response.Z, measured) + np.einsum("kre,ke->kr", errors, u[of_errors])
        deviation = self._deviation[group][:, :, None]
        return Block(
            group, columns, len(touches), response.Z, off / deviation[..., 0], slopes / deviation
        )

    def _columns(
        self, group: NDArray[np.int64], readings: Sequence[MeasuredSweep]
    ) -> NDArray[np.int64]:
        """Unknowns that each reading depends on: its touches, parameters, errors of its session."""
        asked, count = self.spec, self._errors.shape[2]
        size = len(asked.fitted) + asked.touch_count + asked.error_count
        sessions = [asked.measurements.sessions.index(reading.session) for reading in readings]
        touches = len(asked.spreads[group[0]])
        return np.column_stack(
            [
                np.array([self._firsts[k] for k in group])[:, None] + np.arange(touches),
                np.tile(np.arange(len(asked.fitted)), (len(group), 1)),
                size - asked.error_count + count * np.array(sessions)[:, None] + np.arange(count),
            ]
        )

    @cached_property
    def _errors(self) -> NDArray[np.float64]:
        """How the meter's fixed errors of a session enter, shape (reading, 2 * Z.size, error)."""
        asked = self.spec
        which = np.stack([reading.fixed.ravel() for reading in asked.measurements.sweeps])
        own = np.eye(asked.measurements.fixed)[which]
        found = np.zeros((len(which), 2, which.shape[1], 0))
        for half, spread in asked.accuracy.items():
            entering = spread * np.eye(2)[half][:, None, None] * own[:, None]
            found = np.concatenate([found, entering], axis=-1)
        return found.reshape(len(which), 2 * which.shape[1], -1)


def deviation_of(spec: FitSpec, reading: MeasuredSweep) -> NDArray[np.float64]:
    """Of each number of a reading by the noise, shape (2 * Z.size,); infinite where none was
    read, or in no range that is known, which then counts for nothing."""
    used = spec.measurements.read & reading.known
    own = ErrorModel(spec.readout, np.ones_like(used), reading.averaged).deviation
    return np.where(np.tile(used.ravel(), 2), own, np.inf)


def difference(Z: NDArray[np.complex128], other: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Of ln |Z| and of phase, the latter within half a turn; shape (..., 2 * readings)."""
    return observed(Z / other)
