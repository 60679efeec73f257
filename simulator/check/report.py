"""What is to be said of measured or simulated sweeps: a table, files of it, a residual chart."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..charts import COLOURS, ENDINGS, chart, frequency_axis
from ..sweeps import InputError, whole_file
from ..sweeps.examination import Judgement

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from rich.table import Table

SUMMARY = [
    "sweep",
    "press",
    "interface",
    "lowest_phase_deg",
    "highest_phase_deg",
    "noise",
    "noise_from",
    "misfit",
    "inductance_H",
    "broken",
]
RESIDUALS = [
    "sweep",
    "interface",
    "frequency_Hz",
    "residual_real",
    "residual_imag",
    "allowed",
    "fitted",
]
PASSING = "0.6"
AT_MOST_NAMED = 6


def checked_report(path: Path) -> Path:
    """The same path, if a report can be written there: a chart's name, or that of a folder.

    Raises InputError where it has another ending or its folder does not exist.
    """
    if path.suffix not in ("", *ENDINGS) and not path.is_dir():
        endings = ", ".join(ENDINGS)
        raise InputError(f"{path}: must end in {endings} or be a folder, got {path.suffix!r}")
    if not path.parent.is_dir():
        raise InputError(f"{path}: the folder {path.parent} does not exist")
    if path.suffix == "" and path.exists() and not path.is_dir():
        raise InputError(f"{path}: is a file, not a folder")
    return path


def write_report(judgements: Sequence[Judgement], path: Path) -> None:
    """The residual chart as `path`; in a folder, tables of all verdicts and residuals beside it."""
    if path.suffix in ENDINGS and not path.is_dir():
        draw_residuals(judgements, path)
        return
    path.mkdir(exist_ok=True)
    draw_residuals(judgements, path / "residuals.png")
    _write_rows(path / "verdicts.csv", SUMMARY, map(_summary, judgements))
    rows = (row for judgement in judgements for row in _readings(judgement))
    _write_rows(path / "residuals.csv", RESIDUALS, rows)


def verdict_table(judgements: Sequence[Judgement]) -> Table:
    """One line for every sweep at every interface."""
    from rich.table import Column, Table

    numbers = [Column(name, justify="right") for name in ("phase (deg)", "noise", "misfit")]
    table = Table("sweep", "press", "interface", *numbers, "verdict", box=None)
    for each in judgements:
        table.add_row(
            str(each.sweep),
            each.press,
            each.interface,
            f"{each.phase[0]:.1f} to {each.phase[1]:.1f}",
            f"{100 * np.median(each.noise):.2g} %",
            f"{100 * each.spectrum.misfit:.2g} %",
            f"{len(each.broken)} broken" if each.broken else "pass",
        )
    return table


def explanations(judgements: Iterable[Judgement]) -> list[str]:
    """One line for every broken law, and for every inductance that was set aside."""
    return [line for each in judgements for line in [*map(str, each.broken), *_set_aside(each)]]


def _set_aside(judgement: Judgement) -> list[str]:
    spectrum = judgement.spectrum
    if not spectrum.inductive.any():
        return []
    onset = spectrum.frequency[spectrum.inductive][0]
    return [
        f"sweep {judgement.sweep}, interface {judgement.interface}: inductive from {onset:.6g} Hz "
        f"on; the readings below were judged behind {spectrum.inductance:.2g} H in series"
    ]


def draw_residuals(judgements: Sequence[Judgement], path: Path) -> None:
    """Residual of the nearest passive network against frequency, real and imaginary part.

    Grey: sweeps that pass. Coloured: sweeps that break a law, crosses where they do. Shaded: what
    the first sweep is allowed. Inductive readings have no residual: their crosses stand at 0.
    """
    with chart(path, 9, 4.2) as figure:
        for axes, part in zip(figure.subplots(1, 2, sharey=True), ("real", "imag"), strict=True):
            _draw_part(axes, part, judgements)
            frequency_axis(axes)
            axes.set_title({"real": "Real part", "imag": "Imaginary part"}[part])
        figure.axes[0].set_ylabel("(Z - nearest passive network) / |Z| (%)")
        handles, labels = figure.axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 4))
        figure.suptitle(f"Kramers-Kronig residual; spectra: {len(judgements)}")


def _draw_part(axes: Axes, part: str, judgements: Sequence[Judgement]) -> None:
    allowed, kHz = 100 * judgements[0].allowed, judgements[0].spectrum.frequency / 1e3
    axes.fill_between(kHz, -allowed, allowed, color="0.93", label="allowed")
    passing = [each for each in judgements if not each.broken]
    for index, each in enumerate(passing):
        _draw_residual(axes, part, each, PASSING, "passes" if index == 0 else "")
    for index, each in enumerate(each for each in judgements if each.broken):
        label = f"sweep {each.sweep}, {each.interface}" if index < AT_MOST_NAMED else ""
        _draw_residual(axes, part, each, COLOURS[index % len(COLOURS)], label)


def _draw_residual(axes: Axes, part: str, judgement: Judgement, colour: str, label: str) -> None:
    spectrum, kept = judgement.spectrum, ~judgement.spectrum.inductive
    kHz = spectrum.frequency / 1e3
    residual = 100 * np.where(kept, getattr(spectrum.residual, part), 0)
    axes.plot(kHz[kept], residual[kept], marker=".", color=colour, label=label or "_")
    broken = [frequency for law in judgement.broken for frequency in law.frequency]
    wrong = np.isin(spectrum.frequency, broken)
    axes.plot(kHz[wrong], residual[wrong], "x", color=colour)


def _summary(judgement: Judgement) -> list[object]:
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


def _readings(judgement: Judgement) -> Iterable[list[object]]:
    spectrum = judgement.spectrum
    columns = (
        spectrum.frequency,
        spectrum.residual.real,
        spectrum.residual.imag,
        judgement.allowed,
        (~spectrum.inductive).astype(int),
    )
    for row in zip(*(column.tolist() for column in columns), strict=True):
        yield [judgement.sweep, judgement.interface, *row]


def _write_rows(path: Path, header: list[str], rows: Iterable[Sequence[object]]) -> None:
    with whole_file(path) as unfinished, unfinished.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)
