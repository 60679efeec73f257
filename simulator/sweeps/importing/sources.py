"""Lines of the table of a file of any kind: text, Touchstone, spreadsheet.

Layouts of instruments that are no table with a header are rewritten as one: a layout is a function
of a file's lines; it returns the lines of a table, or None if the file does not have that layout.
"""

from __future__ import annotations

import csv
import io
import itertools
import re
import warnings
import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO, Any

import numpy as np

from ...arrays import Complex
from .. import inputs
from ..errors import InputError
from ..optional_packages import require_packages
from .columns import UNITS, recognised
from .header import number_like, recognised_all
from .text_lines import (
    SEPARATORS,
    SPACE,
    Lines,
    line_cells,
    text_lines,
    trimmed,
)

TRACE = re.compile(r'"?TRACE:\s*(?P<name>[AB])"?\s*', re.IGNORECASE)
PARAMETER = re.compile(r'"?MEASURE PARAMETER:\s*(?P<text>[^"]+?)"?\s*', re.IGNORECASE)
PARAMETERS = {
    "IMPEDANCE MAG PHASE (DEG)": ("|Z|", "phase (deg)"),
    "IMPEDANCE MAG PHASE (RAD)": ("|Z|", "phase (rad)"),
    "ADMITTANCE MAG PHASE (DEG)": ("|Y|", "phase (deg)"),
    "ADMITTANCE MAG PHASE (RAD)": ("|Y|", "phase (rad)"),
    "IMPEDANCE REAL IMAG": ("Rs", "X"),
    "ADMITTANCE REAL IMAG": ("G", "B"),
}
"""Quantities of the traces A and B; others are written as Cp-D."""
MAX_BEFORE = 4
"""Number of cells that may stand before the name in a transposed table."""


def rewritten(path: Path, lines: Lines) -> tuple[str, Lines | None]:
    """Name of the layout and the lines as one table with a header; None if it is another.

    Raises InputError if a file has two layouts, or if its layout is broken.
    """
    found = {name: table for name, layout in LAYOUTS.items() if (table := layout(path, lines))}
    if len(found) > 1:
        raise InputError(f"{path}: can be read as {' and as '.join(found)}; import a part of it")
    return next(iter(found.items()), ("", None))


