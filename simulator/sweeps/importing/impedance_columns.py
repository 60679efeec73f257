"""Impedance from columns: Rs and X, |Z| and phase, Rs and Cs, or Rs and Cp."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..impedance import (
    UNRELATED,
    branch_reactance,
    contradicting,
    contradiction_text,
    parallel_capacitance,
)
from .dialect import ImportedTable

Reals = NDArray[np.float64]
REPRESENTATIONS: dict[tuple[str, str], Callable[[Any, Any, Any], Any]] = {
    ("Rs", "X"): lambda Rs, X, _: Rs + 1j * X,
    ("magnitude", "phase"): lambda magnitude, phase, _: magnitude * np.exp(1j * phase),
    ("Rs", "Cs"): lambda Rs, Cs, f: Rs - 1j / (2 * np.pi * f * Cs),
    ("Rs", "Cp"): lambda Rs, Cp, f: Rs + 1j * branch_reactance(Rs, Cp, f),
}
"""Functions that give Z in ohm from a pair of columns and the frequency in Hz; the first pair that
a file has is used."""
DIGITS = 12
"""Digits to which frequencies are rounded, so that 0.1 kHz equals 100 Hz."""


@dataclass(frozen=True)
class ImportedReadings:
    """Readings of all lines of a table; arrays of shape (line,).

    frequency: Hz. Z: ohm; from Rs and Cp on the capacitive branch. Cp: F, from the file or else
    computed from Z. pair: the columns that gave Z.
    """

    frequency: Reals
    Z: NDArray[np.complex128]
    Cp: Reals
    pair: tuple[str, str]


def impedance_readings(table: ImportedTable) -> ImportedReadings:
    """Frequency and impedance of every line.

    Raises InputError naming the file, and the line if there is one: no pair of columns that gives
    an impedance, a cell that is no number, a frequency <= 0, |Z| < 0 or Z = 0, a pair (Rs, Cp)
    without a solution for the reactance.
    """
    pair = _pair(table)
    f = np.array([float(f"{each:.{DIGITS}g}") for each in table.numbers("frequency")])
    _refuse(table, f <= 0, "the frequency must be > 0 Hz")
    first, second = (np.array(table.numbers(name)) for name in pair)
    _refuse(table, (first < 0) & (pair[0] == "magnitude"), "|Z| must be >= 0 ohm")
    _refuse(table, (second == 0) & (pair[1] == "Cs"), "Cs must not be 0 F")
    Z = _impedance(table, pair, first, second, f)
    _refuse(table, Z == 0, "Z is 0 ohm, which no reading is")
    return ImportedReadings(f, Z, _capacitance(table, pair, Z, f), pair)


def _capacitance(
    table: ImportedTable, pair: tuple[str, str], Z: NDArray[np.complex128], f: Reals
) -> Reals:
    """Cp in F from the file, or else computed from Z; a column of zeros counts as absent.

    Raises InputError naming the line where Cp contradicts Z.
    """
    found = parallel_capacitance(Z, f)
    displayed = np.array(table.numbers("Cp")) if "Cp" in table.columns else np.zeros(0)
    if not displayed.any():
        return found
    wrong = contradicting(Z.real, Z.imag, displayed, f, UNRELATED)
    if wrong.any() and pair != ("Rs", "Cp"):
        k = int(np.argmax(wrong))
        name = table.columns["Cp"].name
        raise table.error(
            table.rows[k][0], f"`{name}` {contradiction_text(displayed[k], found[k])}"
        )
    return displayed


def _pair(table: ImportedTable) -> tuple[str, str]:
    for pair in REPRESENTATIONS:
        if set(pair) <= table.columns.keys():
            return pair
    found = ", ".join(f"`{column.name}`" for column in table.columns.values())
    raise InputError(
        f"{table.path}: needs columns of Rs and X, of |Z| and phase, of Rs and Cs, or of Rs and Cp;"
        f" of its columns only {found} are understood"
    )


def _impedance(
    table: ImportedTable, pair: tuple[str, str], first: Reals, second: Reals, f: Reals
) -> NDArray[np.complex128]:
    convert = REPRESENTATIONS[pair]
    try:
        return convert(first, second, f)
    except InputError:
        for (line, _), *reading in zip(table.rows, first, second, f, strict=True):
            try:
                convert(*reading)
            except InputError as error:
                raise table.error(line, str(error)) from error
        raise


def _refuse(table: ImportedTable, wrong: NDArray[np.bool_], message: str) -> None:
    if wrong.any():
        raise table.error(table.rows[int(np.argmax(wrong))][0], message)
