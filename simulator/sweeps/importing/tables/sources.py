"""Lines of the table of a file of any kind: text, Touchstone, spreadsheet."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ....arrays import Complex
from ... import inputs
from ...errors import InputError
from ...optional_packages import require_packages
from .text_lines import Lines, text_lines

BINARY = {
    ".mpr": "a .mpr is binary: export it as text (.mpt) in EC-Lab",
    ".xls": "a .xls is of an old format: save it as .xlsx or .csv",
}
WORKBOOKS = (".xlsx", ".xlsm")
TOUCHSTONE = re.compile(r"\.s\d+p", re.IGNORECASE)
EXTRA = "formats"
CONSISTENT = 0.05
"""Largest deviation from 1 of the sum or difference of S11 and S21 of a part between two ports."""


def sources(path: Path) -> Iterator[Lines]:
    """The lines of a file in each way that it may be meant, the most likely first.

    Raises InputError if it cannot be read, or if the extra that reads it is not installed.
    """
    suffix = path.suffix.lower()
    if suffix in BINARY:
        raise InputError(f"{path}: {BINARY[suffix]}")
    if TOUCHSTONE.fullmatch(suffix):
        yield _touchstone(path)
    elif suffix in WORKBOOKS:
        yield from _sheets(path)
    else:
        yield from text_lines(path)


def _touchstone(path: Path) -> Lines:
    """Frequency and impedance of a one-port, or of a part between two ports.

    The library gets text: given a path, it would first load the file as a pickle.
    """
    require_packages(path, EXTRA, "skrf")
    lines = next(text_lines(path))
    numbers = [number for number, text in lines if re.match(r"\s*[-+.\d]", text)]
    from skrf.io import Touchstone

    content = io.StringIO("\n".join(text for _, text in lines))
    content.name = path.name  # its ending tells Touchstone the number of ports
    try:
        read = Touchstone(content)
        f, s, z0 = read.f, read.s, read.z0[:, 0]
        s11 = s[:, 0, 0]
        found = z0 * (1 + s11) / (1 - s11) if s.shape[1] == 1 else _between_ports(path, s, z0)
        Z = np.asarray(found, dtype=np.complex128)
    except InputError:
        raise
    except Exception as error:
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise InputError(f"{path}: cannot be read as Touchstone: {reason}") from error
    if len(numbers) != len(f):
        raise InputError(f"{path}: has {len(f)} frequencies in {len(numbers)} lines of numbers")
    readings = zip(f.tolist(), Z.real.tolist(), Z.imag.tolist(), strict=True)
    rows = ["\t".join(map(repr, reading)) for reading in readings]
    return [(max(numbers[0] - 1, 1), "f (Hz)\tRs (ohm)\tX (ohm)"), *zip(numbers, rows, strict=True)]


def _between_ports(path: Path, s: Complex, z0: Complex) -> Complex:
    """Impedance of a part between two ports or from both to ground, whichever the file holds.

    In series S11 + S21 = 1 and Z = 2 z0 S11 / S21; to ground S21 - S11 = 1 and
    Z = -z0 S21 / (2 S11). s: shape (frequency, port, port). z0: ohm, shape (frequency,).
    """
    if s.shape[1] > 2:
        raise InputError(f"{path}: has {s.shape[1]} ports; Z is read from one or two")
    s11, s21 = s[:, 0, 0], s[:, 1, 0]
    in_series = bool((np.abs(s11 + s21 - 1) < CONSISTENT).all())
    to_ground = bool((np.abs(s21 - s11 - 1) < CONSISTENT).all())
    if in_series == to_ground:
        raise InputError(
            f"{path}: its two ports hold no single impedance: neither S11 + S21 (a part between "
            "the ports) nor S21 - S11 (a part to ground) is 1; save one port as .s1p"
        )
    return 2 * z0 * s11 / s21 if in_series else -z0 * s21 / (2 * s11)


def _sheets(path: Path) -> Iterator[Lines]:
    """The sheets of a workbook as lines of cells."""
    require_packages(path, EXTRA, "openpyxl")
    import pandas as pd

    try:
        with inputs.check_input(path, inputs.TABLE).open("rb") as file:
            inputs.check_archive(path, file)
            file.seek(0)
            sheets = pd.read_excel(
                file, sheet_name=None, header=None, dtype=object, na_filter=False, engine="openpyxl"
            )
    except InputError:
        raise
    except Exception as error:
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise InputError(f"{path}: cannot be read as a workbook: {reason}") from error
    for sheet in sheets.values():
        rows = sheet.to_numpy().tolist()
        yield [(n, "\t".join(map(_cell, row)).rstrip("\t")) for n, row in enumerate(rows, 1)]


def _cell(value: Any) -> str:
    """A cell as text; numbers with a point."""
    if value is None:
        return ""
    text = repr(value) if isinstance(value, float) else str(value)
    return " ".join(text.replace('"', "''").split())
