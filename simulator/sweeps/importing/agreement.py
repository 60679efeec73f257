"""Compares all columns of a table that depend on frequency and Z with those that gave them."""

from __future__ import annotations

import re
from collections import Counter

import numpy as np

from ...arrays import Complex, Mask, Real
from ..errors import InputError
from ..reading_quantities import UNRELATED
from .columns import UNITS, Column
from .header import failed
from .quantities import GAINS, PAIRS, derived, deviation
from .table import ImportedTable

BARE = ("r", "x", "y")
"""Letters that alone may name a radius or a place."""
SAME_COLUMN = 0.01
"""Largest relative difference between two columns of frequencies."""
SAME_QUANTITY = 1e-3
"""Largest deviation between two columns of one quantity beyond their last digits; a curve of a
pressed skin may be as near as 5 % to one of the unpressed skin."""


def agreeing_columns(
    table: ImportedTable,
    pair: tuple[Column, ...],
    by: Column,
    letters: list[Column],
    Z: Complex,
    f: Real,
) -> tuple[list[Column], list[str]]:
    """The other columns that depend on frequency and Z and agree, and remarks on further ones.

    Raises InputError naming the columns and the first line where one does not agree; one of
    `letters` then holds something else. Columns of zeros, of unknown units and of the other kind of
    reading are not compared; cells that are no numbers get a remark. Z: ohm, or the gain.
    """
    agreeing, remarks = [], []
    holds = [each.holds for each in pair]
    comparable = {"frequency", "Rs"} if holds == ["Rs", "Cp"] else _comparable(holds)
    for column in [*table.columns, *letters]:
        used = column in (by, *pair)
        if column.holds not in comparable or column.problem or used or all_zeros(table, column):
            continue
        values = _most_agreeing(table, column, pair, Z, f)
        remarks += _unreadable(table, column, values)
        if not np.isfinite(values).any():
            continue
        try:
            _check_agreement(table, column, by, pair, values, Z, f)
        except InputError:
            if column not in letters:
                raise
            remarks.append(f"`{column.name}` does not follow from the others and is not used")
        else:
            agreeing.append(column)
    return agreeing, remarks


def bare_letters(table: ImportedTable) -> list[Column]:
    """Columns named r, x or y that need not hold R, X or Y, as other names give the reading.

    They may if no other name holds the same, and if R stands beside X: as a capital or with a unit.
    Where letters alone give the reading, `x` is not taken beside `X` or `X (ohm)`.
    """
    plain = [each for each in table.columns if not each.letter and not each.problem]
    held = {each.holds for each in plain}
    if not any(held.issuperset(pair) for pair in PAIRS if pair != ("Rs", "Cp")):
        count = Counter(each.holds for each in table.columns)
        return [each for each in table.columns if each.name in BARE and count[each.holds] > 1]
    certain = {
        each.holds
        for each in table.columns
        if each.letter and each.holds not in held and each.name not in BARE
    }
    partner = {"Rs": "X", "X": "Rs"}
    certain = {holds for holds in certain if partner.get(holds) in certain | held}
    return [each for each in table.columns if each.letter and each.holds not in certain]


def _most_agreeing(
    table: ImportedTable, column: Column, pair: tuple[Column, ...], Z: Complex, f: Real
) -> Real:
    """One column in SI units, in the number format by which it agrees with most readings."""

    def off(values: Real) -> int:
        known = np.isfinite(values)
        if column.holds == "frequency":
            return int((np.abs(values / f - 1)[known] > SAME_COLUMN).sum())
        return int((deviation(column.holds, values[known], Z[known], f[known]) > UNRELATED).sum())

    readings = [table.readable(column, form) for form in table.forms(column)]
    return readings[0] if len(readings) == 1 else min(readings, key=off)


def _unreadable(table: ImportedTable, column: Column, values: Real) -> list[str]:
    """A remark on cells that are no numbers, and say nothing of a reading that failed."""
    cells = [
        (line, text)
        for (line, _), text, value in zip(table.rows, table.text(column), values, strict=True)
        if text and np.isnan(value) and not failed(text)
    ]
    if not cells:
        return []
    line, text = cells[0]
    return [
        f"`{column.name}` cannot be compared in {len(cells)} of {len(values)} lines: {text[:20]!r} "
        f"in line {line} is no number"
    ]


def _comparable(holds: list[str]) -> set[str]:
    """Quantities that follow from the frequency and those that the columns of a reading hold."""
    if holds[0] not in GAINS:
        return UNITS.keys() - set(GAINS)
    phases = {"gain phase", "phase"} if len(holds) > 1 else set()
    return {"frequency", "gain", "gain level"} | phases


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
    by: Column,
    pair: tuple[Column, ...],
    values: Real,
    Z: Complex,
    f: Real,
) -> None:
    if column.holds == "frequency":
        off = np.abs(values / f - 1) > SAME_COLUMN
        return refuse(table, off, f"`{column.name}` is not the frequency `{by.name}`")
    holds = _holds_beside(table, column)
    twin = next((each for each in pair if each.holds == holds), None)
    limit = UNRELATED if twin is None else SAME_QUANTITY
    known = np.isfinite(values)
    if holds in ("Cs", "Lp", "Rp", "Q"):
        known &= values != 0
    suspect = np.flatnonzero(known)
    suspect = suspect[deviation(holds, values[suspect], Z[suspect], f[suspect]) > limit]
    texts, sources = table.text(column), " and ".join(f"`{each.name}`" for each in pair)
    for place in suspect:
        rounding = max(_rounding(table, each, place) for each in (column, twin) if each)
        one = slice(place, place + 1)
        off = deviation(holds, values[one], Z[one], f[one], rounding).item()
        if off > limit:
            given = derived(holds, Z[one], f[one]).item() / column.factor
            hint = _hint(float(values[place]) / column.factor, given)
            raise table.error(
                table.rows[place][0],
                f"`{column.name}` does not follow from {sources}: it is {texts[place]} where "
                f"{'they give' if len(pair) > 1 else 'it gives'} {given:.6g}{hint}; correct it, "
                "leave the column out, or name the columns with --columns",
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


def _rounding(table: ImportedTable, column: Column, place: int) -> float:
    """Half of the last digit of a cell, in SI units."""
    text = table.text(column)[place]
    plain = next(filter(None, (form.plain(text) for form in table.forms(column))), "0")
    return abs(column.factor) * _last_digit(plain) / 2


def _last_digit(plain: str) -> float:
    """The value of one in the last digit of a plain number."""
    mantissa, _, exponent = plain.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    return 10.0 ** (int(exponent or 0) - decimals)


def all_zeros(table: ImportedTable, column: Column) -> bool:
    """True if all cells are written as 0."""
    return all(
        text and not text.lower().split("e")[0].strip("+-0.,") for text in table.text(column)
    )


def refuse(table: ImportedTable, wrong: Mask, message: str) -> None:
    if wrong.any():
        raise table.error(table.rows[int(np.argmax(wrong))][0], message)
