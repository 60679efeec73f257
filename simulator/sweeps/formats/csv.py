"""Sweeps as CSV for people: one line per sweep, interface and frequency, named columns.

Attributes (scene, settings ...) precede the table as TOML in comment lines; `pandas.read_csv` skips
them with `comment="#"`.
"""

from __future__ import annotations

import io
import json
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from itertools import dropwhile, takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import inputs
from ..csv_cells import guarded_comment, unguarded, write_cells
from ..digests import OWN_KEYS, UNSEALED, check_text, seal_text
from ..errors import InputError
from ..importing.branch import branch_attributes, choose_branches
from ..reading_quantities import (
    GAIN,
    IMPEDANCE,
    KINDS,
    MAGNITUDE,
    UNRELATED,
    branch_reactance,
    contradicting,
    contradiction_text,
    kind_of,
    parallel_capacitance,
)
from ..schema import (
    DIMENSIONS,
    SESSIONS,
    TIME,
    UNKNOWN_PRESS,
    UNNAMED,
    SweepTable,
    build,
    ordered,
    taken_of,
)
from ..units import plain_number

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

SECONDS = "time_s"
LABELS = ("press", "row", "column", "session")
COLUMN_OF = {each.name: each.column for kind in KINDS for each in kind.quantities}
"""Column of each quantity."""
HEADER = ["sweep", *LABELS, SECONDS, "interface", "frequency_Hz", *COLUMN_OF.values()]
TEXT_COLUMNS = ("press", "session", "interface")
"""Columns that hold text."""
DEFAULT_LABELS = {
    "sweep": "0",
    "press": UNKNOWN_PRESS,
    "row": "-1",
    "column": "-1",
    "interface": UNNAMED,
}
INTEGER_COLUMNS = ("sweep", "row", "column", "session")
MAX_INTEGER = 1e9
"""Limit of whole numbers; sessions with more digits are names."""
NO_SESSIONS = "the file has no column `session`: all its sweeps are taken for one session"
"""Value of the attribute `session_rule` for files without that column."""


def write_csv(sweeps: xr.Dataset | SweepTable, path: Path) -> None:
    """Writes sweeps in long form, one line per reading; they read back to the same bits."""
    write_csv_parts([sweeps], path)


def write_csv_parts(parts: Iterable[xr.Dataset | SweepTable], path: Path) -> None:
    """Like `write_csv`, for sweeps that are in memory one part after the other."""
    first = 0
    with path.open("w", encoding="utf-8", newline="") as file:
        for number, sweeps in enumerate(parts):
            table = _table(sweeps, first)
            if number == 0:
                file.write(UNSEALED + _comment_text(sweeps.attrs))
                write_cells(file, [table])
            write_cells(file, zip(*(each.tolist() for each in table.values()), strict=True))
            first += sweeps.sizes["sweep"]
    seal_text(path)


def _table(sweeps: xr.Dataset | SweepTable, first: int) -> dict[str, np.ndarray]:
    """Columns of the readings that were taken. first: number of the first sweep."""
    variables, taken = sweeps.variables, taken_of(sweeps)
    shape = [sweeps.sizes[name] for name in DIMENSIONS]
    read = sweep, interface, frequency = np.nonzero(
        np.ones(shape) if taken is None else np.broadcast_to(taken, shape)
    )
    table = {
        "sweep": first + sweep,
        **{name: variables[name].values[sweep] for name in LABELS},
        **({SECONDS: variables[TIME].values[sweep]} if TIME in variables else {}),
        "interface": variables["interface"].values[interface],
        "frequency_Hz": variables["frequency"].values[frequency],
        **{
            column: ordered(variables[name])[read]
            for name, column in COLUMN_OF.items()
            if name in variables
        },
    }
    return {name: table[name] for name in HEADER if name in table}


