"""What is to be said of measured or simulated sweeps: a table on the terminal, and files of it."""

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
"""Patterns of the names of what is written."""


def checked_report(path: Path) -> Path:
    """The same path, if a report can be written there: a chart's name, or that of a folder.

    Raises InputError where it has another ending or its folder does not exist.
    """
    if path.is_dir() or not path.suffix:
        return checked_folder(path, *WRITTEN)
    if path.suffix not in ENDINGS:
        endings = ", ".join(ENDINGS)
        raise InputError(f"{path}: must end in {endings} or be a folder, got {path.suffix!r}")
    return checked_output(path, ENDINGS)


def write_report(judgements: Sequence[Verdict], path: Path) -> None:
    """The residual chart as `path`; in a folder, tables of all verdicts and residuals beside it."""
    if path.suffix in ENDINGS and not path.is_dir():
        draw_residuals(judgements, path)
        return
    rows = (row for judgement in judgements for row in _readings(judgement))
    with filled_at_once(path) as folder:
        draw_residuals(judgements, folder / "residuals.png")
        write_rows(folder / "verdicts.csv", SUMMARY, map(_summary, judgements))
        write_rows(folder / "residuals.csv", RESIDUALS, rows)


def verdict_table(judgements: Sequence[Verdict]) -> Table:
    """One line for every sweep at every interface."""
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
        for each in judgements
    )
    return table(heads, rows, (3, 4, 5))


def _verdict(broken: int) -> str:
    return f"{broken} law{'s' if broken > 1 else ''} broken" if broken else "pass"


def explanations(judgements: Iterable[Verdict]) -> list[str]:
    """One line for every broken law, and for every inductance that was set aside."""
    return [line for each in judgements for line in [*map(str, each.broken), *_set_aside(each)]]


def _set_aside(judgement: Verdict) -> list[str]:
    spectrum = judgement.spectrum
    if not spectrum.inductive.any():
        return []
    onset, inductance = spectrum.frequency[spectrum.inductive][0], spectrum.inductance
    behind = f"behind {inductance:.2g} H in series" if inductance else "by themselves"
    return [
        f"sweep {judgement.sweep}, interface {judgement.interface}: inductive from {onset:.6g} Hz "
        f"on; the readings below were judged {behind}"
    ]


def _summary(judgement: Verdict) -> list[object]:
    spectrum = judgement.spectrum
    return [
        judgement.sweep,
        judgement.press,
        judgement.interface,
        *judgement.phase,
        float(np.median(judgement.noise)),
        judgement.noise_from,
        spectrum.misfit,
        spectrum.inductance,
        "; ".join(each.law for each in judgement.broken),
    ]


def _readings(judgement: Verdict) -> Iterable[list[object]]:
    spectrum = judgement.spectrum
    columns = (
        spectrum.frequency,
        spectrum.residual.real,
        spectrum.residual.imag,
        judgement.allowed,
        (~spectrum.inductive).astype(int),
    )
    for row in zip(*(column.tolist() for column in columns), strict=True):
        laws = [each.law for each in judgement.broken if row[0] in each.frequency]
        yield [judgement.sweep, judgement.interface, *row, "; ".join(laws)]
