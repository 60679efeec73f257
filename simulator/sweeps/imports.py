"""Imports measured sweeps of other tools into the schema of simulated ones.

A file is a table of named columns in any order, separated by tab, semicolon or comma, with decimal
points or decimal commas, lines of comment (# % ;) anywhere and anything above its header. A name
carries its unit: `Frequency (kHz)`, `f/Hz`, `Rs [kohm]`, `-Z'' (ohm)`, `theta (deg)`, `Cp_pF`;
without one it is SI, and a phase must have one. Columns of a sweep, press, row, column, repetition,
interface or session label the lines; without them a sweep begins where frequencies start over.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .file_kinds import check_file_kind
from .importing.branch import branch_attributes, checked_branch, choose_branches
from .importing.dialect import read_table
from .importing.grouping import Defaults, grouped, reading_places
from .importing.impedance_columns import impedance_readings
from .joining import aligned
from .schema import build, concatenate

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Defaults", "import_file", "import_files"]


def import_file(
    path: str | Path,
    defaults: Defaults = Defaults(),  # noqa: B008
    branch: str = "followed",
) -> xr.Dataset:
    """The sweeps of one file.

    branch: choice between the two reactances if the file has Rs and Cp alone: `followed` along the
    frequencies, `capacitive` or `resistive`. The attribute `branch_rule` then states the rule,
    `branch_doubt` the readings that may be on the wrong branch; `quantities` names the columns that
    gave Z, `preamble` holds the text above the header.
    Raises InputError naming the file, and the line if there is one, that cannot be read.
    """
    path = Path(path)
    check_file_kind(path, "sweeps")
    table = read_table(path)
    readings = impedance_readings(table)
    sweeps = grouped(table, readings.frequency, defaults)
    interfaces, frequency, taken, where = reading_places(table, sweeps)
    Z, rule = np.where(taken, readings.Z[where], np.nan), {}
    if readings.pair == ("Rs", "Cp"):
        found = choose_branches(Z, frequency, checked_branch(branch), taken)
        Z, rule = found.Z, branch_attributes(found, branch, frequency, interfaces)
    return build(
        Z,
        frequency,
        interface=interfaces,
        press=[sweep.press for sweep in sweeps],
        row=[sweep.row for sweep in sweeps],
        column=[sweep.column for sweep in sweeps],
        session=[sweep.session for sweep in sweeps],
        Cp=readings.Cp[where],
        taken=None if taken.all() else taken,
        attributes={
            "source": Path(path).name,
            "quantities": " and ".join(readings.pair),
            "preamble": table.preamble,
            **rule,
        },
    )


def import_files(
    paths: Sequence[str | Path], defaults: Sequence[Defaults], branch: str = "followed"
) -> xr.Dataset:
    """The sweeps of several files in their order; `defaults` has one entry for each.

    branch: as in `import_file`; sweeps in `branch_doubt` are counted in each file separately.
    Attributes that differ between files are listed, separated by semicolons.
    Raises InputError if a file cannot be read, or if its frequencies or interfaces differ from
    those of the first.
    """
    parts = [import_file(path, each, branch) for path, each in zip(paths, defaults, strict=True)]
    if len(parts) > 1:
        parts = [_with_file_in_doubt(part) for part in parts]
    aligned_parts = [
        aligned(part, path, parts[0], paths[0]) for part, path in zip(parts, paths, strict=True)
    ]
    joined = concatenate(aligned_parts)
    texts = {name: [part.attrs.get(name, "") for part in parts] for name in _attribute_names(parts)}
    return joined.assign_attrs(
        {name: "; ".join(filter(None, dict.fromkeys(each))) for name, each in texts.items()}
    )


def _with_file_in_doubt(part: xr.Dataset) -> xr.Dataset:
    """Adds the file's name to the attribute `branch_doubt`."""
    if "branch_doubt" not in part.attrs:
        return part
    named = f"{part.attrs['source']}: {part.attrs['branch_doubt']}"
    return part.assign_attrs(branch_doubt=named)


def _attribute_names(parts: Sequence[xr.Dataset]) -> list[str]:
    return list(dict.fromkeys(str(name) for part in parts for name in part.attrs))
