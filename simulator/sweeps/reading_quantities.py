"""Quantities of a reading: the real numbers by which sweeps store one complex value.

An impedance is Z = Rs + jX; Cp, Cs, and X from Rs and Cp, are derived from it.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Complex, Mask, Real
from .errors import InputError

NOISE = 0.05
"""Largest contribution of noise to 2 omega Cp Rs, which is 1 at -45 degrees."""
UNRELATED = 0.05
"""Deviation of Cp from Im(1/Z) / omega, over |1/Z| / omega, that neither noise nor rounding to two
digits explains: a wrong unit, a typing error, a truncated cell."""


def parallel_capacitance(Z: ArrayLike, frequency: ArrayLike) -> Real:
    """Cp = Im(1/Z) / omega, in F.

    Z: ohm, shape (..., frequency). frequency: Hz, shape (frequency,).
    """
    Z, omega = np.asarray(Z, dtype=np.complex128), 2 * np.pi * np.asarray(frequency)
    magnitude = np.abs(Z)
    return -(Z.imag / magnitude) / magnitude / omega


def series_capacitance(Z: ArrayLike, frequency: ArrayLike) -> Real:
    """Cs = -1 / (omega X), in F.

    Z: ohm, shape (..., frequency). frequency: Hz, shape (frequency,).
    """
    X = np.asarray(Z, dtype=np.complex128).imag
    return -1 / (2 * np.pi * np.asarray(frequency) * X)


def contradicting(
    Rs: ArrayLike, X: ArrayLike, Cp: ArrayLike, frequency: ArrayLike, tolerance: ArrayLike
) -> Mask:
    """True where Cp deviates from Im(1/Z) / omega by more than a fraction of |1/Z| / omega.

    Rs, X: ohm, Cp: F, shapes (..., frequency). frequency: Hz. tolerance: the fraction, a number
    or of the shape of the frequency. False where Z = 0 or a value is NaN.
    """
    Rs, X, Cp = (np.asarray(each, dtype=float) for each in (Rs, X, Cp))
    size = np.hypot(Rs, X)
    with np.errstate(over="ignore", invalid="ignore"):
        off = np.abs(2 * np.pi * np.asarray(frequency) * Cp * size**2 + X)
        return off > np.asarray(tolerance) * size


def contradiction_text(Cp: float, found: float) -> str:
    """Message for a Cp [F] that contradicts the value `found` from Rs and X."""
    return (
        f"does not follow from Rs and X: it is {Cp:.6g} F where they give {found:.6g} F; "
        "correct its unit or value, or leave the column out"
    )


def branch_reactance(Rs: ArrayLike, Cp: ArrayLike, frequency: ArrayLike) -> Real:
    """X from (Rs, Cp) alone, on the branch with a phase between -90 and -45 degrees.

    Cp = -X / (omega (Rs² + X²)) has two roots with X1 X2 = Rs². This returns the one with |X| >=
    Rs; lines and sheets pass -45 degrees, where `branch.choose_branch` follows them to the other.

    Rs: ohm, Cp: F, shapes (..., frequency). frequency: Hz. Returns X in ohm.
    Raises InputError if Cp <= 0, or if no reactance gives the pair: 2 omega Cp Rs exceeds 1 by more
    than NOISE.
    """
    Rs = np.asarray(Rs, dtype=float)
    susceptance = 2 * np.pi * np.asarray(frequency) * np.asarray(Cp, dtype=float)
    product = 2 * susceptance * Rs
    if np.any(susceptance <= 0) or np.any(product > 1 + NOISE):
        raise InputError(
            "no capacitive reactance has these Rs and Cp: need Cp > 0, 2 omega Cp Rs <= 1"
        )
    return -(1 + np.sqrt(np.maximum(1 - product**2, 0))) / (2 * susceptance)


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
