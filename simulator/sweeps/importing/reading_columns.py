"""Impedance or gain from the columns of a table; all columns that depend on it are compared."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...arrays import Complex, Mask, Real
from ..errors import InputError
from ..reading_quantities import GAIN, IMPEDANCE, MAGNITUDE, ReadingKind, parallel_capacitance
from .agreement import agreeing_columns, all_zeros, bare_letters, refuse
from .columns import ANGLES, UNITS, Column
from .quantities import GAIN_PAIRS, PAIRS, gain_of, impedance_of
from .table import ImportedTable

DIGITS = 12
"""Digits to which frequencies are rounded, so that 0.1 kHz equals 100 Hz."""
ROUNDING = 1.01
"""Factor by which a phase may exceed 180 degrees."""
MEGA = 1e9
"""Mega over milli."""
PLAUSIBLE = {True: (1e-3, 1e9), False: (1e-3, 1e12)}
"""Frequencies of readings in Hz, and the largest impedance of a table in ohm."""
GOOD = ("0", "ok", "normal", "valid", "good", "no error", "none", "")
"""Status of a good reading."""


@dataclass(frozen=True)
class ImportedReadings:
    """Readings of all lines of a table; arrays of shape (line,).

    table: without the lines that are no readings of a working meter. frequency: Hz, 12 digits. Z:
    ohm; from Rs and Cp on the capacitive branch; or the gain. shown: quantities of sweeps as the
    file has them, and Cp in F in any case; NaN where a reading failed. pair: the columns that gave
    Z, one for magnitudes of gains alone. compared: columns that agree with it. failed: True for
    lines whose frequency is known and whose reading failed; Z is NaN there. kind: of the readings.
    beside: readings of other curves of the table, which the arrays hold too.
    """

    table: ImportedTable
    frequency: Real
    Z: Complex
    shown: dict[str, Real]
    frequency_column: Column
    pair: tuple[Column, ...]
    compared: list[Column]
    failed: Mask
    kind: ReadingKind = IMPEDANCE
    beside: tuple[ImportedReadings, ...] = ()

    @property
    def quantities(self) -> tuple[str, ...]:
        """What the columns of the pair hold."""
        return tuple(each.holds for each in self.pair)


def imported_readings(table: ImportedTable) -> ImportedReadings:
    """Frequency and impedance of every line, or gain if no columns give an impedance.

    Raises InputError naming the file, and the line if there is one: no columns that give an
    impedance or a gain, a cell that is no number, a frequency < 0, a modulus < 0, a reading of 0, a
    phase beyond 180 degrees, a pair (Rs, Cp) without a solution for the reactance, a column that
    contradicts the reading.
    """
    table = _with_prefixes(table)
    letters = bare_letters(table)
    kept = [each for each in table.columns if each not in letters]
    table = replace(table, columns=kept)
    by, gains = _frequency(table), _gain_columns(table)
    pair = gains or _pair(table)
    table = table.written([by, *pair])
    f = _frequencies(table, by)
    idle = ["the frequency is 0" if each == 0 else "" for each in f]
    idle = [reason or ("" if np.isfinite(each) else f"`{by.name}` is no reading")
            for reason, each in zip(idle, f, strict=True)]  # fmt: skip
    table, f = table.without(idle), f[[not reason for reason in idle]]
    refuse(table, f <= 0, f"the frequency must be > 0 Hz (`{by.name}`)")
    numbers = [table.numbers(column) for column in pair]
    status = _status_reasons(table)
    failing = _failure_reasons(table, {c.name: n for c, n in zip(pair, numbers, strict=True)})
    reasons = [one or other for one, other in zip(status, failing, strict=True)]
    good = np.array([not reason for reason in reasons])
    checked = table.without(reasons)
    numbers = [each[good] for each in numbers]
    _check_numbers(checked, pair, numbers)
    kind = IMPEDANCE if not gains else GAIN if len(gains) > 1 else MAGNITUDE
    Z = _complex(checked, pair, numbers, f[good], kind)
    zero, letter = ("the gain is 0", "the gain") if gains else ("Z is 0 ohm", "Z")
    refuse(checked, Z == 0, f"{zero}, which no reading is")
    refuse(checked, ~np.isfinite(Z), f"{letter} is infinite, which no reading is")
    compared, remarks = agreeing_columns(checked, pair, by, letters, Z, f[good])
    filled = np.full(len(f), np.nan, dtype=np.complex128)
    filled[good] = Z
    if kind is IMPEDANCE:
        shown = {"Cp": _capacitance(checked, pair, compared, Z, f[good])}
    else:
        shown = _shown_gains(tuple(each.holds for each in pair), numbers)
    every = {name: np.full(len(f), np.nan) for name in shown}
    for name, values in shown.items():
        every[name][good] = values
    whole = replace(table, left_out=checked.left_out, remarks=[*table.remarks, *remarks])
    return ImportedReadings(whole, f, filled, every, by, pair, compared, ~good, kind)


def joined_readings(parts: Sequence[ImportedReadings]) -> ImportedReadings:
    """Readings of several curves of a table, one after the other.

    Raises InputError if not all have the same quantities.
    """
    first, *others = parts
    for other in others:
        if other.quantities != first.quantities:
            one, two = (" and ".join(each.quantities) for each in (first, other))
            raise InputError(
                f"{first.table.path}: holds curves of {one} and of {two}; name the columns of one "
                "with --columns, - for the others"
            )
    tables = [each.table for each in parts]
    table = replace(
        first.table,
        rows=[row for each in tables for row in each.rows],
        left_out=list(dict.fromkeys(line for each in tables for line in each.left_out)),
        remarks=list(dict.fromkeys(text for each in tables for text in each.remarks)),
    )
    shown = {name: np.concatenate([each.shown[name] for each in parts]) for name in first.shown}
    frequency, Z, failed = (
        np.concatenate([getattr(each, name) for each in parts])
        for name in ("frequency", "Z", "failed")
    )
    return replace(
        first,
        table=table,
        frequency=frequency,
        Z=Z,
        failed=failed,
        shown=shown,
        beside=tuple(others),
    )


def _with_prefixes(table: ImportedTable) -> ImportedTable:
    """The table with m taken as milli or mega in names without case: by what is plausible.

    Columns of one unit are of one prefix. A column of which both or neither is plausible has a
    problem.
    """
    units = {(column.holds == "frequency", column.unit.casefold()) for column in table.columns}
    columns = {column.place: column for column in table.columns}
    for of_frequency, unit in units:
        group = [
            each
            for each in table.columns
            if unit and (each.holds == "frequency", each.unit.casefold()) == (of_frequency, unit)
        ]
        if not group:
            continue
        sizes = np.abs([table.readable(each, table.forms(each)[0]) for each in group])
        sizes = sizes[np.isfinite(sizes) & (sizes > 0)]
        smallest, largest = np.min(sizes, initial=np.inf), np.max(sizes, initial=0.0)
        low, high = PLAUSIBLE[of_frequency]
        lowest = smallest if of_frequency else largest
        fits = [low <= factor * lowest and factor * largest <= high for factor in (1.0, MEGA)]
        for each in group:
            columns[each.place] = _with_prefix(each, *fits)
    return replace(table, columns=list(columns.values()))


def _with_prefix(column: Column, milli: bool, mega: bool) -> Column:
    """The column with the plausible prefix. milli, mega: whether each of them is plausible."""
    base = column.unit[1:].lower().replace("hz", "Hz")
    if milli == mega:
        problem = (
            f"column `{column.name}` may be in m{base} or in M{base}, as its name has no capitals "
            f"beside small letters; name the columns with --columns, in m{base} or M{base}"
        )
        return replace(column, problem=problem)
    unit = f"{'M' if mega else 'm'}{base}"
    return replace(column, unit=unit, factor=column.factor * (MEGA if mega else 1.0))


def _frequency(table: ImportedTable) -> Column:
    """The first column of frequencies with an understood unit. Raises InputError if none has."""
    column = table.holding("frequency")[0]
    if column.problem:
        raise InputError(f"{table.path}: {column.problem}")
    return column


def _frequencies(table: ImportedTable, column: Column) -> Real:
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
        if not problems and not (all_zeros(table, first) or all_zeros(table, second)):
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
        f"of Ls or Lp and Rs, Rp or Q, of G and B, of |Y| and phase, or of a gain; in the header "
        f"in line {table.header} only {listed} are understood{_not_understood(table)}"
    )


def _not_understood(table: ImportedTable) -> str:
    known = {column.place for column in table.columns}
    others = [f"`{name}`" for place, name in enumerate(table.names) if name and place not in known]
    return f", not {', '.join(others)}" if others else ""


def _check_numbers(table: ImportedTable, pair: tuple[Column, ...], numbers: list[Real]) -> None:
    for column, values in zip(pair, numbers, strict=True):
        kind = {"magnitude": "|Z|", "admittance": "|Y|", "gain": "|V / V_s|"}.get(column.holds)
        if kind is not None:
            refuse(table, values < 0, f"{kind} must be >= 0 (`{column.name}`)")
        if column.holds in ("Cs", "Lp", "Rp", "Q"):
            refuse(table, values == 0, f"{column.holds} must not be 0 (`{column.name}`)")
        if column.holds in ANGLES:
            beyond = np.abs(values) > np.pi * ROUNDING
            refuse(
                table,
                beyond,
                f"the phase `{column.name}` is beyond 180 degrees; is its unit right?",
            )


def _complex(
    table: ImportedTable, pair: tuple[Column, ...], numbers: list[Real], f: Real, kind: ReadingKind
) -> Complex:
    """Readings from the numbers of the columns: Z in ohm, or gains."""
    if kind is not IMPEDANCE:
        return gain_of(tuple(each.holds for each in pair), numbers, f)
    kinds, (first, second) = (pair[0].holds, pair[1].holds), numbers
    try:
        return impedance_of(kinds, first, second, f)
    except InputError:
        for (line, _), *reading in zip(table.rows, first, second, f, strict=True):
            try:
                impedance_of(kinds, *map(np.asarray, reading))
            except InputError as error:
                raise table.error(line, str(error)) from error
        raise


def _capacitance(
    table: ImportedTable, pair: tuple[Column, ...], compared: list[Column], Z: Complex, f: Real
) -> Real:
    """Cp in F from the file where it has one, else computed from Z."""
    found = parallel_capacitance(Z, f)
    for column in (*pair, *compared):
        if column.holds == "Cp":
            values = table.readable(column)
            return np.where(np.isfinite(values), values, found)
    return found


def _status_reasons(table: ImportedTable) -> list[str]:
    """A reason for each row whose status is bad while most are good; empty for the others.

    A status that is never good has another meaning.
    """
    reasons = [""] * len(table.rows)
    for column in table.holding("status"):
        texts = table.text(column)
        good = [_good(text) for text in texts]
        if 2 * sum(good) <= len(good):
            continue
        for place, text in enumerate(texts):
            if not good[place]:
                reasons[place] = reasons[place] or f"`{column.name}` is {text[:20]}"
    return reasons


def _good(text: str) -> bool:
    try:
        return float(text) == 0
    except ValueError:
        return text.casefold() in GOOD


def _failure_reasons(table: ImportedTable, values: dict[str, Real]) -> list[str]:
    """A reason for each row in which a number of these columns says that there is no reading.

    values: by the name of the column.
    """
    reasons = [""] * len(table.rows)
    for name, numbers in values.items():
        for place in np.flatnonzero(~np.isfinite(numbers)):
            reasons[place] = reasons[place] or f"`{name}` is no reading"
    return reasons


def _gain_columns(table: ImportedTable) -> tuple[Column, ...]:
    """The columns of a gain; empty without them or with an impedance.

    Raises InputError if the unit of one is not understood.
    """
    if any(all(map(table.holding, pair)) for pair in PAIRS):
        return ()
    for holds in GAIN_PAIRS:
        found = [table.holding(each) for each in holds]
        if not all(found):
            continue
        columns = tuple(each[0] for each in found)
        for each in columns:
            if each.problem:
                raise InputError(f"{table.path}: {each.problem}")
        if not all_zeros(table, columns[0]):
            return columns
    return ()


def _shown_gains(holds: tuple[str, ...], numbers: list[Real]) -> dict[str, Real]:
    """The quantities of gains that a file holds as they are, by their names in sweeps."""
    names = {"gain": "gain", "gain phase": "gain_phase", "phase": "gain_phase"}
    pairs = zip(holds, numbers, strict=True)
    return {names[each]: values for each, values in pairs if each in names}


def amplifying(G: Complex) -> Mask:
    """True where |V / V_s| exceeds one by more than the last digits of a table."""
    return np.abs(G) > 1.001
