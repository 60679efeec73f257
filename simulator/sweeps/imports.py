"""Imports measured sweeps of other tools into the schema of simulated ones.

A file is a table of named columns in any order, separated by tab, semicolon, comma or spaces, with
comments (# % ; !) anywhere, anything above its header and text below its readings. A name carries
its unit: `Frequency (kHz)`, `f/Hz`, `Rs [kohm]`, `-Z'' (ohm)`, `theta (deg)`, `Cp_pF`; without one
it is SI, and a phase must have one. Columns of a sweep, press, row, column, repetition, cycle,
interface or session label the lines; without them a sweep begins where frequencies start over.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import InputError
from .importing.account import account, left_out_text, repeated_readings, with_device_warnings
from .importing.branch import branch_attributes, checked_branch, choose_branches
from .importing.curves import curves
from .importing.grouping import Defaults, grouped, joined_labels, line_labels, reading_places
from .importing.reading_columns import imported_readings, joined_readings
from .importing.table import read_table
from .inputs import check_file_kind
from .joining import aligned, concatenate, merged_attributes
from .schema import build

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Defaults", "import_file", "import_files"]
FILE_ATTRIBUTES = ("columns", "left_out", "warnings", "branch_doubt")
"""Attributes that name the file where they differ between files."""


def import_file(
    path: str | Path,
    defaults: Defaults = Defaults(),  # noqa: B008
    *,
    branch: str = "followed",
    columns: str | None = None,
    strict: bool = False,
) -> xr.Dataset:
    """The sweeps of one file.

    branch: choice between the two reactances if a file has Rs and Cp alone: `followed` along the
    frequencies, `capacitive` or `resistive`. columns: names of all columns, separated by commas, in
    place of those of a header; `-` for one that is not used. strict: a line that is no reading is
    refused.

    The attribute `branch_rule` states the rule of the branch, `branch_doubt` the readings that may
    be on the wrong one; `quantities` names what gave Z, `columns` the columns and what they were
    taken for, `left_out` the lines that are no readings, `warnings` what is unusual, and `preamble`
    holds the text above the header.
    Raises InputError naming the file, and the line if there is one, that cannot be read.
    """
    path = Path(path)
    check_file_kind(path, "sweeps")
    names = None if columns is None else [name.strip() for name in columns.split(",")]
    parts = [imported_readings(each) for each in curves(read_table(path, names))]
    labels = [line_labels(each.table, each.frequency, defaults) for each in parts]
    readings, labels = joined_readings(parts), joined_labels(labels)
    table = readings.table
    grouping = grouped(table, readings.frequency, readings.failed, labels)
    left_out = [*table.left_out, *repeated_readings(readings, grouping)]
    if strict and left_out:
        raise InputError(f"{path}: {left_out_text(left_out)}: no reading, as --strict asks")
    sweeps = grouping.sweeps
    hint = " (columns of other curves stand beside it; --columns with - for them reads one curve)"
    places = reading_places(table, sweeps, hint if readings.beside else "")
    interfaces, frequency, taken, where = places
    Z, rule = np.where(taken, readings.Z[where], np.nan), {}
    if readings.quantities == ("Rs", "Cp"):
        found = choose_branches(Z, frequency, checked_branch(branch), taken)
        Z, rule = found.Z, branch_attributes(found, branch, frequency, interfaces)
    imported = build(
        Z,
        frequency,
        interface=interfaces,
        press=[sweep.press for sweep in sweeps],
        row=[sweep.row for sweep in sweeps],
        column=[sweep.column for sweep in sweeps],
        session=[sweep.session for sweep in sweeps],
        shown={name: values[where] for name, values in readings.shown.items()},
        kind=readings.kind,
        taken=None if taken.all() else taken,
        attributes={
            "source": path.name,
            "quantities": " and ".join(readings.quantities),
            **account(readings, labels, grouping, left_out),
            "preamble": table.preamble,
            **rule,
        },
    ).dataset()
    return with_device_warnings(imported)


def import_files(
    paths: Sequence[str | Path], defaults: Sequence[Defaults], **options: Any
) -> xr.Dataset:
    """The sweeps of several files in their order; `defaults` has one entry for each.

    options: as in `import_file`; sweeps in `branch_doubt` are counted in each file. Attributes that
    differ between files are listed, separated by semicolons.
    Raises InputError if a file cannot be read, or if its frequencies or interfaces differ from
    those of the first.
    """
    pairs = zip(paths, defaults, strict=True)
    parts = [import_file(path, each, **options) for path, each in pairs]
    differing = [name for name in FILE_ATTRIBUTES if len({p.attrs.get(name) for p in parts}) > 1]
    parts = [_with_file_name(part, differing) for part in parts]
    whole = [
        aligned(part, path, parts[0], paths[0]) for part, path in zip(parts, paths, strict=True)
    ]
    return concatenate(whole).assign_attrs(merged_attributes(parts))


def _with_file_name(part: xr.Dataset, names: Sequence[str]) -> xr.Dataset:
    """Adds the file's name to the named attributes."""
    source, there = part.attrs["source"], [name for name in names if name in part.attrs]
    return part.assign_attrs({name: f"{source}: {part.attrs[name]}" for name in there})
