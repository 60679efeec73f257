"""Sentences about an import: which columns were taken, what was left out, what is unusual."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Complex, Integer
from ..reading_noise import device_faults
from ..reading_quantities import IMPEDANCE
from .branch import runs_text
from .columns import Column
from .grouping import Grouping, LineLabels
from .reading_columns import ImportedReadings, amplifying
from .table import LeftOut

if TYPE_CHECKING:
    import xarray as xr

PASSIVE = np.pi / 2 + np.radians(1)
"""Phase of a passive part, with 1 degree of allowance, in rad."""
SEGMENTS = 0.1
"""Largest relative difference of Z between segments of one spectrum at a frequency of both."""
MAX_NAMED = 12
"""Number of kinds of lines, and of runs of lines, that are named."""


def account(
    readings: ImportedReadings, labels: LineLabels, grouping: Grouping, left_out: list[LeftOut]
) -> dict[str, str]:
    """Attributes of imported sweeps: `columns`, `left_out` and `warnings`, where there are any."""
    sentences = {
        "columns": _columns_text(readings, labels),
        "left_out": _left_out(left_out, grouping),
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
    table, curves = readings.table, [readings, *readings.beside]
    taken = ", and ".join(map(_taken_text, curves))
    if len(curves) > 1:
        taken = f"{len(curves)} curves beside each other: {taken}"
    if labels.columns:
        taken += f"; labels from {_listed(labels.columns)}"
    used = {
        column.place
        for each in curves
        for column in [each.frequency_column, *each.pair, *each.compared, *labels.columns]
    }
    idle = [
        f"`{n}`" for place, n in enumerate(table.names) if n not in ("", "-") and place not in used
    ]
    if idle:
        taken += f"; not used: {', '.join(idle)}"
    return (f"header in line {table.header}: " if table.header else "") + taken


def _taken_text(readings: ImportedReadings) -> str:
    """The columns that gave one curve, and those that agree with them."""
    taken = [readings.frequency_column, *readings.pair]
    text = ", ".join(f"{column.holds} from {_named(column)}" for column in taken)
    if readings.compared:
        text += f"; {_listed(readings.compared)} agree{'s' * (len(readings.compared) == 1)}"
    return text


def _named(column: Column) -> str:
    unit = f" (in {column.unit})" if column.unit else ""
    return f"`{column.name}`{unit}" + (" (negated)" if column.factor < 0 else "")


def _listed(columns: list[Column]) -> str:
    return ", ".join(f"`{column.name}`" for column in columns)


def repeated_readings(readings: ImportedReadings, grouping: Grouping) -> list[LeftOut]:
    """Lines left out as two segments of a spectrum have their frequency.

    Raises InputError if such readings differ by more than SEGMENTS.
    """
    found, rows = [], readings.table.rows
    for kept, other in grouping.repeated:
        if readings.failed[other]:
            continue
        (line, _), (repeated, _) = rows[kept], rows[other]
        off = abs(readings.Z[other] / readings.Z[kept] - 1)
        where = f"{readings.frequency[other]:.6g} Hz of line {line}"
        if off > SEGMENTS:
            raise readings.table.error(
                repeated,
                f"goes on with a spectrum from {where}, but its reading differs by {off:.2g} of "
                "|Z|; import one segment, or label sweeps in a column `sweep`",
            )
        reason = f"once more {where}, which is kept: segments of one spectrum"
        found.append(LeftOut(repeated, reason + f", {100 * off:.2g} % apart" * bool(off > 0)))
    return found


def _left_out(left_out: list[LeftOut], grouping: Grouping) -> str:
    text = left_out_text(left_out)
    if grouping.dropped and len(grouping.sweeps) > 1:
        listed = ", ".join(f"{f:.6g} Hz" for _, f in grouping.dropped[:6])
        more = f" and {len(grouping.dropped) - 6} more" if len(grouping.dropped) > 6 else ""
        text += f"; therefore {listed}{more} is left out of all {len(grouping.sweeps)} sweeps"
    return text


def _warnings(readings: ImportedReadings, labels: LineLabels, grouping: Grouping) -> list[str]:
    table, found = readings.table, list(readings.table.remarks)
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
    if grouping.joined:
        found.append(
            f"segments of one spectrum are one sweep, although values of {_labels(labels)} differ"
        )
    for column in labels.counting:
        found.append(f"`{column.name}` counts the lines and labels nothing")
    return found


def _labels(labels: LineLabels) -> str:
    listed = [each for each in labels.columns if each.holds in ("sweep", "repetition", "cycle")]
    return _listed(listed) or "labels"


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


def left_out_text(left_out: Sequence[LeftOut]) -> str:
    """The lines that were left out, by reason; empty if there are none."""
    by_reason: dict[str, list[int]] = {}
    for each in left_out:
        by_reason.setdefault(each.reason, []).append(each.line)
    listed = [
        f"line{'s' * (len(lines) > 1)} {runs_text(sorted(lines), MAX_NAMED)} ({reason})"
        for reason, lines in by_reason.items()
    ]
    more = f" and {len(listed) - MAX_NAMED} more kinds" if len(listed) > MAX_NAMED else ""
    return "; ".join(listed[:MAX_NAMED]) + more
