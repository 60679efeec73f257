"""Measurement of a skin: leads, frequencies, errors of the meter, and the experiment."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import (
    BeforeValidator,
    Field,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

from ..arrays import Complex, Real
from .foam import Celsius, Humid
from .keys import OrTable, OrText
from .meter_tables import Converter, DataSheet, SpreadTable, spread_over
from .multisine import Multisine, multisine_deviation, smallest_deviation
from .ranges import Capacitance, Frequency, Inductance, Phase, Resistance, Seed, Share
from .validation import Number, Table, Whole, validated, within

METERS = Path(__file__).parents[1] / "meters"


class FrequencyGrid(Table):
    """Evenly spaced frequencies, both ends included.

    start: the lowest. stop: the highest. points: their number. spacing: even in the logarithm of
    frequency, or in frequency. digits: significant digits to which they are rounded, 4 as LCR
    meters set them; by default they are not rounded.
    """

    start: Frequency
    stop: Frequency
    points: Annotated[Whole, Field(ge=2, le=100_000)]
    spacing: Literal["log", "linear"] = "log"
    digits: Annotated[Whole, Field(ge=2, le=17)] | None = None

    @model_validator(mode="after")
    def _start_below_stop(self) -> Self:
        if not self.start < self.stop:
            raise ValueError(f"start must be < stop, got {self.start:g} and {self.stop:g} Hz")
        return self

    def values(self) -> list[float]:
        """The frequencies, Hz."""
        space = np.geomspace if self.spacing == "log" else np.linspace
        values = space(self.start, self.stop, self.points).tolist()
        if self.digits is None:
            return values
        return [float(f"{each:.{self.digits}g}") for each in values]


def _listed(frequencies: object) -> object:
    if not isinstance(frequencies, dict):
        return frequencies
    return validated(FrequencyGrid, frequencies).values()


def ascending(frequencies: tuple[float, ...]) -> tuple[float, ...]:
    """Sorts frequencies. Raises ValueError for a repeated one."""
    distinct = tuple(sorted(set(frequencies)))
    if len(distinct) < len(frequencies):
        raise ValueError("frequencies must be distinct")
    return distinct


class Sweep(Table):
    """The frequencies [Hz] of one sweep, kept ascending.

    frequencies: a list of them, or a table of evenly spaced ones.
    """

    frequencies: Annotated[
        tuple[Frequency, ...],
        BeforeValidator(_listed),
        OrTable(FrequencyGrid),
        Field(min_length=1, max_length=100_000),
    ]

    @model_validator(mode="after")
    def _distinct_and_ascending(self) -> Self:
        object.__setattr__(self, "frequencies", ascending(self.frequencies))
        return self


class Readout(Table):
    """The meter's error on |Z| (a fraction) and phase (rad), and the digits it displays.

    Accuracy is the standard deviation of the error that is fixed during a session; noise is that of
    the error of each single reading. magnitude_accuracy: of |Z|, fixed during a session.
    phase_accuracy: of the phase, fixed during a session. magnitude_noise: of |Z|, of each reading.
    phase_noise: of the phase, of each reading. display_digits: significant digits to which readings
    are rounded. data_sheet: both by |Z| and frequency, in place of the four numbers. spread: noise
    as measured, in place of any other. multisine: the electronics of interfaces whose reader is
    "multisine"; converter: source and converter of interfaces whose reader is "gain"; their noise
    is added.
    """

    magnitude_accuracy: Share = 0.0
    phase_accuracy: Phase = 0.0
    magnitude_noise: Share = 0.0
    phase_noise: Phase = 0.0
    display_digits: Annotated[Whole, Field(ge=2, le=17)] = 6
    data_sheet: DataSheet | None = None
    spread: SpreadTable | None = None
    multisine: Multisine | None = None
    converter: Converter | None = None

    @model_validator(mode="after")
    def _stated_once(self) -> Self:
        noise = ("magnitude_noise", "phase_noise")
        both = {
            "data_sheet": ("magnitude_accuracy", "phase_accuracy", *noise),
            "spread": noise,
        }
        for table, numbers in both.items():
            given = [name for name in numbers if getattr(self, name)]
            if getattr(self, table) is not None and given:
                raise ValueError(f"`{given[0]}` and `{table}` state the same error: leave one out")
        return self

    @model_serializer(mode="wrap")
    def _without_absent_tables(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return {key: own for key, own in dump(self).items() if own is not None}

    @property
    def uniform(self) -> bool:
        """True if the errors are the same for all readings and frequencies."""
        tables = self.data_sheet, self.spread, self.multisine, self.converter
        return all(table is None for table in tables)

    @property
    def noisy(self) -> bool:
        """True if noise of magnitude and phase is > 0 for every reading."""
        return not self.uniform or (self.magnitude_noise > 0 and self.phase_noise > 0)

    @property
    def smallest_noise(self) -> float:
        """Smallest standard deviation of noise that a reading can have, of ln |Z| or phase."""
        if self.spread is not None:
            smallest = self.spread.smallest_deviation
        elif self.data_sheet is not None:
            smallest = self.data_sheet.noise * self.data_sheet.smallest_deviation
        else:
            smallest = min(self.magnitude_noise, self.phase_noise)
        added = [smallest_deviation(self.multisine)] if self.multisine else []
        added += [self.converter.smallest_deviation] if self.converter else []
        return math.hypot(smallest, *added)

    def noise(self, reading: Complex, frequency: Real) -> Real:
        """Noise of each reading, see `ReadoutErrors`."""
        own = self._noise_without_electronics(reading, frequency)
        if self.multisine is not None:
            own = np.hypot(own, multisine_deviation(self.multisine, reading, frequency))
        if self.converter is not None:
            own = np.hypot(own, self.converter.deviation(reading))
        return own

    def _noise_without_electronics(self, reading: Complex, frequency: Real) -> Real:
        if self.spread is not None:
            return self.spread.deviations(reading, frequency)
        if self.data_sheet is not None:
            return self.data_sheet.noise * self.data_sheet.deviations(reading, frequency)
        return spread_over((self.magnitude_noise, self.phase_noise), reading)

    def accuracy(self, reading: Complex, frequency: Real) -> Real:
        """Fixed error of each reading in a session, see `ReadoutErrors`."""
        if self.data_sheet is not None:
            return self.data_sheet.deviations(reading, frequency)
        return spread_over((self.magnitude_accuracy, self.phase_accuracy), reading)

    @property
    def exact(self) -> bool:
        """True if the only error of readings is the rounding to the displayed digits."""
        return self.uniform and not (
            self.magnitude_accuracy
            or self.phase_accuracy
            or self.magnitude_noise
            or self.phase_noise
        )


def meter_names() -> list[str]:
    """Names of the meters whose readouts are built in."""
    return sorted(path.stem for path in METERS.glob("*.toml"))


def _named(given: object) -> object:
    if not isinstance(given, str):
        return given
    if given not in meter_names():
        raise ValueError(f"must be a table or one of {', '.join(meter_names())}, got {given!r}")
    return tomllib.loads((METERS / f"{given}.toml").read_text(encoding="utf-8"))


AnyReadout = Annotated[Readout, BeforeValidator(_named), OrText()]


def built_in(name: str) -> Readout:
    """The readout of a built-in meter, one of `meter_names`."""
    return Readout.model_validate(_named(name))


MAX_REPETITIONS = 10**6
"""Largest number of repetitions; with a press every second they take eleven days."""


Wait = Annotated[Number, within(0.0, 1e7, "s", "no measurement takes months")]


class Timing(Table):
    """Times of presses and durations of their sweeps, for foam that creeps.

    A press begins `before` [s] before its sweep and ends with the sweep; after a `pause` [s] the
    next press begins. before: from the beginning of a press to that of its sweep. pause: from the
    end of a press to the beginning of the next; 0 changes one press into the next one without
    release. speed: of the meter, which reads one frequency after the other, lowest first, and one
    interface after the other; a multisine reader reads all frequencies of an interface in its
    frames instead. averaging: number of readings that the meter averages.
    """

    before: Wait = 0.0
    pause: Wait = 1.0
    speed: Literal["FAST", "MEDIUM", "SLOW", "SLOW2"] = "MEDIUM"
    averaging: Annotated[Whole, Field(ge=1, le=256)] = 1


class Experiment(Table):
    """Repetitions of the presses of every pixel, and the conditions of the experiment.

    repetitions: presses of each pixel. seed: of the random numbers; equal seeds give equal sweeps.
    unpressed: true makes the unpressed skin a class of its own. timing: of presses and readings.
    temperature, humidity: of the simulation; by default the references of the foam's tables.
    """

    repetitions: Annotated[Whole, Field(ge=1, le=MAX_REPETITIONS)] = 6
    unpressed: bool = True
    seed: Seed = 1
    timing: Timing | None = None
    temperature: Celsius | None = None
    humidity: Humid | None = None

    @property
    def timed(self) -> Timing:
        """The timing, or the default one if none is given."""
        return self.timing or Timing()


class Leads(Table):
    """Stray capacitance [F] in parallel with the skin; resistance [ohm] and inductance [H] in
    series with both. They are equal at all interfaces.

    resistance: of both leads together. inductance: of both leads together. stray_capacitance:
    between the leads. guard: fraction of the stray capacitance that a driven guard removes.
    """

    resistance: Resistance = 0.0
    inductance: Inductance = 0.0
    stray_capacitance: Capacitance = 0.0
    guard: Annotated[Number, Field(ge=0, le=1)] = 0.0

    @property
    def unguarded(self) -> float:
        """The stray capacitance that the meter reads, F."""
        return (1 - self.guard) * self.stray_capacitance

    @property
    def ideal(self) -> bool:
        """True if the leads do not change the readings."""
        return not (self.resistance or self.inductance or self.unguarded)

    def branches(self, frequency: Real) -> tuple[Complex, Complex]:
        """R + j omega L in series, ohm, and j omega C in parallel, S; frequency [Hz] last."""
        omega = (2j * np.pi * frequency).astype(np.complex128)
        return self.resistance + omega * self.inductance, omega * self.unguarded

    def at_meter(self, Z: Complex, frequency: Real) -> Complex:
        """Z in ohm at the meter's end: R + j omega L + 1/(1/Z + j omega C); frequency [Hz] last."""
        series, parallel = self.branches(frequency)
        return series + Z / (1 + parallel * Z)

    def slopes(self, Z: Complex, frequency: Real) -> tuple[Complex, dict[str, Complex]]:
        """Derivatives of `at_meter` by Z, and by resistance, inductance and stray capacitance."""
        omega = np.broadcast_to((2j * np.pi * frequency).astype(np.complex128), Z.shape)
        by_skin = ((1 / (1 + omega * self.unguarded * Z)) ** 2).astype(np.complex128)
        return by_skin, {
            "lead_resistance": np.ones_like(Z),
            "lead_inductance": omega,
            "stray_capacitance": (-omega * Z**2 * by_skin).astype(np.complex128),
        }
