"""Accuracy table of a meter: bounds on its errors and times of its readings."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from ..arrays import Integer, Real
from ..sweeps import InputError, inputs
from ..sweeps.units import prefixed
from .reading_time import reading_time


@dataclass(frozen=True)
class ReadingConditions:
    """Conditions of one reading.

    frequency: Hz. range: 1 to 10. level: open voltage at the terminals, V. cable: length, m.
    """

    frequency: float
    range: int
    speed: str = "MEDIUM"
    averaging: int = 1
    level: float = 1.0
    cable: int = 0

    @property
    def seconds(self) -> float:
        """Time of a reading, s, see `reading_time`."""
        return reading_time(self.frequency, self.speed) * self.averaging


OUTPUT_RESISTANCE = 100.0
"""Output resistance of the generator, ohm."""


@dataclass(frozen=True)
class GeneratorLevel:
    """Quantity that the generator controls: open voltage (V), skin voltage (CV) or current (CC).

    voltage, constant_voltage: V. constant_current: A.
    """

    level: str
    voltage: float
    constant_voltage: float
    constant_current: float

    @classmethod
    def of(cls, settings: Mapping[str, Any]) -> GeneratorLevel:
        """Level in a meter's settings, given by name."""
        return cls(**{field.name: settings[field.name] for field in fields(cls)})

    def open_voltage(self, Z: complex) -> float:
        """Open-circuit voltage of the generator in V, behind its output resistance."""
        loop = abs(OUTPUT_RESISTANCE + Z)
        return {
            "V": self.voltage,
            "CV": self.constant_voltage * loop / max(abs(Z), SMALLEST_RATIO),
            "CC": self.constant_current * loop,
        }[self.level]


ACCURACY_TABLES = Path(__file__).parent / "accuracy"
DERIVED_TABLE = ACCURACY_TABLES / "3522-50-derived.toml"
PROPORTIONAL_FROM = 1e3
SMALLEST_RATIO = 1e-9
RANGES = range(1, 11)


Positive = Annotated[float, Field(strict=True, gt=0, allow_inf_nan=False)]

Error = Annotated[float, Field(strict=True, ge=0, allow_inf_nan=False)]

BandErrors = tuple[tuple[Error, Error], ...]


