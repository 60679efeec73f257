"""Errors of a meter: by its data sheet, by a table of measured spreads, or by its converter."""

from __future__ import annotations

import math
import tomllib
from typing import TYPE_CHECKING, Annotated, Literal, Protocol, Self

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from ..arrays import Complex, Integer, Real
from ..meters.accuracy_table import ACCURACY_TABLES, AccuracyTable
from ..meters.offset_accuracy import OffsetAccuracy
from .keys import OrText
from .ranges import Frequency, Resistance
from .validation import Number, Table, Whole, validated, within

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .contacts import Interface
    from .meter import Readout


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


OF_UNIFORM = 1 / np.sqrt(3)
"""Standard deviation over the bound of an error that is uniform between its bounds. Where nothing
but bounds are known, this is the distribution to assume: JCGM 100:2008, 4.3.7."""


def accuracy_names() -> list[str]:
    """Names of the built-in accuracy tables."""
    return sorted(path.stem for path in ACCURACY_TABLES.glob("*.toml"))


def _accuracy(given: object) -> object:
    if isinstance(given, AccuracyTable | OffsetAccuracy):
        return given
    if given in accuracy_names():
        given = tomllib.loads((ACCURACY_TABLES / f"{given}.toml").read_text(encoding="utf-8"))
    if not isinstance(given, dict):
        names = ", ".join(accuracy_names())
        raise ValueError(f"must be a table or one of {names}, got {given!r}")
    return validated(OffsetAccuracy if "band" in given else AccuracyTable, given)


class DataSheet(Table):
    """Accuracy as a maker states it: bounds on |Z| and phase that depend on |Z| and frequency.

    An error is uniform between its bounds, so its standard deviation is the bound over root 3.
    accuracy: name of a built-in accuracy, or a table of its own, by range or by offsets. speed,
    level [V], cable [m]: of accuracies by range. noise: standard deviation of the noise of a
    reading over that of the accuracy. A bound includes the noise, so 1 is its upper limit.
    """

    accuracy: Annotated[AccuracyTable | OffsetAccuracy, BeforeValidator(_accuracy), OrText("name")]
    speed: Literal["FAST", "MEDIUM", "SLOW", "SLOW2"] = "MEDIUM"
    level: Annotated[Number, within(1e-3, 100.0, "V", "no LCR meter has another level")] = 1.0
    cable: Literal[0, 1] = 0
    noise: Annotated[Number, within(1e-6, 1.0, "(relative)", "a bound includes noise")] = 1.0

    @model_validator(mode="after")
    def _known_conditions(self) -> Self:
        defaults = {"speed": "MEDIUM", "level": 1.0, "cable": 0}
        changed = [name for name, own in defaults.items() if getattr(self, name) != own]
        if changed and isinstance(self.accuracy, OffsetAccuracy):
            raise ValueError(
                f"`{changed[0]}` is for accuracies by range; {self.accuracy.name} states one level "
                "and one speed"
            )
        return self

    def deviations(self, reading: Complex, frequency: Real) -> Real:
        """Standard deviations of ln |Z| and of phase by the accuracy, shape (2, ...)."""
        size = np.abs(reading)
        if isinstance(self.accuracy, OffsetAccuracy):
            return OF_UNIFORM * self.accuracy.bounds(size, frequency)
        bounds = self.accuracy.bounds(size, frequency, self.speed, self.level, self.cable)
        return OF_UNIFORM * bounds

    @property
    def smallest_deviation(self) -> float:
        """Lower limit of the deviations of all readings."""
        factors = getattr(self.accuracy, "coefficients", None)
        factor = min(factors.speed.at(self.speed), 1.0) if factors else 1.0
        return float(OF_UNIFORM * factor * self.accuracy.smallest_bound)


