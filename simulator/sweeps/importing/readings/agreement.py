"""Compares all columns of a table that depend on frequency and Z with those that gave them."""

from __future__ import annotations

import re

import numpy as np

from ....arrays import Complex, Mask, Real
from ...impedance import UNRELATED
from ..tables.columns import UNITS, Column
from ..tables.table import ImportedTable
from .quantities import GAINS, derived, deviation

SAME_COLUMN = 0.01
"""Largest relative difference between two columns of frequencies."""


def agreeing_columns(
    table: ImportedTable, pair: tuple[Column, ...], by: Column, Z: Complex, f: Real
) -> list[Column]:
    """The other columns that depend on frequency and Z, all of which agree.

    Raises InputError naming the columns and the first line where one does not. Columns of zeros,
    of unknown units, of the other kind of reading, and cells without a number are not compared.
    Z: ohm, or the gain.
    """
    agreeing = []
    holds = [each.holds for each in pair]
    branches = holds == ["Rs", "Cp"]
    comparable = _comparable(holds)
    for column in table.columns:
        used = column in (by, *pair)
        if column.holds not in comparable or column.problem or used or all_zeros(table, column):
            continue
        values = table.readable(column)
        if column.holds == "frequency":
            off = np.abs(values / f - 1) > SAME_COLUMN
            refuse(table, off, f"`{column.name}` is not the frequency `{by.name}`")
        elif branches and column.holds != "Rs":
            continue
        elif not np.isfinite(values).any():
            continue
        else:
            beside = _holds_beside(table, column)
            _check_agreement(table, column, beside, pair, values, Z, f)
        agreeing.append(column)
    return agreeing


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
    holds: str,
    pair: tuple[Column, ...],
    values: Real,
    Z: Complex,
    f: Real,
) -> None:
    known = np.isfinite(values)
    if holds in ("Cs", "Lp", "Rp", "Q"):
        known &= values != 0
    suspect = np.flatnonzero(known)
    suspect = suspect[deviation(holds, values[suspect], Z[suspect], f[suspect]) > UNRELATED]
    texts, sources = table.text(column), " and ".join(f"`{each.name}`" for each in pair)
    for place in suspect:
        rounding = abs(column.factor) * _last_digit(table.form.plain(texts[place]) or "0") / 2
        one = slice(place, place + 1)
        off = deviation(holds, values[one], Z[one], f[one], rounding).item()
        if off > UNRELATED:
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