def _trace_blocks(path: Path, lines: Lines) -> Lines | None:
    """One block of lines for each of the traces A and B, as of HP and Agilent 4294A."""
    blocks: list[tuple[str, int, list[tuple[int, list[str]]]]] = []
    parameter = ""
    for number, text in lines:
        if (match := PARAMETER.fullmatch(text.strip())) is not None:
            parameter = " ".join(match["text"].split())
        elif (match := TRACE.fullmatch(text.strip())) is not None:
            blocks.append((match["name"].upper(), number, []))
        elif blocks:
            cells = trimmed(line_cells(text.replace('"', ""), "\t" if "\t" in text else ","))
            if cells and number_like(cells[0]):
                blocks[-1][2].append((number, cells))
    if not blocks or not parameter:
        return None
    names = _trace_names(path, parameter)
    if [name for name, _, _ in blocks] != ["A", "B"] * (len(blocks) // 2):
        raise InputError(f"{path}: line {blocks[-1][1]}: traces A and B must follow each other")
    table = [(blocks[0][1], "\t".join(["frequency (Hz)", *names]))]
    for (_, _, first), (_, start, second) in zip(blocks[::2], blocks[1::2], strict=True):
        if [cells[0] for _, cells in first] != [cells[0] for _, cells in second]:
            raise InputError(f"{path}: line {start}: trace B has other frequencies than trace A")
        for (line, a), (other, b) in zip(first, second, strict=True):
            _check_trace(path, line, a)
            _check_trace(path, other, b)
            table.append((line, "\t".join([a[0], a[1], b[1]])))
    return table


def _trace_names(path: Path, parameter: str) -> Sequence[str]:
    names = PARAMETERS.get(parameter.upper(), re.split(r"\s*[-,/]\s*", parameter))
    if len(names) != 2 or not all(recognised(name) for name in names):
        raise InputError(f"{path}: the measure parameter {parameter!r} of its traces is unknown")
    return names


def _check_trace(path: Path, line: int, cells: list[str]) -> None:
    """Raises InputError unless a trace has a real value and the imaginary one is 0."""
    try:
        values = [float(cell) for cell in cells[1:3]]
    except ValueError:
        values = []
    if len(values) < 2 or values[1] != 0:
        raise InputError(
            f"{path}: line {line}: a trace must have a frequency, a number and 0, got "
            f"{', '.join(cells)}"
        )


def _transposed(path: Path, lines: Lines) -> Lines | None:
    """One line for each quantity, its name before its numbers, as of LabOne."""
    named = [each for number, text in lines if (each := _named_line(number, text)) is not None]
    blocks: list[dict[str, tuple[int, list[str]]]] = []
    for number, name, cells in named:
        if not blocks or name in blocks[-1]:
            blocks.append({})
        blocks[-1][name] = number, cells
    for block in blocks:
        kinds = {column.holds for column in recognised_all(list(block))}
        if "frequency" not in kinds or len(kinds & UNITS.keys()) < 3:
            return None
    table: Lines = []
    for block in blocks:
        length = len(next(iter(block.values()))[1])
        first = next(iter(block.values()))[0]
        for name, (number, cells) in block.items():
            if len(cells) != length:
                raise InputError(
                    f"{path}: line {number}: `{name}` has {len(cells)} numbers, line {first} has "
                    f"{length}"
                )
        rows = zip(*(cells for _, cells in block.values()), strict=True)
        table += [(first, "\t".join(block)), *((first, "\t".join(cells)) for cells in rows)]
    return table


def _named_line(number: int, text: str) -> tuple[int, str, list[str]] | None:
    """Number, name and values of a line that holds one quantity."""
    if not re.search(r"[^\W\d_]{2}", text[:200]):
        return None
    for separator in (*SEPARATORS, SPACE):
        try:
            cells = trimmed(line_cells(text, separator))
        except csv.Error:
            continue
        if len(cells) < 3 or not (number_like(cells[-1]) and number_like(cells[-2])):
            continue
        for place, name in enumerate(cells[:MAX_BEFORE]):
            column, values = recognised(name), cells[place + 1 :]
            if column is None or column.holds not in UNITS or len(values) < 2:
                continue
            if all(map(number_like, values)):
                unit = " (rad)" if column.problem and place == MAX_BEFORE - 1 else ""
                return number, name + unit, values
    return None


LAYOUTS = {"blocks of traces A and B": _trace_blocks, "a line for each quantity": _transposed}


OTHERS = ("a file of another program", "write its frequencies and impedances as .csv there")
BINARY = {
    ".mpr": ("binary", "export it as text (.mpt) in EC-Lab"),
    ".pssession": ("a session of PSTrace", "export its measurement as .csv there"),
    ".ism": ("binary", "save it as ASCII in Thales or Zahner Analysis"),
    ".nox": ("binary", "export it as ASCII in NOVA"),
    ".mat": ("a file of MATLAB", "save its columns as .csv there, by writetable"),
    **dict.fromkeys((".xls", ".xlsb", ".ods"), ("no .xlsx", "save it as .xlsx or .csv")),
    **dict.fromkeys((".h5", ".hdf5", ".hdf", ".tdms", ".parquet", ".feather"), OTHERS),
    **dict.fromkeys((".pkl", ".pickle", ".joblib", ".npy", ".npz"), OTHERS),
    **dict.fromkeys((".zip", ".gz", ".7z", ".xz", ".bz2"), ("packed", "unpack it")),
}
"""What a file of an ending is that is not read, and what to do."""
WORKBOOKS = (".xlsx", ".xlsm")
TOUCHSTONE = re.compile(r"\.s(\d+)p", re.IGNORECASE)
NUMBER_OF_PORTS = re.compile(r"^\s*\[number of ports\]\s*(\S+)", re.IGNORECASE | re.MULTILINE)
SECOND_REFERENCE = re.compile(r"^\s*#[^!\n]*\sR\s+\S+[ \t]+[^\s!]", re.IGNORECASE | re.MULTILINE)
ONE_REFERENCE = "must have one reference impedance, real and > 0 ohm"
EXTRA = "formats"
AGREEMENT = 0.1
"""Largest deviation of S21 from what follows from S11, of the smaller of both: if a one-port with
crosstalk passed for a part in series, its impedance would be wrong by no more."""
REFLECTION_ERROR = 0.01
"""Error of S11 of a calibrated analyser: a directivity of 40 dB."""
MAX_ROWS, MAX_CELLS, MAX_TAGS = 2**20, 2**22, 2**24
"""Largest numbers of rows of a sheet, and, of a workbook, of cells up to the last one of each row
and of tags of XML; a cell has four."""
UNPACKED_RATIO = 100
"""Largest size of an unpacked workbook per packed byte; tables of numbers have 5 to 20."""
TOO_LARGE = (
    f"a workbook is read up to {MAX_ROWS} rows and {MAX_CELLS} cells; save the table alone, as .csv"
)
LONGEST_TEXT = 2**15
"""Largest number of characters of a cell, as of Excel."""
DOCTYPE = b"<!DOCTYPE"
OPEN = 1e-12
"""Smallest |1 - S11| that is no rounding of 1."""


def sources(path: Path) -> Iterator[Lines]:
    """The lines of a file in each way that it may be meant, the most likely first.

    Raises InputError if it cannot be read, or if the extra that reads it is not installed.
    """
    suffix = path.suffix.lower()
    if suffix in BINARY:
        what, advice = BINARY[suffix]
        raise InputError(f"{path}: a {suffix} is {what}: {advice}")
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
    text = "\n".join(line for _, line in lines)
    ports = (NUMBER_OF_PORTS.findall(text) + TOUCHSTONE.findall(path.suffix))[0]
    if ports not in ("1", "2"):
        raise InputError(f"{path}: Z is read from one or two ports, got {ports[:9]}")
    if SECOND_REFERENCE.search(text):  # some versions of the library ignore it
        raise InputError(f"{path}: {ONE_REFERENCE}")
    from skrf.io import Touchstone

    content = io.StringIO(text)
    content.name = path.name  # its ending tells Touchstone the number of ports
    with inputs.named_damage(path, "cannot be read as Touchstone"):
        read = Touchstone(content)
    numbers = [number for number, line in lines if re.match(r"\s*[-+.\d]", line)]
    if not numbers or len(numbers) != len(read.f):
        lengths = f"{len(read.f)} frequencies in {len(numbers)} lines of numbers"
        raise InputError(f"{path}: has {lengths}")
    Z = _impedance(path, read)
    readings = zip(read.f.tolist(), Z.real.tolist(), Z.imag.tolist(), strict=True)
    rows = ["\t".join(map(repr, reading)) for reading in readings]
    return [(max(numbers[0] - 1, 1), "f (Hz)\tRs (ohm)\tX (ohm)"), *zip(numbers, rows, strict=True)]


def _impedance(path: Path, read: Any) -> Complex:
    """Impedance of what a Touchstone holds, ohm; NaN where it is open (S11 = 1) or not a number."""
    s11, z0 = read.s[:, 0, 0], np.real(read.z0[:, 0])
    if (read.z0 != z0[:, np.newaxis]).any() or not (np.isfinite(z0) & (z0 > 0)).all():
        raise InputError(f"{path}: {ONE_REFERENCE}")
    if read.parameter in "ygh" and read.version == "1.0" and (z0 != 1).any():
        raise InputError(
            f"{path}: {read.parameter.upper()}-parameters of version 1 are read only if they are "
            "normalized to 1 ohm; save S- or Z-parameters"
        )
    Z, known = np.full(len(s11), complex(np.nan, np.nan)), np.isfinite(read.s).all(axis=(1, 2))
    s11, z0 = s11[known], z0[known]
    with np.errstate(divide="ignore", invalid="ignore"):
        if read.s.shape[1] == 2:
            Z[known] = z0 * _between_ports(path, s11, read.s[known, 1, 0])
        else:
            Z[known] = np.where(np.abs(1 - s11) < OPEN, np.nan, z0 * (1 + s11) / (1 - s11))
    return np.where(np.isfinite(Z), Z, complex(np.nan, np.nan))


def _between_ports(path: Path, s11: Complex, s21: Complex) -> Complex:
    """Impedance of a part between two ports or from both to ground, whichever the file holds.

    In series S21 = 1 - S11 and Z = 2 S11 / S21; to ground S21 = 1 + S11 and Z = -S21 / (2 S11), in
    units of the reference impedance.
    """
    if _follows(1 - s11, s21, s11):
        return 2 * s11 / s21
    if _follows(1 + s11, s21, s11):
        return -s21 / (2 * s11)
    raise InputError(
        f"{path}: its two ports hold no single impedance: S21 is neither 1 - S11 (a part between "
        "the ports) nor 1 + S11 (a part to ground) within 10 % of the smaller; save the port with "
        "the part as .s1p"
    )


def _follows(expected: Complex, s21: Complex, s11: Complex) -> bool:
    """Whether S21 is as expected, within AGREEMENT of what determines the impedance.

    That is the smaller of S11 and S21: a part of 1 Mohm in series has S21 = 1e-4, and so has what
    leaks to an open port. Where it is S21, one reading may deviate by the error of S11 as well.
    """
    smaller = np.minimum(np.abs(s11), np.abs(s21))
    error = np.where(np.abs(s21) < np.abs(s11), REFLECTION_ERROR, 0.0)
    deviation = np.abs(s21 - expected)
    whole = np.linalg.norm(deviation) <= AGREEMENT * np.linalg.norm(smaller)
    return bool(whole and (deviation <= AGREEMENT * smaller + error).all())


def _sheets(path: Path) -> list[Lines]:
    """The sheets of a workbook as lines of cells.

    A small file may place a cell in the last row and one in the last column, name one long text in
    every cell, or unpack to anything; so rows are read one by one, and counted.
    """
    require_packages(path, EXTRA, "openpyxl")
    import openpyxl

    file = io.BytesIO(inputs.content(path, inputs.TABLE))
    with inputs.named_damage(path, "cannot be read as a workbook"):
        _check_xml(path, file)
        with warnings.catch_warnings(action="ignore"):  # of styles and rules that openpyxl lacks
            book = openpyxl.load_workbook(file, read_only=True, data_only=True, keep_links=False)
            cells = itertools.count(1)
            return [_rows(path, sheet, cells) for sheet in book.worksheets]


def _rows(path: Path, sheet: Any, cells: Iterator[int]) -> Lines:
    """The rows of a sheet without repeated empty ones. cells: counts those of the workbook."""
    sheet.reset_dimensions()  # the file may lie
    lines: Lines = []
    for number, row in enumerate(sheet.iter_rows(), 1):
        text = "\t".join(_cell(cell) for cell in row if next(cells) <= MAX_CELLS).rstrip("\t")
        if number > MAX_ROWS or next(cells) > MAX_CELLS or len(text) > inputs.LINE:
            raise InputError(f"{path}: sheet {sheet.title!r}, row {number}: {TOO_LARGE}")
        if text or (lines and lines[-1][1]):
            lines.append((number, text))
    return lines


def _check_xml(path: Path, file: IO[bytes]) -> None:
    """Raises InputError if the parts of a workbook unpack to too many bytes or tags.

    Raises ValueError for a document type, by which texts may multiply.
    """
    limit = min(UNPACKED_RATIO * file.seek(0, 2) + inputs.MIB, inputs.TABLE.max_bytes)
    unpacked = tags = 0
    with zipfile.ZipFile(file) as archive:
        for name in archive.namelist():
            end = b""
            with archive.open(name) as part:
                for block in iter(lambda: part.read(inputs.MIB), b""):
                    unpacked, tags = unpacked + len(block), tags + block.count(b"<")
                    if unpacked > limit or tags > MAX_TAGS:
                        raise InputError(f"{path}: {name} unpacks to too much; {TOO_LARGE}")
                    plain = end + block.replace(b"\0", b"")  # of UTF-16
                    if DOCTYPE in plain:
                        raise ValueError(f"{name} has a document type")
                    end = plain[1 - len(DOCTYPE) :]


def _cell(cell: Any) -> str:
    """A cell as text; numbers with a point, whole ones without."""
    value = cell.value
    if value is None:
        return ""
    if cell.data_type == "e":
        return "nan"
    if isinstance(value, str) and len(value) > LONGEST_TEXT:
        raise ValueError(f"cell {cell.coordinate} has {len(value)} characters")
    value = int(value) if isinstance(value, float) and value.is_integer() else value
    return " ".join(str(value).replace('"', "''").split())