class SpreadTable(Table):
    """Measured spreads of repeated readings, on a grid of impedances and frequencies.

    Logarithms are interpolated linearly in the logarithms of |Z| and frequency; beyond the grid,
    the nearest number holds. impedance [ohm], frequency [Hz]: ascending. magnitude: spread of |Z|
    as a fraction, a row for each impedance with a number for each frequency. phase [rad]: spread of
    the phase, in such rows.
    """

    impedance: Annotated[tuple[Resistance, ...], Field(min_length=1, max_length=1000)]
    frequency: Annotated[tuple[Frequency, ...], Field(min_length=1, max_length=1000)]
    magnitude: tuple[tuple[Number, ...], ...]
    phase: tuple[tuple[Number, ...], ...]

    @model_validator(mode="after")
    def _complete(self) -> Self:
        shape = len(self.impedance), len(self.frequency)
        for name in ("impedance", "frequency"):
            nodes = getattr(self, name)
            if not nodes[0] > 0 or list(nodes) != sorted(set(nodes)):
                raise ValueError(f"`{name}` must ascend and be > 0, got {list(nodes)}")
        for name in ("magnitude", "phase"):
            rows = getattr(self, name)
            if [len(row) for row in rows] != [shape[1]] * shape[0]:
                raise ValueError(
                    f"`{name}` must have {shape[0]} rows of {shape[1]} numbers, one row for each "
                    "impedance and one number for each frequency"
                )
            if not all(0 < each <= 1 for row in rows for each in row):
                raise ValueError(f"`{name}` must be > 0 and <= 1 throughout")
        return self

    def deviations(self, reading: Complex, frequency: Real) -> Real:
        """Standard deviations of ln |Z| and of phase, shape (2, ...)."""
        row, up = _between(self.impedance, np.abs(reading))
        column, right = _between(self.frequency, np.broadcast_to(frequency, reading.shape))
        values = np.log(np.array([self.magnitude, self.phase]))
        last_row, last_column = len(self.impedance) - 1, len(self.frequency) - 1
        above, beyond = np.minimum(row + 1, last_row), np.minimum(column + 1, last_column)
        low = (1 - right) * values[:, row, column] + right * values[:, row, beyond]
        high = (1 - right) * values[:, above, column] + right * values[:, above, beyond]
        return np.exp((1 - up) * low + up * high)

    @property
    def smallest_deviation(self) -> float:
        """Smallest number of the table."""
        return min(min(map(min, self.magnitude)), min(map(min, self.phase)))


def _between(nodes: tuple[float, ...], x: Real) -> tuple[Integer, Real]:
    """Index of the node below each x, and its share of the way to the next, in logarithms."""
    if len(nodes) == 1:
        return np.zeros(x.shape, dtype=np.int64), np.zeros(x.shape)
    logarithm, at = np.log(nodes), np.log(np.clip(x, nodes[0], nodes[-1]))
    number = np.clip(np.searchsorted(logarithm, at, side="right") - 1, 0, len(nodes) - 2)
    return number, (at - logarithm[number]) / (logarithm[number + 1] - logarithm[number])


NO_SUCH = "no source or converter has such a value"
Volts = Annotated[Number, within(1e-6, 1e4, "V", NO_SUCH)]


class Converter(Table):
    """Source and analogue-to-digital converter of a reader of gains.

    source_amplitude [V]: of V_s. noise [V rms]: of each sample of the node's voltage. bits,
    full_scale [V]: of the converter, from its lowest to its highest voltage; rounding is counted as
    noise of a step over root 12 in each sample, which holds from noise of half a step on. samples:
    number of samples of one reading; each component of V then has the noise of a sample times root
    2/samples. The deviations of ln |V / V_s| and of the phase are that noise over the amplitude of
    V.
    """

    source_amplitude: Volts
    noise: Annotated[Number, within(0.0, 1e3, "V", NO_SUCH)] = 0.0
    bits: Annotated[Whole, Field(ge=1, le=32)] | None = None
    full_scale: Volts | None = None
    samples: Annotated[Whole, Field(ge=2, le=10**9)] = 2

    @model_validator(mode="after")
    def _noise_by_volts_or_bits(self) -> Self:
        if (self.bits is None) != (self.full_scale is None):
            raise ValueError("takes bits and full_scale together, got one of them")
        if self.full_scale is not None and self.source_amplitude > self.full_scale / 2:
            raise ValueError(
                f"`source_amplitude` must be <= {self.full_scale / 2:g} V, half of full_scale, got "
                f"{self.source_amplitude:g}: the converter would clip the voltage of the source"
            )
        if not (self.noise or self.bits):
            raise ValueError("needs noise, in V rms, or bits with full_scale")
        return self

    @property
    def component_noise(self) -> float:
        """Noise of each component of a reading's amplitude, V."""
        step = 0.0 if self.full_scale is None else self.full_scale / 2 ** (self.bits or 0)
        return math.hypot(self.noise, step / math.sqrt(12)) * math.sqrt(2 / self.samples)

    @property
    def smallest_deviation(self) -> float:
        """Deviation of the largest gain of a passive skin, 1."""
        return self.component_noise / self.source_amplitude

    def deviation(self, gain: Complex) -> Real:
        """Deviation of ln |V / V_s|, and of the phase in rad; shape of the gain."""
        return self.smallest_deviation / np.abs(gain)


def check_readout(interfaces: Sequence[Interface], readout: Readout) -> None:
    """Raises ValueError for errors of a readout that its reader cannot have."""
    reader = interfaces[0].reader
    if readout.converter is not None and reader != "gain":
        raise ValueError(
            '`readout.converter` is of interfaces with reader = "gain", got '
            f'"{reader}" of {interfaces[0].name!r}'
        )
    for name in ("data_sheet", "spread"):
        if reader == "gain" and getattr(readout, name) is not None:
            raise ValueError(
                f"`readout.{name}` is of impedances, and the readings are gains; give "
                "`readout.converter` in its place"
            )
