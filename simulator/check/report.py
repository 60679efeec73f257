"""Report of a check: a table on the terminal, a chart, and CSV files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..chart_style import COLOURS, ENDINGS, chart, frequency_axis
from ..report.findings import Chart, DataTable, Findings, Head
from ..sweeps import InputError, checked_folder, checked_output
from ..sweeps.examination import Verdict

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import SubFigure

PASSING, UNNAMED = "0.6", "0.3"
BANDS = {"allowed": "0.93", "allowed where the misfit is too large": "0.8"}
PARTS = {"real": "Real part", "imag": "Imaginary part"}


class ColouredVerdict(NamedTuple):
    """A verdict and the colour in which it is drawn."""

    verdict: Verdict
    colour: str


def draw_residuals(verdicts: Sequence[Verdict], path: Path) -> None:
    """Draws residuals from the nearest passive network over frequency, and broken laws.

    A row for each interface: real and imaginary part. Grey: sweeps that pass. Coloured: sweeps that
    break a law. Shaded: the limits; crosses: residuals beyond them. Inductive readings have no
    residual. Below: a cross for each law at each frequency where a sweep breaks it.
    """
    interfaces = list(dict.fromkeys(each.interface for each in verdicts))
    laws = list(dict.fromkeys(law.law for each in verdicts for law in each.broken))
    drawn = _coloured(verdicts)
    heights = [3.4 * len(interfaces), *([0.9 + 0.3 * len(laws)] if laws else [])]
    with chart(path, 9, 0.9 + sum(heights)) as figure:
        parts = figure.subfigures(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
        _draw_rows(parts[0], interfaces, drawn)
        if laws:
            _draw_laws(parts[1], laws, drawn)
        handles, labels = _legend(parts[0].axes[0], drawn)
        figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 4))
        flagged = sum(bool(each.broken) for each in verdicts)
        figure.suptitle(f"{flagged} of {len(verdicts)} spectra break a law")


def _coloured(verdicts: Sequence[Verdict]) -> list[ColouredVerdict]:
    """Assigns a colour to each verdict that breaks a law, as long as colours last."""
    shades = iter(COLOURS)
    return [
        ColouredVerdict(each, next(shades, UNNAMED) if each.broken else PASSING)
        for each in verdicts
    ]


def _draw_rows(
    figure: SubFigure, interfaces: Sequence[str], drawn: Sequence[ColouredVerdict]
) -> None:
    rows = figure.subplots(len(interfaces), 2, squeeze=False, sharex=True, sharey="row")
    for row, interface in zip(rows, interfaces, strict=True):
        own = [each for each in drawn if each.verdict.interface == interface]
        for axes, part in zip(row, PARTS, strict=True):
            axes.set_title(f"{PARTS[part]}, {interface}")
            _draw_bands(axes, own)
            for each in own:
                _draw_residual(axes, part, each)
        row[0].set_ylabel("(Z - nearest passive\nnetwork) / |Z| (%)")
    for axes in rows[-1]:
        frequency_axis(axes)


def _draw_bands(axes: Axes, own: Sequence[ColouredVerdict]) -> None:
    """Shades the limits: equal for a whole interface, narrower if the misfit is too large."""
    kHz = own[0].verdict.spectrum.frequency / 1e3
    bands = {each.verdict.allowed.tobytes(): 100 * each.verdict.allowed for each in own}
    widest_first = sorted(bands.values(), key=np.sum, reverse=True)
    for (name, shade), band in zip(BANDS.items(), widest_first, strict=False):
        axes.fill_between(kHz, -band, band, color=shade, zorder=0, label=name)


def _draw_residual(axes: Axes, part: str, drawn: ColouredVerdict) -> None:
    verdict, colour = drawn
    kept, kHz = ~verdict.spectrum.inductive, verdict.spectrum.frequency / 1e3
    residual = 100 * getattr(verdict.spectrum.residual, part)
    beyond = kept & (np.abs(residual) > 100 * verdict.allowed)
    axes.plot(kHz[kept], residual[kept], marker=".", color=colour)
    axes.plot(kHz[beyond], residual[beyond], "x", color=colour, markersize=8)


def _draw_laws(figure: SubFigure, laws: Sequence[str], drawn: Sequence[ColouredVerdict]) -> None:
    """Draws a line for each law; sweeps that break it are offset vertically."""
    broken = [each for each in drawn if each.verdict.broken]
    axes = figure.subplots()
    for number, (verdict, colour) in enumerate(broken):
        offset = 0.5 * (number + 0.5) / len(broken) - 0.25
        for law in verdict.broken:
            height = np.full(len(law.frequency), laws.index(law.law) + offset)
            axes.plot(np.array(law.frequency) / 1e3, height, "x", color=colour)
    kHz = np.concatenate([each.verdict.spectrum.frequency for each in drawn]) / 1e3
    frequency_axis(axes)
    axes.set_xlim(kHz.min() / 1.1, kHz.max() * 1.1)
    axes.set_yticks(range(len(laws)), laws)
    axes.set_ylim(len(laws) - 0.5, -0.5)
    axes.set_title("Broken laws: a cross at each frequency")


def _legend(axes: Axes, drawn: Sequence[ColouredVerdict]) -> tuple[list[Artist], list[str]]:
    """Legend: the limits, passing sweeps, sweeps that break a law, and uncoloured ones."""
    from matplotlib.lines import Line2D

    handles, labels = axes.get_legend_handles_labels()
    named = {
        f"sweep {each.verdict.sweep}, {each.verdict.interface}": each.colour
        for each in drawn
        if each.verdict.broken and each.colour != UNNAMED
    }
    unnamed = sum(each.colour == UNNAMED for each in drawn)
    passing = {"passes": PASSING} if not all(each.verdict.broken for each in drawn) else {}
    further = {f"{unnamed} more that break a law": UNNAMED} if unnamed else {}
    entries = passing | named | further
    lines = [Line2D([], [], color=colour, marker=".") for colour in entries.values()]
    return [*handles, *lines], [*labels, *entries]


SUMMARY = [
    Head("sweep", form="d"),
    "press",
    "interface",
    Head("lowest_phase_deg", "phase from (deg)", ".1f"),
    Head("highest_phase_deg", "to (deg)", ".1f"),
    Head("noise", form=lambda share: f"{100 * share:.2g} %"),
    Head("noise_from", shown=False),
    Head("misfit", form=lambda share: f"{100 * share:.2g} %"),
    Head("inductance_H", shown=False),
    Head("broken", "verdict", lambda laws: laws or "pass", left=True),
]
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


def report_of(verdicts: Sequence[Verdict]) -> Findings:
    """A line for every sweep at every interface, what is broken, and all residuals."""
    flagged = sum(bool(each.broken) for each in verdicts)
    residuals = [row for verdict in verdicts for row in _readings(verdict)]
    return Findings(
        "Check of sweeps",
        [
            DataTable("verdicts", SUMMARY, [*map(_summary, verdicts)], len(verdicts), csv=True),
            *explanations(verdicts),
            f"{flagged} of {len(verdicts)} spectra break a law",
            DataTable("residuals", RESIDUALS, residuals, 0, csv=True),
            Chart("residuals", "Residuals", partial(draw_residuals, verdicts)),
        ],
    )


def write_report(report: Findings, path: Path) -> None:
    """Writes the residual chart; in a folder also tables of all verdicts and residuals."""
    if path.suffix in ENDINGS and not path.is_dir():
        return report.of(Chart)[0].draw(path)
    report.write(path)
    return None


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