class AccuracyModel(BaseModel):
    """Base of the tables of an accuracy: no unknown keys, no changes."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class RangeErrors(AccuracyModel):
    """Coefficients (A, B) of one range for each band.

    full_scale [ohm]: |Z| at which the range is full. Z: coefficients of the error of |Z|, %. theta:
    coefficients of the error of the phase, degrees.
    """

    full_scale: Positive
    Z: BandErrors
    theta: BandErrors


class SpeedFactors(AccuracyModel):
    """Factors on the error by the speed of a reading.

    FAST, MEDIUM, SLOW, SLOW2: factor at this speed.
    """

    FAST: Positive
    MEDIUM: Positive
    SLOW: Positive
    SLOW2: Positive

    def at(self, speed: str) -> float:
        """Factor at a speed, given by name."""
        return {"FAST": self.FAST, "MEDIUM": self.MEDIUM, "SLOW": self.SLOW, "SLOW2": self.SLOW2}[
            speed
        ]


class ErrorFactors(AccuracyModel):
    """Factors on the error.

    level: pairs of the lowest voltage [V] at which a factor holds, and that factor. cable_1m: with
    1 m of cable, the factor at 0 Hz and its rise per kHz.
    """

    level: tuple[tuple[Error, Positive], ...]
    speed: SpeedFactors
    cable_1m: tuple[Positive, Error]


class RangeLimits(AccuracyModel):
    """Limits (min, max) of |Z| over full scale.

    guaranteed: between which the accuracy holds. displayed: between which the meter shows a value.
    """

    guaranteed: tuple[Error, Positive]
    displayed: tuple[Error, Positive]


class AccuracyTable(AccuracyModel):
    """Accuracy table of a meter, by ranges of |Z| and bands of frequency.

    name: of the meter. band_starts [Hz]: lowest frequency of each band; a band ends at the start of
    the next. stop [Hz]: end of the last band. range: the error in each measurement range.
    """

    name: str
    band_starts: tuple[Positive, ...]
    stop: Positive
    range: tuple[RangeErrors, ...]
    coefficients: ErrorFactors
    span: RangeLimits

    @model_validator(mode="after")
    def _complete(self) -> Self:
        bands, edges = len(self.band_starts), [*self.band_starts, self.stop]
        levels = list(self.coefficients.level)
        problems = {
            "band_starts": edges != sorted(set(edges)) or not bands,
            "range": not self.range or any({len(r.Z), len(r.theta)} != {bands} for r in self.range),
            "coefficients.level": levels != sorted(levels) or not levels,
        }
        for key, wrong in problems.items():
            if wrong:
                raise ValueError(
                    f"`{key}` does not fit: band starts must ascend, every range must have one "
                    "cell for each band, and levels must ascend"
                )
        if any(A <= 0 for row in self.range for A, _ in (*row.Z, *row.theta)):
            raise ValueError("`range`: the first number of every cell must be > 0")
        return self

    @property
    def smallest_bound(self) -> float:
        """Smallest bound of all cells on |Z| (a fraction) or phase (rad), without factors."""
        of_Z, of_theta = (min(A for row in cells for A, _ in row) for cells in self._all_cells)
        return min(of_Z / 100, math.radians(of_theta))

    @property
    def _all_cells(self) -> tuple[list[BandErrors], list[BandErrors]]:
        return [row.Z for row in self.range], [row.theta for row in self.range]

    def has_range(self, range_number: int) -> bool:
        """True if the table has this range. If not, `error_bounds` uses the nearest one."""
        scale = full_scale(range_number)
        return any(math.isclose(row.full_scale, scale) for row in self.range)

    def is_outside_guarantee(self, Z: complex, conditions: ReadingConditions) -> bool:
        """True if a reading is outside the guaranteed accuracy under these conditions.

        The limits of a range hold for ranges without a row, too.
        """
        low, high = self.span.guaranteed
        in_band = self.band_starts[0] <= conditions.frequency <= self.stop
        strong = conditions.level >= self.coefficients.level[0][0]
        within = low <= abs(Z) / full_scale(conditions.range) <= high
        return not (in_band and strong and within)

    def error_bounds(self, Z: complex, conditions: ReadingConditions) -> tuple[float, float]:
        """Bounds on the systematic errors of |Z| (a fraction) and of the phase (rad).

        A range or band that the table lacks is replaced by the nearest one.
        """
        size, frequency = np.array([abs(Z)]), np.array([conditions.frequency])
        of_Z, of_theta = self._bounds(size, frequency, np.array([conditions.range]), conditions)
        return float(of_Z[0]), float(of_theta[0])

    def bounds(self, size: Real, frequency: Real, speed: str, level: float, cable: int) -> Real:
        """Bounds of `error_bounds`, each in the range that fits the reading, shape (2, ...).

        size: |Z| in ohm. frequency: Hz, along the last axis.
        """
        conditions = ReadingConditions(0.0, 0, speed, level=level, cable=cable)
        return self._bounds(size, frequency, self._fitting_ranges(size), conditions)

    def fitting_range(self, Z: complex) -> int:
        """Number of the lowest range that guarantees |Z|; the highest range if none does."""
        return int(self._fitting_ranges(np.array(abs(Z))))

    def _fitting_ranges(self, size: Real) -> Integer:
        highest = self.span.guaranteed[1] * FULL_SCALES
        return np.minimum(RANGES[0] + np.searchsorted(highest, size), RANGES[-1])

    def _bounds(
        self, size: Real, frequency: Real, number: Integer, conditions: ReadingConditions
    ) -> Real:
        band = np.maximum(np.searchsorted(self.band_starts, frequency, side="right") - 1, 0)
        scale = FULL_SCALES[number - RANGES[0]]
        rows = np.log([row.full_scale for row in self.range])
        row = np.abs(rows - np.log(scale)[..., None]).argmin(axis=-1)
        ratio = np.maximum(size / scale, SMALLEST_RATIO)
        over = np.abs(np.where(scale >= PROPORTIONAL_FROM, 10 * ratio, 1 / ratio) - 1)
        A, B = np.moveaxis(np.array(self._all_cells)[:, row, band], -1, 0)
        per_unit = np.array([1 / 100, math.pi / 180]).reshape(2, *(1,) * size.ndim)
        return self._factor(frequency, conditions) * (A + B * over) * per_unit

    def _factor(self, frequency: Real, conditions: ReadingConditions) -> Real:
        levels = self.coefficients.level
        level = next((k for volt, k in reversed(levels) if volt <= conditions.level), levels[0][1])
        at_0_Hz, rise = self.coefficients.cable_1m
        cable = at_0_Hz + rise * frequency / 1e3 if conditions.cable else np.ones_like(frequency)
        return level * self.coefficients.speed.at(conditions.speed) * cable


def full_scale(range_number: int) -> float:
    """Full scale of a range in ohm, by its number: 1 is 100 mohm, 10 is 100 Mohm."""
    return 10.0 ** (range_number - 2)


FULL_SCALES = np.array([full_scale(number) for number in RANGES])
"""Full scales of all ranges, ohm."""


def read_table(path: Path = DERIVED_TABLE) -> AccuracyTable:
    """Accuracy table in a TOML file. Raises InputError with the file, the key and the fault."""
    try:
        table = AccuracyTable.model_validate(inputs.tables(inputs.text(path, inputs.SETTINGS)))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: is no accuracy table in TOML: {error}") from error
    except ValidationError as error:
        first = error.errors()[0]
        if first["type"] == "value_error":
            raise InputError(f"{path}: {first['msg'].removeprefix('Value error, ')}") from error
        key = ".".join(map(str, first["loc"]))
        raise InputError(f"{path}: `{key}`: {first['msg']}, got {first['input']!r}") from error
    return table


METER_BANDS = {
    "IM3523": (40.0, 200e3),
    "IM3533": (1e-3, 200e3),
    "IM3536": (4.0, 8e6),
    "IM3570": (4.0, 5e6),
    "E4980A": (20.0, 2e6),
    "E4980AL": (20.0, 1e6),
    "4284A": (20.0, 1e6),
    "E4990A": (20.0, 120e6),
}
"""Lowest and highest frequency of each model in Hz; source: specifications by Hioki and Keysight.

