"""Accuracy table of a meter: bounds on its errors and times of its readings."""

from __future__ import annotations

import math
import tomllib
from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ...simulator.sweeps import InputError, inputs
from ...simulator.sweeps.reading_time import reading_time


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


DERIVED_TABLE = Path(__file__).with_name("accuracy-3522-50-derived.toml")
PROPORTIONAL_FROM = 1e3
SMALLEST_RATIO = 1e-9
RANGES = range(1, 11)

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]

Error = Annotated[float, Field(ge=0, allow_inf_nan=False)]

BandErrors = tuple[tuple[Error, Error], ...]


class _AccuracyModel(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class RangeErrors(_AccuracyModel):
    """Coefficients (A, B) of one range for each band. full_scale: ohm. Z: %. theta: degrees."""

    full_scale: Positive
    Z: BandErrors
    theta: BandErrors


class ErrorFactors(_AccuracyModel):
    """Factors on the error. level: (from V, factor). cable_1m: factor at 0 Hz, rise per kHz."""

    level: tuple[tuple[Error, Positive], ...]
    speed: dict[str, Positive]
    cable_1m: tuple[Positive, Error]


class RangeLimits(_AccuracyModel):
    """Limits (min, max) of |Z| over full scale: guaranteed accuracy, and display."""

    guaranteed: tuple[Error, Positive]
    displayed: tuple[Error, Positive]


class AccuracyTable(_AccuracyModel):
    """Accuracy table of a meter. band_starts, stop: Hz; a band ends at the start of the next."""

    name: str
    band_starts: tuple[Positive, ...]
    stop: Positive
    range: tuple[RangeErrors, ...]
    coefficients: ErrorFactors
    span: RangeLimits

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
        band = max(0, bisect_right(self.band_starts, conditions.frequency) - 1)
        scale = full_scale(conditions.range)
        row = min(self.range, key=lambda r: abs(math.log(r.full_scale / scale)))
        size = max(abs(Z) / scale, SMALLEST_RATIO)
        over = abs((10 * size if scale >= PROPORTIONAL_FROM else 1 / size) - 1)
        factor = self._factor(conditions)
        of_Z, of_theta = (A + B * over for A, B in (row.Z[band], row.theta[band]))
        return factor * of_Z / 100, factor * math.radians(of_theta)

    def fitting_range(self, Z: complex) -> int:
        """Number of the lowest range that guarantees |Z|; the highest range if none does."""
        most = self.span.guaranteed[1]
        return next((n for n in RANGES if abs(Z) <= most * full_scale(n)), RANGES[-1])

    def _factor(self, conditions: ReadingConditions) -> float:
        levels = self.coefficients.level
        level = next((k for volt, k in reversed(levels) if volt <= conditions.level), levels[0][1])
        at_0_Hz, rise = self.coefficients.cable_1m
        cable = at_0_Hz + rise * conditions.frequency / 1e3 if conditions.cable else 1.0
        return level * self.coefficients.speed[conditions.speed] * cable


def full_scale(range_number: int) -> float:
    """Full scale of a range in ohm, by its number: 1 is 100 mohm, 10 is 100 Mohm."""
    return 10.0 ** (range_number - 2)


def read_table(path: Path = DERIVED_TABLE) -> AccuracyTable:
    """Accuracy table in a TOML file. Raises InputError with the file, the key and the fault."""
    try:
        table = AccuracyTable.model_validate(inputs.tables(inputs.text(path, inputs.SETTINGS)))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: is no accuracy table in TOML: {error}") from error
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"]))
        raise InputError(f"{path}: `{key}`: {first['msg']}, got {first['input']!r}") from error
    _check_shape(table, path)
    return table


def _check_shape(table: AccuracyTable, path: Path) -> None:
    bands, edges = len(table.band_starts), [*table.band_starts, table.stop]
    problems = {
        "band_starts": edges != sorted(set(edges)) or not bands,
        "range": not table.range or any({len(r.Z), len(r.theta)} != {bands} for r in table.range),
        "coefficients.level": list(table.coefficients.level) != sorted(table.coefficients.level)
        or not table.coefficients.level,
        "coefficients.speed": set(table.coefficients.speed) != {"FAST", "MEDIUM", "SLOW", "SLOW2"},
    }
    for key, wrong in problems.items():
        if wrong:
            raise InputError(
                f"{path}: `{key}` does not fit: band starts must ascend, every range must have one "
                "cell for each band, and every speed and level must have its factor"
            )
