"""How well a meter reads, by conditions, and how long it takes."""

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
    """frequency: Hz. range: 1 to 10. level: open voltage at the terminals in V. cable: m."""

    frequency: float
    range: int
    speed: str = "MEDIUM"
    averaging: int = 1
    level: float = 1.0
    cable: int = 0

    @property
    def seconds(self) -> float:
        """Time of a measurement, see `reading_time`."""
        return reading_time(self.frequency, self.speed) * self.averaging


OUTPUT_RESISTANCE = 100.0
"""Of the generator, ohm."""


@dataclass(frozen=True)
class GeneratorLevel:
    """What the generator holds: level V its open voltage, CV the skin's voltage, CC its current.

    voltage, constant_voltage: V. constant_current: A.
    """

    level: str
    voltage: float
    constant_voltage: float
    constant_current: float

    @classmethod
    def of(cls, settings: Mapping[str, Any]) -> GeneratorLevel:
        """That of a meter's settings by name."""
        return cls(**{field.name: settings[field.name] for field in fields(cls)})

    def open_voltage(self, Z: complex) -> float:
        """The generator's voltage in V with the terminals open, behind its output resistance."""
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
    """Cells (A, B) of one range, one for each band; full_scale: ohm. Z: %. theta: degrees."""

    full_scale: Positive
    Z: BandErrors
    theta: BandErrors


class ErrorFactors(_AccuracyModel):
    """Factors of the error. level: (from V, factor). cable_1m: factor at 0 Hz, rise per kHz."""

    level: tuple[tuple[Error, Positive], ...]
    speed: dict[str, Positive]
    cable_1m: tuple[Positive, Error]


class RangeLimits(_AccuracyModel):
    """Least and most of |Z| over full scale that is guaranteed, and that is displayed at all."""

    guaranteed: tuple[Error, Positive]
    displayed: tuple[Error, Positive]


class AccuracyTable(_AccuracyModel):
    """A meter's table. band_starts, stop: Hz, ascending; a band ends where the next one starts."""

    name: str
    band_starts: tuple[Positive, ...]
    stop: Positive
    range: tuple[RangeErrors, ...]
    coefficients: ErrorFactors
    span: RangeLimits

    def has_range(self, range_number: int) -> bool:
        """Whether it has a row of this range; where not, `bound` tells that of the nearest."""
        scale = full_scale(range_number)
        return any(math.isclose(row.full_scale, scale) for row in self.range)

    def is_outside_guarantee(self, Z: complex, conditions: ReadingConditions) -> bool:
        """Whether a reading is known to be outside guaranteed accuracy under these conditions.

        A range of which it has no row is not: nothing is known of that.
        """
        low, high = self.span.guaranteed
        in_band = self.band_starts[0] <= conditions.frequency <= self.stop
        strong = conditions.level >= self.coefficients.level[0][0]
        within = low <= abs(Z) / full_scale(conditions.range) <= high
        return not (in_band and strong and within)

    def error_bounds(self, Z: complex, conditions: ReadingConditions) -> tuple[float, float]:
        """Bounds on the systematic error of |Z| (a fraction) and of the phase (rad).

        Where the table has no cell, those of the nearest range and band are taken.
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
        """The number of the lowest range that guarantees |Z|, the highest where none does."""
        most = self.span.guaranteed[1]
        return next((n for n in RANGES if abs(Z) <= most * full_scale(n)), RANGES[-1])

    def _factor(self, conditions: ReadingConditions) -> float:
        levels = self.coefficients.level
        level = next((k for volt, k in reversed(levels) if volt <= conditions.level), levels[0][1])
        at_0_Hz, rise = self.coefficients.cable_1m
        cable = at_0_Hz + rise * conditions.frequency / 1e3 if conditions.cable else 1.0
        return level * self.coefficients.speed[conditions.speed] * cable


def full_scale(range_number: int) -> float:
    """Full scale in ohm of a range by its number: 1 is 100 mohm, 10 is 100 Mohm."""
    return 10.0 ** (range_number - 2)


def read_table(path: Path = DERIVED_TABLE) -> AccuracyTable:
    """The table in a TOML file. Raises InputError naming the file, the key and what is wrong."""
    try:
        table = AccuracyTable.model_validate(inputs.tables(inputs.text(path, inputs.SETTINGS)))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: cannot be read as a table of accuracy: {error}") from error
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
                f"{path}: `{key}` does not fit: starts ascend, every range has one cell for each "
                "band, and every speed and level has its factor"
            )