E4980AL with its option 102, E4990A with its option 120; with another one the meter itself refuses
what it lacks, or is found at another frequency."""
VIRTUAL_MODEL = "IM3523"
"""The model that the virtual meter imitates."""


def outside_band(
    model: str, frequencies: Iterable[float], band: tuple[float, float] | None = None
) -> str:
    """Message with a model's range and the frequencies [Hz] outside it; empty if there are none.

    It names the models that read all of them.

    band: lowest and highest frequency, Hz; default: that of METER_BANDS.
    """
    low, high = band or METER_BANDS[model]
    wanted = list(frequencies)
    outside = [each for each in wanted if not low <= each <= high]
    if not outside:
        return ""
    shown = ", ".join(_hertz(each) for each in outside[:3])
    shown += f" and {len(outside) - 3} more" if len(outside) > 3 else ""
    are = "is" if len(outside) == 1 else "are"
    others = reaching(wanted)
    read_by = f" (within reach of {', '.join(others)})" if others else ""
    return f"meter {model} reads {_hertz(low)} to {_hertz(high)}; {shown} {are} outside{read_by}"


def reaching(frequencies: Iterable[float]) -> list[str]:
    """Models that read all of these frequencies [Hz]."""
    wanted = list(frequencies)
    return [
        model
        for model, (low, high) in METER_BANDS.items()
        if all(low <= each <= high for each in wanted)
    ]


def _hertz(frequency: float) -> str:
    return prefixed(frequency, "Hz")
