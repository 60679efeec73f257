"""Curves beside each other in a table: columns of the same quantities, once for each curve."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from ..errors import InputError
from .agreement import all_zeros
from .columns import UNITS, Column
from .quantities import GAIN_PAIRS, PAIRS
from .table import ImportedTable


def curves(table: ImportedTable) -> list[ImportedTable]:
    """A table for each curve; the table itself if it holds no quantity and no reading twice.

    Columns belong to one curve if their names have the same mark (`Trace 2:`, `(Run 2)`, `.1`), and
    the second column of one name to the second curve. Frequency and labels may be common to all.
    Raises InputError naming two columns of one quantity from which no curves can be made.
    """
    columns = _marked(table.columns)
    own: dict[str, list[Column]] = {}
    for column in columns:
        if column.holds in UNITS:
            own.setdefault(column.curve, []).append(column)
    held = Counter(holds for each in own.values() for holds in {column.holds for column in each})
    del held["frequency"]
    whole = [mark for mark, each in own.items() if determines(each)]
    if max(held.values(), default=0) < 2 and len(whole) < 2:
        return [table]
    left = [each for mark, part in own.items() if mark not in whole for each in part]
    left = [each for each in left if held[each.holds] > 1 and not all_zeros(table, each)]
    copies = _copies(table, columns, left)
    _refuse_incomplete(table, columns, [each for each in left if each not in copies])
    if not whole:
        return [replace(table, columns=[each for each in columns if each not in copies])]
    return [_curve(table, columns, mark, shared=len(whole) > 1) for mark in whole]


def determines(columns: Sequence[Column]) -> bool:
    """True if columns with understood units give an impedance or a gain."""
    held = {column.holds for column in columns if not column.problem}
    return any(held.issuperset(pair) for pair in (*PAIRS, *GAIN_PAIRS))


def _marked(columns: Sequence[Column]) -> list[Column]:
    """The columns, with the marks of those that repeat a name counted."""
    count: Counter[tuple[str, str]] = Counter()
    found = []
    for column in columns:
        key = column.name, column.holds
        count[key] += 1
        mark = column.curve if count[key] == 1 else f"{column.curve} #{count[key]}"
        found.append(replace(column, curve=mark))
    return found


def _copies(table: ImportedTable, columns: list[Column], left: list[Column]) -> list[Column]:
    """The columns of `left` that hold the same cells as one of their quantity before them."""
    return [
        each
        for each in left
        if any(
            one.place < each.place
            and one.holds == each.holds
            and one.factor == each.factor
            and table.text(one) == table.text(each)
            for one in columns
        )
    ]


def _refuse_incomplete(table: ImportedTable, columns: list[Column], left: list[Column]) -> None:
    """Raises InputError for a quantity that stands twice without making another curve."""
    for column in left:
        other = next(
            (each for each in columns if each.holds == column.holds and each.curve != column.curve),
            None,
        )
        if other is not None and not column.letter:
            names = sorted((column, other), key=lambda each: each.place)
            first, second = (f"`{each.name}` (column {each.place + 1})" for each in names)
            raise InputError(
                f"{table.path}: has {column.holds} twice, {first} and {second}, but not all "
                "quantities of two curves; name the columns with --columns, - for those of others"
            )


def _curve(
    table: ImportedTable, columns: list[Column], mark: str, *, shared: bool
) -> ImportedTable:
    """The table of one curve: its columns, and the lines in which it has cells."""
    own = [each for each in columns if each.holds in UNITS and each.curve == mark]
    quantities = [each for each in own if each.holds != "frequency"]
    frequencies = [each for each in columns if each.holds == "frequency"]
    if len(quantities) == len(own):
        own += [each for each in frequencies if each.curve == frequencies[0].curve]
    labels = [each for each in columns if each.holds not in UNITS]
    numbered = {each.holds for each in labels if each.curve == mark}
    labels = [
        each
        for each in labels
        if each.curve == mark or (each.curve == "" and each.holds not in numbered)
    ]
    rows = [row for row in table.rows if any(row[1][each.place] for each in quantities)]
    return replace(table, columns=[*labels, *own], rows=rows if shared else table.rows)
