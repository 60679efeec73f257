"""Sentences about an import: which columns were taken, what was left out, what is unusual."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Complex, Integer
from ..laws.device_faults import device_faults
from ..reading_quantities import IMPEDANCE
from .failures import left_out_text
from .grouping import Grouping
from .labels import LineLabels
from .readings.gain_columns import amplifying
from .readings.reading_columns import ImportedReadings
from .tables.columns import Column

if TYPE_CHECKING:
    import xarray as xr

PASSIVE = np.pi / 2 + np.radians(1)
"""Phase of a passive part, with 1 degree of allowance, in rad."""


def account(readings: ImportedReadings, labels: LineLabels, grouping: Grouping) -> dict[str, str]:
    """Attributes of imported sweeps: `columns`, `left_out` and `warnings`, where there are any."""
    sentences = {
        "columns": _columns_text(readings, labels),
        "left_out": _left_out(readings, grouping),
        "warnings": "; ".join(_warnings(readings, labels, grouping)),
    }
    return {name: text for name, text in sentences.items() if text}


def with_device_warnings(sweeps: xr.Dataset) -> xr.Dataset:
    """The sweeps; faults of the device that measured them are added to the attribute `warnings`."""
    faults = device_faults(sweeps)
    found = [sweeps.attrs["warnings"]] if "warnings" in sweeps.attrs else []
    for law in dict.fromkeys(each.law for each in faults):
        first, *others = [each for each in faults if each.law == law]
        more = f" ({len(others)} more such)" if others else ""
        found.append(f"{first}{more}")
    return sweeps.assign_attrs(warnings="; ".join(found)) if found else sweeps


def _columns_text(readings: ImportedReadings, labels: LineLabels) -> str:
    table = readings.table
    taken = [readings.frequency_column, *readings.pair]
    parts = [f"{column.holds} from {_named(column)}" for column in taken]
    if readings.compared:
        parts[-1] += f"; {_listed(readings.compared)} agree{'s' * (len(readings.compared) == 1)}"
    if labels.columns:
        parts[-1] += f"; labels from {_listed(labels.columns)}"
    used = {column.place for column in [*taken, *readings.compared, *labels.columns]}
    idle = [
        f"`{n}`" for place, n in enumerate(table.names) if n not in ("", "-") and place not in used
    ]
    if idle:
        parts[-1] += f"; not used: {', '.join(idle)}"
    where = f"header in line {table.header}: " if table.header else ""
    return where + ", ".join(parts)


def _named(column: Column) -> str:
    return f"`{column.name}`" + (" (negated)" if column.factor < 0 else "")


def _listed(columns: list[Column]) -> str:
    return ", ".join(f"`{column.name}`" for column in columns)


def _left_out(readings: ImportedReadings, grouping: Grouping) -> str:
    text = left_out_text(readings.table.left_out)
    if grouping.dropped and len(grouping.sweeps) > 1:
        listed = ", ".join(f"{f:.6g} Hz" for _, f in grouping.dropped[:6])
        more = f" and {len(grouping.dropped) - 6} more" if len(grouping.dropped) > 6 else ""
        text += f"; therefore {listed}{more} is left out of all {len(grouping.sweeps)} sweeps"
    return text


def _warnings(readings: ImportedReadings, labels: LineLabels, grouping: Grouping) -> list[str]:
    table, found = readings.table, []
    Z = readings.Z[~readings.failed]
    lines = np.array([line for line, _ in table.rows])[~readings.failed]
    if readings.kind is IMPEDANCE:
        found += _impedance_warnings(readings, Z, lines)
    elif (above := amplifying(Z)).any():
        found.append(
            f"|V / V_s| > 1 in {above.sum()} of {len(Z)} readings, the first in line "
            f"{lines[np.argmax(above)]}: no passive skin amplifies; is the unit right?"
        )
    if grouping.frequencies.jitter:
        found.append(
            f"frequencies differ by up to {1e6 * grouping.frequencies.jitter:.3g} ppm between "
            "sweeps; those of the first sweep stand for all"
        )
    for column in labels.counting:
        found.append(f"`{column.name}` counts the lines and labels nothing")
    return found


def _impedance_warnings(readings: ImportedReadings, Z: Complex, lines: Integer) -> list[str]:
    """Remarks on impedances that no skin has. Z: ohm, by line."""
    found = []
    active = np.abs(np.angle(Z)) > PASSIVE
    if active.any():
        found.append(
            f"Re Z < 0 in {active.sum()} of {len(Z)} readings, the first in line "
            f"{lines[np.argmax(active)]}: no passive part has a phase beyond 90 degrees"
        )
    inductive = np.mean(Z.imag > 0)
    if inductive > 0.5 and readings.quantities != ("Rs", "Cp"):
        second = readings.pair[1]
        found.append(
            f"Im Z > 0 in {inductive:.0%} of the readings, as of an inductor; if `{second.name}` "
            "holds the negative, name it with a minus in --columns"
        )
    return found
