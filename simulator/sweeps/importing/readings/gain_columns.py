"""The columns of a table that give a gain, if none give an impedance."""

from __future__ import annotations

import numpy as np

from ....arrays import Complex, Mask, Real
from ...errors import InputError
from ...reading_quantities import GAIN, MAGNITUDE, ReadingKind
from ..tables.columns import Column
from ..tables.table import ImportedTable
from .agreement import all_zeros
from .quantities import GAIN_PAIRS, PAIRS


def gain_columns(table: ImportedTable) -> tuple[Column, ...]:
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


def shown_gains(holds: tuple[str, ...], numbers: list[Real]) -> dict[str, Real]:
    """The quantities of gains that a file holds as they are, by their names in sweeps."""
    names = {"gain": "gain", "gain phase": "gain_phase", "phase": "gain_phase"}
    pairs = zip(holds, numbers, strict=True)
    return {names[each]: values for each, values in pairs if each in names}


def gain_kind(columns: tuple[Column, ...]) -> ReadingKind:
    """The kind of the readings that these columns give."""
    return GAIN if len(columns) > 1 else MAGNITUDE


def amplifying(G: Complex) -> Mask:
    """True where |V / V_s| exceeds one by more than the last digits of a table."""
    return np.abs(G) > 1.001
