"""Report of a check: a table on the terminal, a chart, and CSV files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..chart_style import ENDINGS
from ..report.files import filled_at_once, write_rows
from ..report.terminal import table
from ..sweeps import InputError, checked_folder, checked_output
from ..sweeps.laws.examination import Verdict
from .residuals import draw_residuals

if TYPE_CHECKING:
    from rich.table import Table

SUMMARY = "sweep press interface lowest_phase_deg highest_phase_deg noise noise_from misfit".split()
SUMMARY += ["inductance_H", "broken"]
RESIDUALS = "sweep interface frequency_Hz residual_real residual_imag allowed fitted broken".split()

WRITTEN = ("residuals.png", "verdicts.csv", "residuals.csv")
"""Names of the files of a report."""


def checked_report(path: Path) -> Path:
    """Returns the path if a report can be written there: a chart or a folder.

    Raises InputError for another ending or a missing folder.
    """
    if path.is_dir() or not path.suffix:
        return checked_folder(path, *WRITTEN)
    if path.suffix not in ENDINGS:
        endings = ", ".join(ENDINGS)
        raise InputError(f"{path}: must end in {endings} or be a folder, got {path.suffix!r}")
    return checked_output(path, ENDINGS)


def write_report(verdicts: Sequence[Verdict], path: Path) -> None:
    """Writes the residual chart; in a folder also tables of all verdicts and residuals."""
    if path.suffix in ENDINGS and not path.is_dir():
        draw_residuals(verdicts, path)
        return
    rows = (row for verdict in verdicts for row in _readings(verdict))
    with filled_at_once(path) as folder:
        draw_residuals(verdicts, folder / "residuals.png")
        write_rows(folder / "verdicts.csv", SUMMARY, map(_summary, verdicts))
        write_rows(folder / "residuals.csv", RESIDUALS, rows)


def verdict_table(verdicts: Sequence[Verdict]) -> Table:
    """Table with one line for every sweep at every interface."""
    heads = ["sweep", "press", "interface", "phase (deg)", "noise", "misfit", "verdict"]
    rows = (
        [
            str(each.sweep),
            each.press,
            each.interface,
            f"{each.phase[0]:.1f} to {each.phase[1]:.1f}",
            f"{100 * np.median(each.noise):.2g} %",
            f"{100 * each.spectrum.misfit:.2g} %",
            _verdict(len(each.broken)),
        ]
        for each in verdicts
    )
    return table(heads, rows, (3, 4, 5))


def _verdict(broken: int) -> str:
    return f"{broken} law{'s' if broken > 1 else ''} broken" if broken else "pass"


def explanations(verdicts: Iterable[Verdict]) -> list[str]:
    """One line for every broken law, and for every inductance that was excluded."""
    return [
        line for each in verdicts for line in [*map(str, each.broken), *_excluded_inductance(each)]
    ]


def _excluded_inductance(verdict: Verdict) -> list[str]:
    spectrum = verdict.spectrum
    if not spectrum.inductive.any():
        return []
    onset, inductance = spectrum.frequency[spectrum.inductive][0], spectrum.inductance
    behind = f"behind {inductance:.2g} H in series" if inductance else "by themselves"
    return [
        f"sweep {verdict.sweep}, interface {verdict.interface}: inductive from {onset:.6g} Hz "
        f"on; the readings below were checked {behind}"
    ]


def _summary(verdict: Verdict) -> list[object]:
    spectrum = verdict.spectrum
    return [
        verdict.sweep,
        verdict.press,
        verdict.interface,
        *verdict.phase,
        float(np.median(verdict.noise)),
        verdict.noise_from,
        spectrum.misfit,
        spectrum.inductance,
        "; ".join(each.law for each in verdict.broken),
    ]


def _readings(verdict: Verdict) -> Iterable[list[object]]:
    spectrum = verdict.spectrum
    columns = (
        spectrum.frequency,
        spectrum.residual.real,
        spectrum.residual.imag,
        verdict.allowed,
        (~spectrum.inductive).astype(int),
    )
    for row in zip(*(column.tolist() for column in columns), strict=True):
        laws = [each.law for each in verdict.broken if row[0] in each.frequency]
        yield [verdict.sweep, verdict.interface, *row, "; ".join(laws)]
