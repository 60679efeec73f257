"""What is there: a skin, its contacts, the ways a meter is connected, and what is measured.

All lengths in m, resistances in ohm, frequencies in Hz. x runs along `length`, y along `width`;
pixel (1, 1) lies at the corner x = y = 0.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    ValidationError,
    model_validator,
)

from simulator.frequency import Loss
from simulator.leads import Leads
from simulator.press import Press, Touch
from simulator.randomisation import Randomisation
from simulator.table import Table
from simulator.validation import (
    Number,
    Whole,
    above_zero,
    at_least_zero,
    one_line,
    single_line,
    whole_within_rounding,
)
from simulator.wiring import check_wiring

VACUUM_PERMITTIVITY = 8.8541878128e-12

Metre = Annotated[Number, above_zero("m")]
Hertz = Annotated[Number, above_zero("Hz")]
Relative = Annotated[Number, at_least_zero("of |Z|")]
Radian = Annotated[Number, at_least_zero("rad")]
Fraction = Annotated[Number, Field(ge=0, le=1), AfterValidator(whole_within_rounding)]
Name = Annotated[str, Field(min_length=1), AfterValidator(single_line)]
Electrode = Literal["top", "bottom"]
Edge = Literal["left", "right", "bottom", "top"]


class Sheet(Table):
    """An electrode sheet of uniform sheet resistance [ohm/sq]."""

    sheet_resistance: Annotated[Number, above_zero("ohm/sq")]


class Foam(Table):
    """The dielectric: capacitance per area [F/m²], or what it follows from, and its losses.

    loss_tangent: of jwC (1 - j tan d). phase_exponent: a of a constant-phase capacitance (jw)^a,
    which has the size that is named at 1 kHz; 1 is an ideal one.
    """

    capacitance_per_area: Annotated[Number, above_zero("F/m²")] | None = None
    thickness: Metre | None = None
    relative_permittivity: Annotated[Number, Field(ge=1, allow_inf_nan=False)] | None = None
    loss_tangent: Annotated[Number, at_least_zero("(tan d)")] = 0.0
    phase_exponent: Annotated[Number, Field(gt=0.5, le=1)] = 1.0

    @property
    def loss(self) -> Loss:
        """Its losses as the equations take them."""
        return Loss(self.loss_tangent, self.phase_exponent)

    @property
    def rest_capacitance_per_area(self) -> float:
        """c of the foam at rest, F/m²."""
        if self.capacitance_per_area is not None:
            return self.capacitance_per_area
        assert self.thickness is not None and self.relative_permittivity is not None
        return VACUUM_PERMITTIVITY * self.relative_permittivity / self.thickness

    @model_validator(mode="after")
    def _one_way_to_the_capacitance(self) -> Self:
        geometry = (self.thickness, self.relative_permittivity)
        direct = self.capacitance_per_area is not None
        if geometry.count(None) == 1 or direct == (None not in geometry):
            raise ValueError(
                "needs either capacitance_per_area, or thickness with relative_permittivity"
            )
        return self


class Skin(Table):
    """Two electrode sheets around a foam."""

    length: Metre
    width: Metre
    top: Sheet
    bottom: Sheet
    foam: Foam

    def sheet(self, electrode: Electrode) -> Sheet:
        """The sheet that is the named electrode."""
        return self.top if electrode == "top" else self.bottom


class Contact(Table):
    """A foil strip on one electrode: an equipotential terminal along part of an edge."""

    name: Name
    electrode: Electrode
    edge: Edge
    span: tuple[Fraction, Fraction] = (0.0, 1.0)
    resistance: Annotated[Number, at_least_zero("ohm m")] = 0.0

    @property
    def ideal(self) -> bool:
        """Whether it holds its part of the edge at one potential."""
        return self.resistance == 0

    def ends(self, skin: Skin) -> tuple[tuple[float, float], tuple[float, float]]:
        """Both end points (x, y) in m, the low-coordinate end first."""
        low, high = self.span
        if self.edge in ("left", "right"):
            x = 0.0 if self.edge == "left" else skin.length
            return (x, low * skin.width), (x, high * skin.width)
        y = 0.0 if self.edge == "bottom" else skin.width
        return (low * skin.length, y), (high * skin.length, y)

    @model_validator(mode="after")
    def _span_has_length(self) -> Self:
        if not self.span[0] < self.span[1]:
            raise ValueError(f"span must run from a lower to a higher fraction, got {self.span}")
        return self


class Interface(Table):
    """One way of connecting the meter; contacts in neither list float."""

    name: Name
    high: Annotated[tuple[str, ...], Field(min_length=1)]
    low: Annotated[tuple[str, ...], Field(min_length=1)]


class Pixels(Table):
    """The grid that presses are counted on."""

    rows: Annotated[Whole, Field(ge=1, le=1000)]
    columns: Annotated[Whole, Field(ge=1, le=1000)]


class Pressing(Table):
    """How a pixel is pressed: its capacitance over that at rest, and the spread between presses.

    factor_spread: standard deviation of the rise (factor - 1), as a fraction of that rise.
    """

    capacitance_factor: Annotated[Number, above_zero("times that at rest")] = 2.0
    factor_spread: Annotated[Number, Field(ge=0, lt=1)] = 0.0


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


class Scene(Table):
    """Everything that determines a simulated measurement."""

    name: Name
    description: str = ""
    skin: Skin
    contacts: Annotated[tuple[Contact, ...], Field(alias="contact", min_length=1)]
    interfaces: Annotated[tuple[Interface, ...], Field(alias="interface", min_length=1)]
    pixels: Pixels
    press: Pressing = Pressing()
    leads: Leads = Leads()
    sweep: Sweep
    readout: Readout = Readout()
    experiment: Experiment = Experiment()
    dataset: Randomisation = Randomisation()

    @property
    def frequencies(self) -> np.ndarray:
        """Hz, ascending, shape (frequency,)."""
        return np.array(self.sweep.frequencies)

    def contact(self, name: str) -> Contact:
        """The contact of that name."""
        return next(contact for contact in self.contacts if contact.name == name)

    def every_press(self) -> list[Press]:
        """The skin at rest, then every pixel alone, row by row."""
        factor = self.press.capacitance_factor
        pixels = np.ndindex(self.pixels.rows, self.pixels.columns)
        return [Press(), *(Press((Touch(i + 1, j + 1, factor),)) for i, j in pixels)]

    @model_validator(mode="after")
    def _contacts_and_interfaces_agree(self) -> Self:
        check_wiring(self)
        return self
