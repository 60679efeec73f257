"""How a skin is measured: at which frequencies, by what kind of meter, how often each pixel."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, ValidationError, model_validator

from simulator.table import Table
from simulator.validation import Number, Whole, above_zero, at_least_zero, one_line

Hertz = Annotated[Number, above_zero("Hz")]
Relative = Annotated[Number, at_least_zero("of |Z|")]
Radian = Annotated[Number, at_least_zero("rad")]


class FrequencyGrid(Table):
    """Evenly spaced frequencies, both ends included."""

    start: Hertz
    stop: Hertz
    points: Annotated[Whole, Field(ge=2, le=100_000)]
    spacing: Literal["log", "linear"] = "log"

    @model_validator(mode="after")
    def _start_below_stop(self) -> Self:
        if not self.start < self.stop:
            raise ValueError(f"start must be < stop, got {self.start:g} and {self.stop:g} Hz")
        return self

    def values(self) -> list[float]:
        """The frequencies, Hz."""
        space = np.geomspace if self.spacing == "log" else np.linspace
        return space(self.start, self.stop, self.points).tolist()


def _listed(frequencies: object) -> object:
    if not isinstance(frequencies, dict):
        return frequencies
    try:
        return FrequencyGrid.model_validate(frequencies).values()
    except ValidationError as error:
        raise ValueError(one_line(error)) from error


class Sweep(Table):
    """The frequencies [Hz] of one sweep, kept ascending."""

    frequencies: Annotated[
        tuple[Hertz, ...], BeforeValidator(_listed), Field(min_length=1, max_length=100_000)
    ]

    @model_validator(mode="after")
    def _distinct_and_ascending(self) -> Self:
        ascending = tuple(sorted(set(self.frequencies)))
        if len(ascending) < len(self.frequencies):
            raise ValueError("frequencies must be distinct")
        object.__setattr__(self, "frequencies", ascending)
        return self


class Readout(Table):
    """The meter's error on |Z| (a fraction) and phase (rad), and the digits it displays.

    Accuracy is the standard deviation of a part that stays fixed for a session; noise that of a
    part drawn anew for each reading.
    """

    magnitude_accuracy: Relative = 0.0
    phase_accuracy: Radian = 0.0
    magnitude_noise: Relative = 0.0
    phase_noise: Radian = 0.0
    display_digits: Annotated[Whole, Field(ge=2, le=17)] = 6


class Experiment(Table):
    """How often every pixel is pressed, and whether the skin at rest is a class of its own."""

    repetitions: Annotated[Whole, Field(ge=1)] = 6
    unpressed: bool = True
    seed: Annotated[Whole, Field(ge=0)] = 1
