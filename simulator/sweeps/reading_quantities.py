"""Quantities of a reading: the real numbers by which sweeps store one complex value."""

from __future__ import annotations

from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass

import numpy as np

from ..arrays import Complex, Real
from .impedance import parallel_capacitance


@dataclass(frozen=True)
class Quantity:
    """A real quantity of a reading.

    column: its name in CSV files. of: its value from the reading and the frequency in Hz.
    """

    name: str
    meaning: str
    units: str
    column: str
    of: Callable[[Complex, Real], Real]


@dataclass(frozen=True)
class QuantityError:
    """The estimated numerical error of a quantity.

    change: between two readings at a frequency in Hz.
    """

    name: str
    meaning: str
    units: str
    change: Callable[[Complex, Complex, Real], Real]


@dataclass(frozen=True)
class ReadingKind:
    """The kind of a complex reading, and the quantities that stand for it in sweeps.

    errors: may be absent from sweeps. reading: the complex reading from the quantities, of which it
    needs those in `sufficient`.
    """

    name: str
    quantities: tuple[Quantity, ...]
    errors: tuple[QuantityError, ...]
    sufficient: tuple[str, ...]
    reading: Callable[[Mapping[str, Real]], Complex]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the quantities."""
        return tuple(each.name for each in self.quantities)

    @property
    def error_names(self) -> tuple[str, ...]:
        """Names of the errors."""
        return tuple(each.name for each in self.errors)

    @property
    def with_errors(self) -> tuple[str, ...]:
        """Names of the quantities that have an error."""
        return tuple(name.removesuffix("_error") for name in self.error_names)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the quantities in CSV files."""
        return tuple(each.column for each in self.quantities)

    def values(
        self, reading: Complex, frequency: Real, shown: Mapping[str, Real] | None = None
    ) -> dict[str, Real]:
        """The quantities by name: those that follow from the reading, the inverse of `reading`.

        reading: shape (..., frequency). frequency: Hz. shown: quantities by name, of the same
        shape, that a meter shows with digits of their own; they are not computed.
        """
        known = shown or {}
        return {
            each.name: known[each.name] if each.name in known else each.of(reading, frequency)
            for each in self.quantities
        }

    def changes(self, one: Complex, other: Complex, frequency: Real) -> dict[str, Real]:
        """Changes of readings in the terms of the errors, by name of the error."""
        return {each.name: each.change(one, other, frequency) for each in self.errors}


IMPEDANCE = ReadingKind(
    "impedance",
    (
        Quantity("Rs", "series resistance, Re Z", "ohm", "Rs_ohm", lambda Z, f: Z.real),
        Quantity("X", "series reactance, Im Z", "ohm", "X_ohm", lambda Z, f: Z.imag),
        Quantity("Cp", "parallel capacitance, Im(1/Z)/omega", "F", "Cp_F", parallel_capacitance),
    ),
    (
        QuantityError(
            "Rs_error",
            "estimated numerical error of Rs",
            "ohm",
            lambda Z, other, f: np.abs((Z - other).real),
        ),
        QuantityError(
            "Cp_error",
            "estimated numerical error of Cp",
            "F",
            lambda Z, other, f: np.abs((1 / Z - 1 / other).imag) / (2 * np.pi * f),
        ),
    ),
    ("Rs", "X"),
    lambda values: values["Rs"] + 1j * values["X"],
)
GAIN_QUANTITY = Quantity("gain", "gain at the node, |V / V_s|", "1", "gain", lambda G, f: np.abs(G))
GAIN_ERROR = QuantityError(
    "gain_error",
    "estimated numerical error of the complex gain: of |V / V_s|, and of the phase times it",
    "1",
    lambda G, other, f: np.abs(G - other),
)
GAIN = ReadingKind(
    "gain",
    (
        GAIN_QUANTITY,
        Quantity(
            "gain_phase", "phase of V / V_s", "rad", "gain_phase_rad", lambda G, f: np.angle(G)
        ),
    ),
    (GAIN_ERROR,),
    ("gain", "gain_phase"),
    lambda values: (values["gain"] * np.exp(1j * values["gain_phase"])).astype(np.complex128),
)
MAGNITUDE = ReadingKind(
    "magnitude of the gain",
    (GAIN_QUANTITY,),
    (GAIN_ERROR,),
    ("gain",),
    lambda values: values["gain"].astype(np.complex128),
)
KINDS = (IMPEDANCE, GAIN, MAGNITUDE)
KIND_BY_NAME = {kind.name: kind for kind in KINDS}
DESCRIBED = {each.name: each for kind in KINDS for each in (*kind.quantities, *kind.errors)}
"""All quantities and errors by name."""


def kind_of(names: Container[object]) -> ReadingKind:
    """The kind of the readings of sweeps with variables of these names; impedance by default."""
    if "gain_phase" in names:
        return GAIN
    return MAGNITUDE if "gain" in names else IMPEDANCE


def reading_name(quantity: str, interface: str, frequency: float) -> str:
    """Name of one number of a sweep. frequency: Hz."""
    return f"{quantity} {interface} {frequency:.10g} Hz"
