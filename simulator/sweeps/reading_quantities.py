"""Quantities of a reading: the real numbers by which sweeps store one complex value."""

from __future__ import annotations

from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .impedance import parallel_capacitance

Complex = NDArray[np.complex128]
Real = NDArray[np.float64]


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
    """The estimated numerical error of a quantity."""

    name: str
    meaning: str
    units: str


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
    def columns(self) -> tuple[str, ...]:
        """Names of the quantities in CSV files."""
        return tuple(each.column for each in self.quantities)

    def values(self, reading: Complex, frequency: Real) -> dict[str, Real]:
        """The quantities by name. reading: shape (..., frequency). frequency: Hz."""
        return {each.name: each.of(reading, frequency) for each in self.quantities}


IMPEDANCE = ReadingKind(
    "impedance",
    (
        Quantity("Rs", "series resistance, Re Z", "ohm", "Rs_ohm", lambda Z, f: Z.real),
        Quantity("X", "series reactance, Im Z", "ohm", "X_ohm", lambda Z, f: Z.imag),
        Quantity("Cp", "parallel capacitance, Im(1/Z)/omega", "F", "Cp_F", parallel_capacitance),
    ),
    (
        QuantityError("Rs_error", "estimated numerical error of Rs", "ohm"),
        QuantityError("Cp_error", "estimated numerical error of Cp", "F"),
    ),
    ("Rs", "X"),
    lambda values: values["Rs"] + 1j * values["X"],
)
KINDS = (IMPEDANCE,)
DESCRIBED = {each.name: each for kind in KINDS for each in (*kind.quantities, *kind.errors)}
"""All quantities and errors by name."""


def kind_of(names: Container[object]) -> ReadingKind:
    """The kind of the readings of sweeps with variables of these names; impedance by default."""
    return next((kind for kind in KINDS if all(name in names for name in kind.names)), IMPEDANCE)