def read_csv(path: Path) -> xr.Dataset:
    """Reads sweeps from a CSV with named columns in any order.

    `frequency_Hz` is required, and either `gain` for gains, or `Rs_ohm` and at least one of `X_ohm`
    and `Cp_F`. If only `Cp_F` is given, X is followed along the frequencies (see `branch`), and the
    attributes `branch_rule` and `branch_doubt` say so. Columns of the sweep, the press and the
    interface may be absent from a file with one unlabelled sweep. Sessions may be numbers or names;
    if their column is absent, the attribute `session_rule` states the consequence.

    Raises InputError naming the file, and line and column if there are any: a missing column, a
    cell that is no plain decimal number, a sweep with other readings than the first, lines that do
    not match the checksum, and, without a checksum, a Cp that contradicts Rs and X.
    """
    content = inputs.table(path)
    sealed = check_text(path, content)
    comments = _comments(content)
    text, attributes = _text(path, content, len(comments)), _attributes(comments)
    if "session" not in text:
        attributes["session_rule"] = NO_SESSIONS
        text = text.assign(session="0")
    text, names = _sessions(text)
    table = _numbers(path, text).sort_values(["sweep", "interface", "frequency_Hz"], kind="stable")
    if not sealed:
        _check_capacitance(path, table)
    interfaces = list(table["interface"].unique())
    frequency = np.unique(table["frequency_Hz"])
    taken, columns = _readings(path, table, frequency)
    kind = kind_of(columns)
    if kind is IMPEDANCE and "X" not in columns:
        X = branch_reactance(columns["Rs"], columns["Cp"], frequency)
        found = choose_branches(columns["Rs"] + 1j * X, frequency, "followed", taken)
        columns["X"] = found.Z.imag
        attributes |= branch_attributes(found, "followed", frequency, interfaces)
    labels = table.drop_duplicates("sweep")
    return build(
        kind.reading(columns),
        frequency,
        interface=interfaces,
        press=list(labels["press"]),
        row=list(labels["row"].astype(int)),
        column=list(labels["column"].astype(int)),
        session=list(labels["session"].astype(int)),
        time=list(labels[SECONDS]) if SECONDS in labels else None,
        shown=columns,
        kind=kind,
        taken=None if taken.all() else taken,
        attributes={**attributes, **names},
    ).dataset()


def csv_marks(path: Path) -> tuple[set[str], dict[str, Any]]:
    """Names of the quantities that a CSV has columns of, and its attributes; cells are not read.

    Raises InputError or UnicodeDecodeError if the file is damaged, or cut off above its columns.
    """
    content = inputs.table(path)
    check_text(path, content)
    text = content.decode("utf-8-sig")
    columns = next(dropwhile(_is_comment, io.StringIO(text)), "").strip()
    if "\0" in text or (text and not columns):
        raise InputError(f"{path}: not a CSV")
    names = {cell.strip(' "') for cell in columns.split(",")}
    found = {name for name, column in COLUMN_OF.items() if column in names}
    return found, _attributes(_comments(content))


def _comment_text(attributes: Mapping[Any, Any]) -> str:
    """Attributes as TOML in comment lines."""
    import tomli_w

    plain = {
        str(name): value.tolist() if isinstance(value, np.generic | np.ndarray) else value
        for name, value in attributes.items()
    }
    readable = not any("\r" in str(value) for value in plain.values())
    text = guarded_comment(tomli_w.dumps(plain, multiline_strings=readable))
    return "".join(f"# {line}\n" for line in text.split("\n")[:-1])


def _comments(content: bytes) -> list[str]:
    """The comment lines above the table, without their sign."""
    lines = io.TextIOWrapper(io.BytesIO(content), encoding="utf-8-sig", errors="replace")
    return [line[1:].removeprefix(" ") for line in takewhile(_is_comment, lines)]


def _is_comment(line: str) -> bool:
    return line.startswith("#")


def _attributes(comments: Sequence[str]) -> dict[str, Any]:
    """Inverse of `_comment_text`; other comments become the attribute `preamble`."""
    try:
        attributes = inputs.tables("".join(comments))
    except tomllib.TOMLDecodeError:
        return {"preamble": "".join(comments)}
    return {name: value for name, value in attributes.items() if name not in OWN_KEYS}


def _sessions(table: pd.DataFrame) -> tuple[pd.DataFrame, dict[str, str]]:
    """The table with numbered sessions, and the attribute of their names if the file had names."""
    texts = table["session"]
    if texts.str.fullmatch(r"[+-]?[0-9]{1,9}").all():
        return table, {}
    names = {name: number for number, name in enumerate(dict.fromkeys(texts))}
    by_number = json.dumps({number: name for name, number in names.items()})
    return table.assign(session=[str(names[text]) for text in texts]), {SESSIONS: by_number}


