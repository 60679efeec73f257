"""Unknown parameters of a fit: names on request, starting point and priors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..arrays import Real
from ..measure.readout import ErrorModel
from ..models.heterogeneous.elements_model import single_field
from ..models.parameters import TABLE
from ..press.press import pressed_factor
from ..scene.meter import Readout
from ..sweeps import InputError
from .measurements import Measurements, SessionSweep
from .prior import Prior
from .student import StudentT

OTHERS = "others"
"""Stands for the names of all parameters that are not fitted."""


class Candidates(NamedTuple):
    """Unknown parameters: those to fit, and those that keep the scene's values."""

    fitted: list[str]
    not_fitted: list[str]


def candidates(
    measured: Measurements,
    free: Sequence[str],
    priors: Mapping[str, Prior],
    fit: Sequence[str],
    fix: Sequence[str],
) -> Candidates:
    """Unknown parameters, to fit or not. Those without a prior and those of `fix` are known.

    free: parameters that the scene depends on. fit: names to fit; where empty, all unknown ones
    except the ratio of sheets that one field describes, which depends on their sum only. Raises
    InputError for names that do not exist, that are in both lists, or that the scene does not
    depend on.
    """
    for option, names in (("fit", fit), ("fix", fix)):
        for name in names:
            if name not in TABLE and not (fit and name == OTHERS and name in fix):
                raise InputError(f"`{option}` must be one of {', '.join(TABLE)}, got {name!r}")
    for name in fit:
        if name in fix:
            raise InputError(f"{name} cannot be both fitted and fixed")
        if name not in free:
            raise InputError(
                f"{name} has no effect in this scene; parameters with one: {', '.join(free)}"
            )
        if name not in priors:
            raise InputError(f"{name} is known: [dataset.session] does not draw it")
    known = set(TABLE) - set(fit) if OTHERS in fix else set(fix)
    unknown = [name for name in TABLE if name in free and name in priors.keys() - known]
    if not unknown:
        raise InputError("every parameter is fixed: there is nothing to fit")
    in_series = (
        "sheet_resistance" in unknown
        and single_field(measured.parts.skin, measured.parts.setup) is not None
    )
    chosen = fit or [name for name in unknown if not (name == "sheet_mismatch" and in_series)]
    return Candidates(
        [name for name in unknown if name in chosen],
        [name for name in unknown if name not in chosen],
    )


@dataclass(frozen=True)
class FitSpec:
    """The parameters to fit and the measurements they are fitted to.

    fitted: priors of the fitted parameters. fixed: values of the others. strengths: True if the
    strengths of presses are unknown. tail: distribution of the errors of readings; None: normal.
    """

    measurements: Measurements
    readout: Readout
    fitted: Mapping[str, Prior]
    fixed: Mapping[str, float]
    strengths: bool = True
    tail: StudentT | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the fitted parameters."""
        return tuple(self.fitted)

    def values(self, u: Real) -> dict[str, float]:
        """Values of all parameters. u: unknowns, shape (unknown,)."""
        found = {
            name: float(np.clip(prior.center + prior.deviation * each, prior.low, prior.high))
            for (name, prior), each in zip(self.fitted.items(), u, strict=False)
        }
        both = {**self.fixed, **found}
        return {name: both[name] for name in TABLE if name in both} | both

    def unknowns(self, values: Mapping[str, float]) -> Real:
        """Unknowns at parameter values; all others at the center of their priors."""
        u = np.zeros(len(self.fitted) + self.touch_count + self.error_count)
        for k, (name, prior) in enumerate(self.fitted.items()):
            u[k] = (values[name] - prior.center) / prior.deviation
        return u

    @property
    def absolute_touches(self) -> bool:
        """True if a touch adds a capacitance that does not change with that of the skin."""
        return self.measurements.parts.plan.press.adds is not None

    def share_of_rises(self, u: Real) -> float:
        """Rises over those that the same touches make in the scene as it is stated."""
        return math.exp(-self.values(u)["capacitance"]) if self.absolute_touches else 1.0

    @property
    def touch_count(self) -> int:
        """Number of unknown strengths."""
        return sum(map(len, self.spreads))

    @property
    def error_count(self) -> int:
        """Number of fixed errors of the meter: of |Z| and phase, for each session."""
        return len(self.accuracy) * len(self.measurements.sessions) * self.measurements.fixed

    @cached_property
    def accuracy(self) -> dict[int, Real]:
        """Spreads of the meter's fixed errors > 0, by quantity: 0 for |Z|, 1 for the phase.

        Each has shape (sweep, reading).
        """
        Z = np.stack([reading.Z for reading in self.measurements.sweeps])
        both = self.readout.accuracy(Z, self.measurements.parts.setup.frequency)
        flat = both.reshape(2, len(Z), -1)[: self.measurements.per_reading]
        return {half: spread for half, spread in enumerate(flat) if spread.max() > 0}

    @cached_property
    def spreads(self) -> list[list[float]]:
        """Standard deviations of the unknown rises, for each touch of each sweep."""
        scene = self.measurements.parts
        relative = scene.plan.press.factor_spread
        if not (self.strengths and relative > 0):
            return [[] for _ in self.measurements.sweeps]
        pressed = [reading.press.touches for reading in self.measurements.sweeps]
        rises = [[pressed_factor(scene.skin, touch) - 1 for touch in each] for each in pressed]
        return [[relative * max(abs(own), 1e-3) for own in each if own] for each in rises]


def deviation_of(spec: FitSpec, reading: SessionSweep) -> Real:
    """Standard deviation of each number of a sweep by the noise, shape (2 * Z.size,).

    The noise is that of the measured Z. Infinite where nothing was read, for phases that are not
    known, or where the meter's range is unknown: such a number has no weight.
    """
    used, f = spec.measurements.read & reading.known, spec.measurements.parts.setup.frequency
    own = ErrorModel(
        spec.readout, np.ones_like(used), reading.averaged, reading=reading.Z, frequency=f
    ).deviation
    known = np.stack([used, used & (spec.measurements.per_reading == 2)])
    return np.where(known.ravel(), own, np.inf)
