"""Says why a file has no table, with the columns that were seen."""

from __future__ import annotations

import csv
from pathlib import Path

from ...errors import InputError
from .header import MAX_SHOWN, Scan
from .number_format import number_like
from .text_lines import ALL_SEPARATORS, SEPARATORS, Lines, header_cells, line_cells, trimmed


def no_table(path: Path, lines: Lines, scans: list[Scan], given: list[str] | None) -> InputError:
    misfits = [scan for scan in scans if scan.misfit]
    if misfits:
        return InputError(f"{path}: {misfits[0].misfit}")
    if given is not None:
        return InputError(f"{path}: no line has {len(given)} numbers, as many as --columns names")
    if scans:
        scan = scans[-1]
        return InputError(
            f"{path}: no line of readings below the header in line {scan.line}, whose columns are "
            f"{listed(scan.readings[0][0])}"
        )
    return InputError(
        f"{path}: no line names a frequency column (as `Frequency (kHz)`, `f/Hz`) and a column of "
        f"impedance or gain beside it, separated by {', '.join(SEPARATORS.values())} or spaces"
        f"{_likely_header(lines)}; --columns f,Rs,X names columns"
    )


def _likely_header(lines: Lines) -> str:
    """The cells of the line above the first line of numbers, as the header that may be meant."""
    above: tuple[int, str] | None = None
    for number, text in lines:
        for separator in ALL_SEPARATORS:
            try:
                cells = trimmed(line_cells(text, separator))
            except csv.Error:
                continue
            if len(cells) > 2 and all(map(number_like, cells)):
                if above is None:
                    return f"; line {number} has {len(cells)} numbers and no names above it"
                names = trimmed(header_cells(above[1], separator))
                if len(names) < 2:
                    names = trimmed(header_cells(above[1], " "))
                return f"; line {above[0]} has {listed(names)}"
        if text.strip():
            above = number, text
    return ""


def listed(names: list[str]) -> str:
    shown = [name for name in names if name]
    more = f" and {len(shown) - 30} more" if len(shown) > 30 else ""
    return ", ".join(f"`{name[:MAX_SHOWN]}`" for name in shown[:30]) + more
