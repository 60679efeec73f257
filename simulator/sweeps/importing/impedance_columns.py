"""Impedance from the columns of a table, and the comparison of all columns that depend on it."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..impedance import UNRELATED, parallel_capacitance
from .columns import ANGLES, UNITS, Column
from .failures import failure_reasons, status_reasons
from .quantities import PAIRS, Reals, derived, deviation, impedance_of
from .table import ImportedTable

DIGITS = 12
"""Digits to which frequencies are rounded, so that 0.1 kHz equals 100 Hz."""
SAME_COLUMN = 0.01
"""Largest relative difference between two columns of frequencies."""
ROUNDING = 1.01
"""Factor by which a phase may exceed 180 degrees."""


@dataclass(frozen=True)
class ImportedReadings:
    """Readings of all lines of a table; arrays of shape (line,).

    table: without the lines that are no readings of a working meter. frequency: Hz, 12 digits. Z:
    ohm; from Rs and Cp on the capacitive branch. Cp: F, from the file or else computed from Z.
    pair: the columns that gave Z. compared: columns that agree with it. failed: True for lines
    whose frequency is known and whose reading failed; Z is NaN there.
    """

    table: ImportedTable
    frequency: Reals
    Z: NDArray[np.complex128]
    Cp: Reals
    frequency_column: Column
    pair: tuple[Column, Column]
    compared: list[Column]
    failed: NDArray[np.bool_]

    @property
    def quantities(self) -> tuple[str, str]:
        """What the columns of the pair hold."""
        return self.pair[0].holds, self.pair[1].holds


def impedance_readings(table: ImportedTable) -> ImportedReadings:
    """Frequency and impedance of every line.

    Raises InputError naming the file, and the line if there is one: no pair of columns that gives
    an impedance, a cell that is no number, a frequency < 0, |Z| < 0 or Z = 0, a phase beyond 180
    degrees, a pair (Rs, Cp) without a solution for the reactance, a column that contradicts Z.
    """
    by, pair = table.holding("frequency")[0], _pair(table)
    table = table.written([by, *pair])
    f = _frequencies(table, by)
    idle = ["the frequency is 0" if each == 0 else "" for each in f]
    idle = [reason or ("" if np.isfinite(each) else f"`{by.name}` is no reading")
            for reason, each in zip(idle, f, strict=True)]  # fmt: skip
    table, f = table.without(idle), f[[not reason for reason in idle]]
    _refuse(table, f <= 0, f"the frequency must be > 0 Hz (`{by.name}`)")
    first, second = (table.numbers(column) for column in pair)
    status = status_reasons(table)
    failing = failure_reasons(table, {pair[0].name: first, pair[1].name: second})
    reasons = [one or other for one, other in zip(status, failing, strict=True)]
    good = np.array([not reason for reason in reasons])
    checked = table.without(reasons)
    first, second = first[good], second[good]
    _check_numbers(checked, pair, first, second)
    Z = _impedance(checked, pair, first, second, f[good])
    _refuse(checked, Z == 0, "Z is 0 ohm, which no reading is")
    _refuse(checked, ~np.isfinite(Z), "Z is infinite, which no reading is")
    compared = _compare(checked, pair, by, Z, f[good])
    filled = np.full(len(f), np.nan, dtype=np.complex128)
    filled[good] = Z
    Cp = np.full(len(f), np.nan)
    Cp[good] = _capacitance(checked, pair, compared, Z, f[good])
    whole = _with_left_out(table, checked)
    return ImportedReadings(whole, f, filled, Cp, by, pair, compared, ~good)


def _with_left_out(table: ImportedTable, checked: ImportedTable) -> ImportedTable:
    from dataclasses import replace

    return replace(table, left_out=checked.left_out)


def _frequencies(table: ImportedTable, column: Column) -> Reals:
    return np.array([float(f"{each:.{DIGITS}g}") for each in table.numbers(column)])


def _pair(table: ImportedTable) -> tuple[Column, Column]:
    """The columns that give Z: the first pair with understood units.

    Raises InputError with the problem of the first pair if all have one, or if there is no pair.
    """
    problem = ""
    for pair in PAIRS:
        found = [table.holding(holds) for holds in pair]
        if not all(found) or (pair == ("admittance", "phase") and table.holding("magnitude")):
            continue
        first, second = found[0][0], found[1][0]
        problems = first.problem or second.problem
        if not problems and not (_zeros(table, first) or _zeros(table, second)):
            return first, second
        problem = problem or problems
    if problem:
        raise InputError(f"{table.path}: {problem}")
    for pair in PAIRS:
        found = [table.holding(holds) for holds in pair]
        if all(found):
            return found[0][0], found[1][0]
    known = [column for column in table.columns if column.holds in UNITS]
    listed = ", ".join(f"`{column.name}`" for column in known)
    raise InputError(
        f"{table.path}: needs columns of Rs and X, of |Z| and phase, of Cs or Cp and D, Rs or Rp, "
        f"of Ls or Lp and Rs, Rp or Q, of G and B, or of |Y| and phase; in the header in line "
        f"{table.header} only {listed} are understood{_not_understood(table)}"
    )


def _not_understood(table: ImportedTable) -> str:
    known = {column.place for column in table.columns}
    others = [f"`{name}`" for place, name in enumerate(table.names) if name and place not in known]
    return f", not {', '.join(others)}" if others else ""


def _zeros(table: ImportedTable, column: Column) -> bool:
    """True if all cells are written as 0."""
    return all(
        text and not text.lower().split("e")[0].strip("+-0.,") for text in table.text(column)
    )


def _check_numbers(
    table: ImportedTable, pair: tuple[Column, Column], first: Reals, second: Reals
) -> None:
    for column, values in zip(pair, (first, second), strict=True):
        kind = {"magnitude": "|Z|", "admittance": "|Y|"}.get(column.holds)
        if kind is not None:
            _refuse(table, values < 0, f"{kind} must be >= 0 (`{column.name}`)")
        if column.holds in ("Cs", "Lp", "Rp", "Q"):
            _refuse(table, values == 0, f"{column.holds} must not be 0 (`{column.name}`)")
        if column.holds in ANGLES:
            beyond = np.abs(values) > np.pi * ROUNDING
            _refuse(
                table,
                beyond,
                f"the phase `{column.name}` is beyond 180 degrees; is its unit right?",
            )


def _impedance(
    table: ImportedTable, pair: tuple[Column, Column], first: Reals, second: Reals, f: Reals
) -> NDArray[np.complex128]:
    kinds = pair[0].holds, pair[1].holds
    try:
        return impedance_of(kinds, first, second, f)
    except InputError:
        for (line, _), *reading in zip(table.rows, first, second, f, strict=True):
            try:
                impedance_of(kinds, *map(np.asarray, reading))
            except InputError as error:
                raise table.error(line, str(error)) from error
        raise


def _compare(
    table: ImportedTable,
    pair: tuple[Column, Column],
    by: Column,
    Z: NDArray[np.complex128],
    f: Reals,
) -> list[Column]:
    """The other columns that depend on frequency and Z, all of which agree.

    Raises InputError naming the columns and the first line where one does not. Columns of zeros,
    of unknown units and cells without a number are not compared.
    """
    agreeing = []
    branches = (pair[0].holds, pair[1].holds) == ("Rs", "Cp")
    for column in table.columns:
        used = column in (by, *pair)
        if column.holds not in UNITS or column.problem or used or _zeros(table, column):
            continue
        values = table.readable(column)
        if column.holds == "frequency":
            off = np.abs(values / f - 1) > SAME_COLUMN
            _refuse(table, off, f"`{column.name}` is not the frequency `{by.name}`")
        elif branches and column.holds != "Rs":
            continue
        elif not np.isfinite(values).any():
            continue
        else:
            holds = _holds_beside(table, column)
            _check_agreement(table, column, holds, pair, values, Z, f)
        agreeing.append(column)
    return agreeing


def _holds_beside(table: ImportedTable, column: Column) -> str:
    """What a column holds; a phase beside |Y| alone is that of Y."""
    alone = table.holding("admittance") and not table.holding("magnitude")
    named = re.search(r"z|imp", column.name, re.IGNORECASE)
    impedances = table.holding("Rs") or table.holding("X")
    if column.holds == "phase" and alone and not named and not impedances:
        return "admittance phase"
    return column.holds


def _check_agreement(
    table: ImportedTable,
    column: Column,
    holds: str,
    pair: tuple[Column, Column],
    values: Reals,
    Z: NDArray[np.complex128],
    f: Reals,
) -> None:
    known = np.isfinite(values)
    if holds in ("Cs", "Lp", "Rp", "Q"):
        known &= values != 0
    suspect = np.flatnonzero(known)
    suspect = suspect[deviation(holds, values[suspect], Z[suspect], f[suspect]) > UNRELATED]
    texts = table.text(column)
    for place in suspect:
        rounding = abs(column.factor) * _last_digit(table.form.plain(texts[place]) or "0") / 2
        one = slice(place, place + 1)
        off = deviation(holds, values[one], Z[one], f[one], rounding).item()
        if off > UNRELATED:
            given = derived(holds, Z[one], f[one]).item() / column.factor
            hint = _hint(values[place] / column.factor, given)
            raise table.error(
                table.rows[place][0],
                f"`{column.name}` does not follow from `{pair[0].name}` and `{pair[1].name}`: it "
                f"is {texts[place]} where they give {given:.6g}{hint}; correct it, leave the "
                "column out, or name the columns with --columns",
            )


def _hint(value: float, given: float) -> str:
    """The likely cause of a difference: the sign or a unit."""
    if not given:
        return ""
    ratio = value / given
    if abs(ratio + 1) < UNRELATED:
        return " (the opposite sign)"
    power = np.log10(abs(ratio)) if ratio else 0.0
    if abs(power) > 1 and abs(power - round(power)) < 0.02:
        return f" (1e{round(power):d} times as much: is its unit right?)"
    return ""


def _last_digit(plain: str) -> float:
    """The value of one in the last digit of a plain number."""
    mantissa, _, exponent = plain.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    return 10.0 ** (int(exponent or 0) - decimals)


def _capacitance(
    table: ImportedTable,
    pair: tuple[Column, Column],
    compared: list[Column],
    Z: NDArray[np.complex128],
    f: Reals,
) -> Reals:
    """Cp in F from the file where it has one, else computed from Z."""
    found = parallel_capacitance(Z, f)
    for column in (*pair, *compared):
        if column.holds == "Cp":
            values = table.readable(column)
            return np.where(np.isfinite(values), values, found)
    return found


def _refuse(table: ImportedTable, wrong: NDArray[np.bool_], message: str) -> None:
    if wrong.any():
        raise table.error(table.rows[int(np.argmax(wrong))][0], message)