def _text(path: Path, content: bytes, above: int) -> pd.DataFrame:
    """All cells below the comment lines as text, indexed by their line in the file."""
    import pandas as pd

    with inputs.named_damage(path, "not a CSV of sweeps", f"; {inputs.FOREIGN}"):
        cells = pd.read_csv(
            io.BytesIO(content),
            header=None,
            dtype=str,
            keep_default_na=False,
            skip_blank_lines=False,
            skiprows=above,
            encoding="utf-8-sig",
        ).fillna("")
    cells.index += above + 1
    cells = cells[(cells != "").any(axis=1)]
    table = cells.iloc[1:].set_axis([name.strip() for name in cells.iloc[0]], axis=1)
    _check_columns(path, list(table))
    if table.empty:
        raise InputError(f"{path}: holds no sweep")
    named = {name: table[name].map(unguarded) for name in TEXT_COLUMNS if name in table}
    absent_ones = {name: text for name, text in DEFAULT_LABELS.items() if name not in table}
    return table.assign(**named, **absent_ones)


def _check_columns(path: Path, there: list[str]) -> None:
    """Raises InputError if a column is missing, or if the file holds two kinds of readings."""
    gains = [name for name in (*GAIN.columns, *MAGNITUDE.columns) if name in there]
    both = [name for name in IMPEDANCE.columns if gains and name in there]
    if both:
        raise InputError(
            f"{path}: columns `{gains[0]}` and `{both[0]}` are of two kinds of readings; a file "
            "holds gains or impedances"
        )
    absent = [n for n in ("frequency_Hz", "gain" if gains else "Rs_ohm") if n not in there]
    if not gains and not {"X_ohm", "Cp_F"} & set(there):
        absent.append("X_ohm` or `Cp_F")
    if absent:
        missing = f"column `{absent[0]}` is missing; found {', '.join(there)}"
        raise InputError(f"{path}: {missing}; {inputs.FOREIGN}")


def _numbers(path: Path, table: pd.DataFrame) -> pd.DataFrame:
    import pandas as pd

    numeric = [name for name in HEADER if name in table and name not in ("press", "interface")]
    in_order_of_appearance = pd.Categorical(table["interface"], table["interface"].unique())
    lines = list(table.index)
    return table.assign(
        interface=in_order_of_appearance,
        **{name: _checked_numbers(path, name, list(table[name]), lines) for name in numeric},
    )


def _checked_numbers(path: Path, name: str, column: list[str], lines: list[int]) -> np.ndarray:
    values = np.array([plain_number(text) for text in column])
    good, kind = np.isfinite(values), "finite"
    if name in INTEGER_COLUMNS:
        good, kind = good & (values == np.rint(values)) & (np.abs(values) < MAX_INTEGER), "whole"
    bad = np.flatnonzero(~good)
    if bad.size:
        raise InputError(
            f"{path}: line {lines[bad[0]]}: `{name}` must be a {kind} number, "
            f"got {column[bad[0]]!r}"
        )
    return values


def _check_capacitance(path: Path, table: pd.DataFrame) -> None:
    """Raises InputError if a Cp contradicts Rs and X, which no reading of a meter does."""
    if not set(IMPEDANCE.columns) <= set(table):
        return
    Rs, X, Cp, f = (table[name].to_numpy() for name in (*IMPEDANCE.columns, "frequency_Hz"))
    wrong = contradicting(Rs, X, Cp, f, UNRELATED)
    if wrong.any():
        k = int(np.argmax(wrong))
        found = float(parallel_capacitance(Rs[k] + 1j * X[k], f[k]))
        raise InputError(
            f"{path}: line {table.index[k]}: `Cp_F` {contradiction_text(Cp[k], found)}"
        )


def _readings(
    path: Path, table: pd.DataFrame, frequency: np.ndarray
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """The mask of readings taken, equal in all sweeps, and the quantities by name.

    Shapes (interface, frequency) and (sweep, interface, frequency); NaN where nothing was read.
    """
    number, sweeps = table["sweep"].factorize()
    shape = len(sweeps), len(table["interface"].unique()), frequency.size
    where = (
        number,
        table["interface"].cat.codes.to_numpy(),
        np.searchsorted(frequency, table["frequency_Hz"]),
    )
    counts = np.zeros(shape, dtype=np.int64)
    np.add.at(counts, where, 1)
    if counts.max() > 1 or (counts != counts[0]).any():
        raise InputError(
            f"{path}: every sweep must hold the same readings exactly once: each interface at the "
            "frequencies that it has in the other sweeps"
        )
    columns = {
        name: np.full(shape, np.nan) for name, column in COLUMN_OF.items() if column in table
    }
    for name, values in columns.items():
        values[where] = table[COLUMN_OF[name]]
    return counts[0] > 0, columns
